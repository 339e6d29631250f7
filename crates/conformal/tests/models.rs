//! Spherical maps and flattenings of surfaces of the library of models.
#![allow(clippy::print_stdout, reason = "the measures of every model are shown")]

mod library;

use msplines_common::operators::intrinsic::FlipRule;
use msplines_conformal::disk::{Route, flatten_disk};
use msplines_conformal::sphere::spherical_map;

/// Closed models of genus 0 and the angle distortion that their faces leave, rounded up.
const CLOSED: [(&str, f64); 8] = [
    ("bunny_35k", 1.03),
    ("nefertiti_50k", 1.035),
    ("igea_134k", 1.01),
    ("maxplanck_49k", 1.015),
    ("horse_48k", 1.06),
    ("lucy_50k", 1.07),
    ("gargoyle_28632", 1.045),
    ("armadillo_43k", 1.07),
];

const DISKS: [(&str, f64); 4] = [
    ("face_4k", 1.055),
    ("maxplanck_8k7_open", 1.055),
    ("mannequin_devil_open", 1.07),
    ("demosthenes_8k", 1.07),
];

#[test]
fn closed_models_map_to_the_sphere_without_flips() {
    for (name, largest) in CLOSED {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        let map = spherical_map(&mesh, FlipRule::Simplicial).expect("a spherical map");
        println!("{name}: {:?}, {} moved", map.distortion, map.moved);
        assert_eq!(map.distortion.flips, 0);
        assert!(map.corrected && map.distortion.angle_mean < largest);
    }
}

#[test]
fn open_models_flatten_without_flips() {
    for (name, largest) in DISKS {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        let map = flatten_disk(&mesh).expect("a flattening");
        println!("{name}: {:?}, {:?}", map.distortion, map.route);
        assert_eq!(map.distortion.flips, 0);
        assert!(map.route != Route::Convex && map.distortion.angle_mean < largest);
    }
}
