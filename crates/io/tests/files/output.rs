//! VTU and glb, read back by other libraries.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::common::tetrahedron;

/// An array of a VTU file: its type, name, components and bytes.
pub(crate) struct Array {
    kind: String,
    pub(crate) name: String,
    components: String,
    pub(crate) bytes: Vec<u8>,
}

fn value(element: &BytesStart<'_>, name: &str) -> String {
    let attribute = element.try_get_attribute(name).unwrap();
    attribute
        .map(|attribute| attribute.value.into_owned())
        .unwrap_or_default()
}

/// Returns all elements in order as `parent/child`, and the arrays.
pub(crate) fn parse(file: &[u8]) -> (Vec<String>, Vec<Array>) {
    let mut reader = Reader::from_reader(file);
    let (mut open, mut seen, mut arrays) = (Vec::new(), Vec::new(), Vec::<Array>::new());
    loop {
        match reader.read_event().unwrap() {
            Event::Start(element) => {
                open.push(element.name().as_ref().to_owned());
                seen.push(open.join("/"));
                if open.last().unwrap() == "DataArray" {
                    assert_eq!(value(&element, "format"), "binary");
                    arrays.push(Array {
                        kind: value(&element, "type"),
                        name: value(&element, "Name"),
                        components: value(&element, "NumberOfComponents"),
                        bytes: Vec::new(),
                    });
                }
                if open.last().unwrap() == "VTKFile" {
                    assert_eq!(value(&element, "header_type"), "UInt64");
                    assert_eq!(value(&element, "byte_order"), "LittleEndian");
                    assert_eq!(value(&element, "type"), "UnstructuredGrid");
                }
            }
            Event::Text(text) if open.last().is_some_and(|name| name == "DataArray") => {
                let stream = STANDARD.decode(&*text).unwrap();
                let (length, bytes) = stream.split_first_chunk().unwrap();
                assert_eq!(u64::from_le_bytes(*length), bytes.len() as u64);
                arrays.last_mut().unwrap().bytes = bytes.to_vec();
            }
            Event::End(_) => drop(open.pop()),
            Event::Eof => break,
            _ => {}
        }
    }
    assert!(open.is_empty());
    (seen, arrays)
}

pub(crate) fn doubles(bytes: &[u8]) -> Vec<u64> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|chunk| f64::from_le_bytes(*chunk).to_bits())
        .collect()
}

pub(crate) fn integers(bytes: &[u8]) -> Vec<i64> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|chunk| i64::from_le_bytes(*chunk))
        .collect()
}

#[test]
fn vtu_holds_the_surface_exactly() {
    let surface = tetrahedron();
    let file = surface.written("a.vtu");
    let (elements, arrays) = parse(&file);
    let text = String::from_utf8_lossy(&file);
    assert!(text.contains("<Piece NumberOfPoints=\"4\" NumberOfCells=\"4\">"));
    let piece = "VTKFile/UnstructuredGrid/Piece";
    for (part, count) in [("PointData", 4), ("Points", 1), ("Cells", 3)] {
        let path = format!("{piece}/{part}/DataArray");
        assert_eq!(
            elements.iter().filter(|element| **element == path).count(),
            count,
            "{part}"
        );
    }
    let array = |name: &str| arrays.iter().find(|array| array.name == name).unwrap();
    let points = array("Points");
    assert_eq!(
        (points.kind.as_str(), points.components.as_str()),
        ("Float64", "3")
    );
    let expected: Vec<_> = surface
        .positions
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    assert_eq!(
        doubles(&points.bytes),
        expected.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
    for attribute in &surface.attributes {
        let expected: Vec<_> = attribute.values.iter().map(|x| x.to_bits()).collect();
        assert_eq!(
            doubles(&array(&attribute.name).bytes),
            expected,
            "{}",
            attribute.name
        );
    }
    let corners: Vec<_> = surface
        .faces
        .iter()
        .flatten()
        .map(|&v| i64::from(v))
        .collect();
    assert_eq!(integers(&array("connectivity").bytes), corners);
    assert_eq!(integers(&array("offsets").bytes), [3, 6, 9, 12]);
    assert_eq!(array("types").bytes, [5; 4]);
}

#[test]
fn glb_is_valid_and_holds_the_surface() {
    let surface = tetrahedron();
    let file = surface.written("a.glb");
    assert_eq!(file.len() % 4, 0);
    // The library checks the structure: indices, sizes, required parts.
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&file).unwrap();
    let blob = blob.unwrap();
    let mesh = document
        .default_scene()
        .unwrap()
        .nodes()
        .next()
        .unwrap()
        .mesh()
        .unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&blob));
    let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(corners, surface.faces.concat());
    let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let expected: Vec<[f32; 3]> = surface
        .positions
        .iter()
        .map(|p| (*p).cast().into())
        .collect();
    assert_eq!(positions, expected);
    let bounds = primitive.bounding_box();
    assert_eq!((bounds.min, bounds.max), ([-1.0; 3], [1.0; 3]));
    // The vertices of this tetrahedron lie on their own outward normals.
    for (normal, position) in reader.read_normals().unwrap().zip(&positions) {
        for axis in 0..3 {
            let expected = position[axis] / 3f32.sqrt();
            assert!(
                (normal[axis] - expected).abs() < f32::EPSILON,
                "{normal:?} {position:?}"
            );
        }
    }
    let colours: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();
    assert_eq!(colours[0], [1.0, 0.0, 0.0]);
    // sRGB 10, 20, 30 of 255 by the formula of IEC 61966-2-1.
    for (seen, expected) in colours[3].iter().zip([0.003_035, 0.006_995, 0.012_983]) {
        assert!((seen - expected).abs() < 1e-6, "{:?}", colours[3]);
    }
}

#[test]
fn glb_without_colours_has_no_colour_attribute() {
    let mut surface = tetrahedron();
    surface.attributes.remove(1);
    let file = surface.written("a.glb");
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&file).unwrap();
    let primitive = document
        .meshes()
        .next()
        .unwrap()
        .primitives()
        .next()
        .unwrap();
    assert!(
        primitive
            .reader(|_| blob.as_deref())
            .read_colors(0)
            .is_none()
    );
}
