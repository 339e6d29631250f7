//! What is written is what is read back, bit for bit.

use nalgebra::Point3;
use proptest::prelude::*;

use crate::common::{Owned, attribute, bits, soup, tetrahedron};

/// A surface with any finite coordinates, subnormal and huge ones among them, and attributes.
fn surfaces() -> impl Strategy<Value = Owned> {
    let finite = || prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    (1usize..12).prop_flat_map(move |n| {
        let position = [finite(), finite(), finite()].prop_map(Point3::from);
        let corner = 0..n as u32;
        (
            prop::collection::vec(position, n),
            prop::collection::vec([corner.clone(), corner.clone(), corner], 1..20),
            prop::collection::vec(finite(), n),
            prop::collection::vec((0u8..=255).prop_map(f64::from), n),
        )
            .prop_map(|(positions, faces, reals, whole)| {
                // One channel fits into bytes and the other does not.
                let attributes = vec![
                    attribute("quality", &reals),
                    attribute("red", &whole),
                    attribute("green", &reals),
                ];
                Owned {
                    positions,
                    faces,
                    attributes,
                }
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn ply_keeps_every_bit(surface in surfaces()) {
        let read = soup("round.ply", surface.written("round.ply"));
        prop_assert_eq!(bits(&read), bits(&surface.soup()));
    }

    #[test]
    fn obj_keeps_every_bit_of_the_positions(mut surface in surfaces()) {
        let read = soup("round.obj", surface.written("round.obj"));
        surface.attributes.clear();
        prop_assert_eq!(bits(&read), bits(&surface.soup()));
    }
}

#[test]
fn the_same_surface_gives_the_same_bytes() {
    for name in ["a.ply", "a.obj", "a.vtu", "a.glb"] {
        assert_eq!(
            tetrahedron().written(name),
            tetrahedron().written(name),
            "{name}"
        );
    }
}

#[test]
fn colours_are_bytes_where_that_loses_nothing() {
    let mut surface = tetrahedron();
    surface.attributes[1].values[0] = 0.5;
    let written = surface.written("a.ply");
    let header = String::from_utf8_lossy(&written);
    assert!(header.contains("property uchar red\n"));
    assert!(header.contains("property double green\n"));
    assert_eq!(bits(&soup("a.ply", &written)), bits(&surface.soup()));
}
