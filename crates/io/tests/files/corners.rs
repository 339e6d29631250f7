//! Normals and texture coordinates, written and read back by us and by other libraries.

use std::io::Cursor;

use msplines_common::mesh::vertex_normals;
use msplines_io::{Surface, WriteError, read_soup, write_surface};
use nalgebra::{Point3, Vector3};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use crate::common::{attribute, faces, refusal, scratch, soup};
use crate::output::{doubles, parse};

/// A unit square of two triangles. The corners at vertex 0 lie on a seam of the texture, those at vertex
/// 2 do not, and vertex 4 has no faces.
const FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
const TEXTURE: [[f64; 2]; 6] = [
    [0.0, 0.1],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.25, 0.0],
    [1.0, 1.0],
    [-0.0, 1.5],
];
/// Which of the distinct vertices with texture coordinates each corner is.
const SPLIT: [u32; 6] = [0, 1, 2, 5, 2, 3];

fn positions() -> [Point3<f64>; 5] {
    let square = [[0.1, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [7.0, 7.0]];
    square.map(|[x, y]| Point3::new(x, y, x * y / 3.0))
}

/// Returns normals that are none of faces.
fn normals() -> [Vector3<f64>; 5] {
    [0.0, 0.1, 0.2, 0.3, 0.4].map(|x| Vector3::new(x, 1.0 / 3.0, 0.7).normalize())
}

/// Returns the bytes of the surface written under this name, with normals and texture if wanted.
fn written(name: &str, normals: Option<&[Vector3<f64>]>, texture: Option<&[[f64; 2]]>) -> Vec<u8> {
    let (_directory, path) = scratch(name);
    let surface = Surface {
        positions: &positions(),
        faces: &FACES,
        normals,
        corner_texture: texture,
        ..Surface::default()
    };
    write_surface(&path, &surface).unwrap();
    std::fs::read(&path).unwrap()
}

fn bits(vectors: &[Vector3<f64>]) -> Vec<[u64; 3]> {
    let numbers = vectors.iter().map(|v| [v.x, v.y, v.z]);
    numbers.map(|v| v.map(f64::to_bits)).collect()
}

#[test]
fn what_is_written_with_normals_and_texture_is_read_by_us() {
    for name in ["a.ply", "a.obj"] {
        for texture in [None, Some(&TEXTURE[..])] {
            let plain = soup(name, written(name, None, texture));
            assert_eq!(plain.positions, positions(), "{name}");
            assert_eq!(faces(&plain), [[0, 1, 2], [0, 2, 3]], "{name}");
            assert_eq!(vertex_normals(&plain.attributes), None, "{name}");
            let read = soup(name, written(name, Some(&normals()), texture));
            assert_eq!(read.positions, positions(), "{name}");
            assert_eq!(faces(&read), [[0, 1, 2], [0, 2, 3]], "{name}");
            let names: Vec<&str> = read.attributes.iter().map(|a| a.name.as_str()).collect();
            assert_eq!(names, ["nx", "ny", "nz"], "{name}");
            // In OBJ only corners can say that the normal of a vertex in no face is its own.
            let count = if name == "a.ply" { 5 } else { 4 };
            let found: Vec<Vector3<f64>> = (0..count)
                .map(|v| Vector3::from([0, 1, 2].map(|axis| read.attributes[axis].values[v])))
                .collect();
            assert_eq!(bits(&found), bits(&normals()[..count]), "{name}");
            // Units are divided by their length once more.
            let units = vertex_normals(&read.attributes).unwrap();
            let pairs = units.iter().zip(normals());
            assert!(
                pairs
                    .take(count)
                    .all(|(a, b)| (a - b).norm() < 4.0 * f64::EPSILON)
            );
        }
    }
}

#[test]
fn ply_rs_reads_the_texture_of_faces() {
    let mut file = Cursor::new(written("a.ply", Some(&normals()), Some(&TEXTURE)));
    let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
    let (corners, _) = TEXTURE.as_chunks::<3>();
    for (face, corners) in ply.payload["face"].iter().zip(corners) {
        let expected = corners.as_flattened().iter().map(|&x| x as f32).collect();
        assert_eq!(face["texcoord"], Property::ListFloat(expected));
    }
    for (vertex, normal) in ply.payload["vertex"].iter().zip(normals()) {
        assert_eq!(vertex["ny"], Property::Double(normal.y));
    }
}

#[test]
fn tobj_reads_normals_and_texture() {
    let file = written("a.obj", Some(&normals()), Some(&TEXTURE));
    let (models, _) = tobj::load_obj_buf(&mut &file[..], &tobj::LoadOptions::default(), |_| {
        tobj::MTLLoadResult::Ok(Default::default())
    })
    .unwrap();
    let mesh = &models[0].mesh;
    assert_eq!(mesh.texcoord_indices.len(), 6);
    assert_eq!(mesh.normal_indices.len(), 6);
    for (corner, expected) in TEXTURE.into_iter().enumerate() {
        let vertex = FACES.as_flattened()[corner] as usize;
        let texture = 2 * mesh.texcoord_indices[corner] as usize;
        let found = [mesh.texcoords[texture], mesh.texcoords[texture + 1]];
        assert_eq!(found, expected);
        let normal = 3 * mesh.normal_indices[corner] as usize;
        let found = [0, 1, 2].map(|axis| mesh.normals[normal + axis]);
        assert_eq!(Vector3::from(found), normals()[vertex]);
    }
    // Corners that agree share what they name.
    let text = String::from_utf8(file).unwrap();
    assert!(
        text.contains("f 1/1/1 2/2/2 3/3/3\nf 1/6/1 3/3/3 4/4/4\n"),
        "{text}"
    );
    let plain = String::from_utf8(written("a.obj", None, Some(&TEXTURE))).unwrap();
    assert!(plain.contains("f 1/1 2/2 3/3\nf 1/6 3/3 4/4\n"), "{plain}");
    let plain = String::from_utf8(written("a.obj", Some(&normals()), None)).unwrap();
    assert!(
        plain.contains("f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n"),
        "{plain}"
    );
}

#[test]
fn glb_splits_vertices_at_seams_only() {
    let file = written("a.glb", Some(&normals()), Some(&TEXTURE));
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&file).unwrap();
    let mesh = document.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(corners, SPLIT);
    let found: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let expected: [[f32; 3]; 6] = [0, 1, 2, 3, 4, 0].map(|v| positions()[v].cast::<f32>().into());
    assert_eq!(found, expected);
    let found: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
    assert_eq!(found.len(), 6);
    for (found, vertex) in found.into_iter().zip([0, 1, 2, 3, 4, 0]) {
        let apart = Vector3::from(found).cast::<f64>() - normals()[vertex];
        assert!(apart.norm() < f64::from(f32::EPSILON), "{apart}");
    }
    let texture: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    for (corner, index) in SPLIT.into_iter().enumerate() {
        let [u, v] = TEXTURE[corner];
        assert_eq!(texture[index as usize], [u as f32, (1.0 - v) as f32]);
    }
    let plain = written("a.glb", Some(&normals()), None);
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&plain).unwrap();
    let mesh = document.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    assert!(reader.read_tex_coords(0).is_none());
    let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(corners, FACES.as_flattened());
}

