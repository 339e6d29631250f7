//! What is written is what is read back.

mod common;

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use msplines_io::{Surface, read_soup, write_surface};
use nalgebra::Point3;
use proptest::prelude::*;

use common::{bits, scratch};

/// A surface with any finite coordinates, subnormal and huge ones among them, and attributes.
fn surfaces() -> impl Strategy<Value = (Vec<Point3<f64>>, Vec<[u32; 3]>, Vec<VertexAttribute>)> {
    let finite = || prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    (1usize..12).prop_flat_map(move |n| {
        let position = [finite(), finite(), finite()].prop_map(Point3::from);
        let corner = 0..n as u32;
        let channel = prop::collection::vec(0u8..=255, n);
        (
            prop::collection::vec(position, n),
            prop::collection::vec([corner.clone(), corner.clone(), corner], 1..20),
            prop::collection::vec(finite(), n),
            channel,
        )
            .prop_map(|(positions, faces, quality, red)| {
                let red = red.into_iter().map(f64::from).collect();
                let attributes = vec![
                    VertexAttribute {
                        name: "quality".to_owned(),
                        values: quality.clone(),
                    },
                    VertexAttribute {
                        name: "red".to_owned(),
                        values: red,
                    },
                    VertexAttribute {
                        name: "green".to_owned(),
                        values: quality,
                    },
                ];
                (positions, faces, attributes)
            })
    })
}

proptest! {
    #[test]
    fn ply_keeps_every_bit((positions, faces, attributes) in surfaces()) {
        let (_directory, path) = scratch("round.ply");
        let surface = Surface { positions: &positions, faces: &faces, attributes: &attributes };
        write_surface(&path, &surface).unwrap();
        let read = read_soup(&path).unwrap();
        let mut expected = PolygonSoup::from_triangles(positions, &faces);
        expected.attributes = attributes;
        prop_assert_eq!(bits(&read), bits(&expected));
    }

    #[test]
    fn obj_keeps_every_bit_of_the_positions((positions, faces, _) in surfaces()) {
        let (_directory, path) = scratch("round.obj");
        let surface = Surface { positions: &positions, faces: &faces, attributes: &[] };
        write_surface(&path, &surface).unwrap();
        let read = read_soup(&path).unwrap();
        prop_assert_eq!(bits(&read), bits(&PolygonSoup::from_triangles(positions, &faces)));
    }
}
