//! Real solids mapped to the cube, where their files are at hand.

#[path = "../../../tests/library.rs"]
mod library;

use library::{model, path};
use msplines_common::mesh::Policy;
use msplines_common::mesh::tet::{self, TetMesh};
use msplines_common::progress::{Outcome, unobserved};
use msplines_io::read_tets;
use msplines_trivariate::domain::mesher::{MesherOptions, fill};
use msplines_trivariate::domain::volume::{CubeMap, VolumeError, VolumeOptions, map};

fn filled(name: &str) -> Option<TetMesh> {
    let filled = fill(&model(name)?, &MesherOptions::default(), &mut unobserved());
    Some(filled.expect("a solid").mesh)
}

fn read(name: &str) -> Option<TetMesh> {
    let soup = read_tets(&path(name)?).expect("a solid of the library");
    Some(tet::accept(&soup, Policy::Repair).expect("a solid").mesh)
}

fn mapped(mesh: &TetMesh) -> CubeMap {
    let map = map(mesh, &VolumeOptions::default(), &mut unobserved()).expect("a map");
    assert_eq!(map.report.outcome, Outcome::Converged, "{:?}", map.report);
    assert_eq!((map.report.quality.flipped, map.report.folded), (0, 0));
    assert!(map.report.quality.smallest_determinant > 0.0);
    map
}

#[test]
fn filled_surfaces_are_mapped_without_folds() {
    for (name, distortion) in [("bone_6k", 1.3), ("moai_10k", 0.4)] {
        if let Some(mesh) = filled(name) {
            let quality = mapped(&mesh).report.quality;
            assert!(quality.distortion < distortion, "{name}: {quality:?}");
        }
    }
}

/// Boundary triangles of these files are kept, with cells between them that the harmonic map folds.
#[test]
fn folds_of_given_solids_are_removed() {
    for name in ["tet/bone.mesh", "tet/bunny_500.mesh"] {
        if let Some(mesh) = read(name) {
            let report = mapped(&mesh).report;
            assert!(report.harmonic.flipped > 0, "{name}: {report:?}");
        }
    }
}

#[test]
fn a_solid_with_a_tunnel_is_refused() {
    if let Some(mesh) = read("tet/rocker_arm.mesh") {
        let error = map(&mesh, &VolumeOptions::default(), &mut unobserved()).unwrap_err();
        assert!(matches!(error, VolumeError::NotSphere(_)), "{error}");
    }
}