#[test]
fn vtu_has_normals_by_their_role() {
    let file = written("a.vtu", Some(&normals()), Some(&TEXTURE));
    let text = String::from_utf8_lossy(&file);
    assert!(text.contains("<PointData Normals=\"Normals\">"));
    let (_, arrays) = parse(&file);
    let found = arrays.iter().find(|array| array.name == "Normals").unwrap();
    assert_eq!(doubles(&found.bytes), *bits(&normals()).as_flattened());
}

#[test]
fn obj_normals_are_those_that_the_corners_name() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    let normals = |text: &str| {
        let soup = soup("a.obj", format!("{vertices}{text}"));
        vertex_normals(&soup.attributes)
    };
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    // One normal for each vertex, in another order, of another length, counted from either end.
    let one = "vn 0 0 1\nvn 0 3 0\nvn 1 0 0\nf 1//3 2//2 3//1\nf 2/9/-2 3/9/-3 1/9/-1\n";
    assert_eq!(normals(one), Some(vec![x, y, z, Vector3::zeros()]));
    // Flat faces: the mean of all corners' units where they differ.
    let flat = "vn 0 0 5\nvn 0 1 0\nf 1//1 2//1 3//1\nf 2//2 4//2 3//2\n";
    let mean = (y + z).normalize();
    assert_eq!(normals(flat), Some(vec![z, mean, mean, y]));
    // Opposite normals have no mean, and an index without a normal names none.
    let odd = "vn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//7\nf 1//2 2//-9 4\n";
    let zero = Vector3::zeros();
    assert_eq!(normals(odd), Some(vec![zero, z, zero, zero]));
    // No corner names one.
    let as_many = "vn 1 0 0\nvn 0 1 0\nvn 0 0 1\nvn 0 0 2\nf 1 2 3\n";
    assert_eq!(normals(as_many), Some(vec![x, y, z, z]));
    assert_eq!(normals("vn 1 0 0\nf 1 2 3\n"), None);
    assert_eq!(normals("vt 0 0\nf 1/1 2/1 3/1\n"), None);
    let text = refusal("a.obj", format!("{vertices}vn 0 1\nf 1 2 3\n")).to_string();
    let expected = "line 5: the line ends where the z component of a normal is expected";
    assert!(text.contains(expected), "{text}");
    let text = refusal("a.obj", format!("{vertices}vn 0 1 0\nf 1//1 2//y 3\n")).to_string();
    assert!(text.contains("line 6: a normal index is `y`"), "{text}");
}

