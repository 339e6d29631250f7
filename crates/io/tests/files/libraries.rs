//! Other libraries read what we read and write, as far as they go.

use std::io::Cursor;

use msplines_common::mesh::PolygonSoup;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use crate::common::{faces, soup, tetrahedron};

/// Returns the points of all faces, which do not depend on how vertices are numbered.
fn face_points(soup: &PolygonSoup) -> Vec<Vec<[f64; 3]>> {
    let point = |&vertex: &i64| soup.positions[vertex as usize].into();
    faces(soup)
        .iter()
        .map(|face| face.iter().map(point).collect())
        .collect()
}

#[test]
fn ply_rs_reads_the_ply_we_write() {
    let surface = tetrahedron();
    let mut file = Cursor::new(surface.written("a.ply"));
    let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
    for (vertex, position) in ply.payload["vertex"].iter().zip(&surface.positions) {
        let coordinates = ["x", "y", "z"].map(|axis| match vertex[axis] {
            Property::Double(value) => value,
            ref other => panic!("{other:?}"),
        });
        assert_eq!(coordinates, <[f64; 3]>::from(*position));
    }
    assert_eq!(ply.payload["vertex"][3]["blue"], Property::UChar(30));
    assert_eq!(ply.payload["vertex"][0]["quality"], Property::Double(0.1));
    for (face, expected) in ply.payload["face"].iter().zip(&surface.faces) {
        assert_eq!(
            face["vertex_indices"],
            Property::ListUInt(expected.to_vec())
        );
    }
}

#[test]
fn tobj_reads_the_same_polygons() {
    let text = "o one\nv 0.1 0 0\nv 1 0 0\nv 1 1e9 0\nv 0 1 0\nv 5 5 5\nvn 0 0 1\n\
                f 1 2 3\ng two\nf -5//1 3//1 -2//1\nv 2 2 2\nf 6 1 2 3 4\n";
    let options = tobj::LoadOptions::default();
    let mut reader = text.as_bytes();
    let (models, _) = tobj::load_obj_buf(&mut reader, &options, |_| {
        tobj::MTLLoadResult::Ok(Default::default())
    })
    .unwrap();
    let mut expected = Vec::new();
    for tobj::Model { mesh, .. } in models {
        let point = |&vertex: &u32| {
            let at = 3 * vertex as usize;
            [
                mesh.positions[at],
                mesh.positions[at + 1],
                mesh.positions[at + 2],
            ]
        };
        let triangles = vec![3; mesh.indices.len() / 3];
        let arities = if mesh.face_arities.is_empty() {
            &triangles
        } else {
            &mesh.face_arities
        };
        let mut corners = mesh.indices.iter();
        for &arity in arities {
            expected.push(
                corners
                    .by_ref()
                    .take(arity as usize)
                    .map(point)
                    .collect::<Vec<_>>(),
            );
        }
    }
    assert_eq!(face_points(&soup("a.obj", text)), expected);
}

#[test]
fn stl_io_reads_the_same_triangles() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.5, 0.0],
        [0.0, 1.0, 0.25],
        [3.0, -1.0, 7.5],
    ];
    let triangles: Vec<_> = [[0, 1, 2], [2, 1, 3], [3, 0, 2]]
        .into_iter()
        .map(|face: [usize; 3]| stl_io::Triangle {
            normal: stl_io::Normal::new([0.0, 0.0, 1.0]),
            vertices: face.map(|corner| stl_io::Vertex::new(corners[corner])),
        })
        .collect();
    let mut file = Vec::new();
    stl_io::write_stl(&mut file, triangles.iter()).unwrap();
    let theirs = stl_io::read_stl(&mut Cursor::new(&file)).unwrap();
    let ours = soup("a.stl", &file);
    let their_faces: Vec<_> = theirs
        .faces
        .iter()
        .map(|face| face.vertices.map(|v| v as i64).to_vec())
        .collect();
    assert_eq!(faces(&ours), their_faces);
    for (our, their) in ours.positions.iter().zip(&theirs.vertices) {
        assert_eq!(
            <[f64; 3]>::from(*our),
            [0, 1, 2].map(|axis| f64::from(their[axis]))
        );
    }
}