#[test]
fn off_and_ply_give_the_normals_that_obj_gives() {
    let off = "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 1 0\n0 1 0 0 0 0\n3 0 1 2\n";
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float nz\nproperty float x\n\
                  property float y\nproperty float z\nproperty float nx\nproperty float ny\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = format!("{header}2 0 0 0 0 0\n0 1 0 0 0 1\n0 0 1 0 0 0\n3 0 1 2\n");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 1 0\nvn 0 0 0\nf 1//1 2//2 3//3\n";
    let expected = Some(vec![Vector3::z(), Vector3::y(), Vector3::zeros()]);
    for (name, text) in [("a.off", off), ("a.ply", &ply), ("a.obj", obj)] {
        assert_eq!(
            vertex_normals(&soup(name, text).attributes),
            expected,
            "{name}"
        );
    }
}

#[test]
fn oriented_points_without_faces_are_told_as_such() {
    let (_directory, path) = scratch("a.ply");
    let points = Surface {
        positions: &positions(),
        normals: Some(&normals()),
        ..Surface::default()
    };
    write_surface(&path, &points).unwrap();
    let error = read_soup(&path).unwrap_err();
    assert!(matches!(
        error,
        msplines_io::ReadError::NoFaces { vertices: 5, .. }
    ));
}

#[test]
fn unfit_normals_and_texture_are_not_written() {
    let (_directory, path) = scratch("a.ply");
    let (positions, normals) = (positions(), normals());
    let fit = Surface {
        positions: &positions,
        faces: &FACES,
        ..Surface::default()
    };
    let refuse = |surface: Surface<'_>| {
        let error = write_surface(&path, &surface).unwrap_err();
        assert!(!path.exists());
        error
    };
    let short = Surface {
        normals: Some(&normals[..4]),
        ..fit
    };
    let text = refuse(short).to_string();
    assert!(
        text.contains("`normal` has 4 values for 5 vertices"),
        "{text}"
    );
    let mut broken = normals;
    broken[2].y = f64::NAN;
    let text = refuse(Surface {
        normals: Some(&broken),
        ..fit
    })
    .to_string();
    assert!(
        text.contains("`normal` of vertex 2 is not finite"),
        "{text}"
    );
    let named = [attribute("ny", &[0.0; 5])];
    let twice = Surface {
        normals: Some(&normals),
        attributes: &named,
        ..fit
    };
    assert!(matches!(refuse(twice), WriteError::AttributeName { .. }));
    let short = Surface {
        corner_texture: Some(&TEXTURE[..5]),
        ..fit
    };
    let text = refuse(short).to_string();
    assert!(
        text.contains("5 pairs of texture coordinates for 6 corners"),
        "{text}"
    );
    let mut broken = TEXTURE;
    broken[4][1] = 1e39;
    let text = refuse(Surface {
        corner_texture: Some(&broken),
        ..fit
    })
    .to_string();
    assert!(text.contains("corner 1 of face 1"), "{text}");
}
