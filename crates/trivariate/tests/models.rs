//! Real surfaces filled, where their files are at hand.

#[path = "../../../tests/library.rs"]
mod library;

use library::model;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use msplines_trivariate::domain::mesher::{Filled, MesherOptions, Shortfall, Spacing, fill};

/// A lattice that takes no account of how thin a solid is.
fn along_diagonal() -> MesherOptions {
    MesherOptions {
        spacing: Spacing::AlongDiagonal(40.0),
        ..MesherOptions::default()
    }
}

fn filled(surface: &TriangleMesh) -> Filled {
    fill(surface, &along_diagonal(), &mut unobserved()).expect("a solid")
}

/// Fills a model, and checks what every solid must have; `farthest` is a fraction of the diagonal.
fn check(name: &str, farthest: f64) -> Option<Filled> {
    let filled = filled(&model(name)?);
    assert!(filled.mesh.require_sphere().is_ok(), "{name}");
    assert!(filled.mesh.not_positive().is_empty(), "{name}");
    let attempt = filled.report.attempts.last().expect("an attempt");
    let angles = [attempt.smallest_angle, attempt.largest_angle].map(f64::to_degrees);
    assert!(angles[0] > 10.7 && angles[1] < 164.8, "{name}: {angles:?}");
    assert!(attempt.farthest < farthest, "{name}: {attempt:?}");
    Some(filled)
}

#[test]
fn compact_models_take_one_lattice() {
    for (name, farthest) in [
        ("bone_6k", 6e-3),
        ("moai_10k", 8e-3),
        ("lion_vase_10k", 4e-2),
    ] {
        if let Some(filled) = check(name, farthest) {
            assert_eq!(filled.report.attempts.len(), 1, "{name}");
        }
    }
}

#[test]
fn ears_and_wings_take_a_finer_one() {
    if let Some(bunny) = check("bunny_30k", 2e-2) {
        let first = &bunny.report.attempts[0].shortfall;
        assert!(
            matches!(first, Some(Shortfall::PartLost { .. })),
            "{first:?}"
        );
    }
    if let Some(gargoyle) = check("gargoyle_28632", 3e-2) {
        let first = &gargoyle.report.attempts[0];
        assert!(
            matches!(first.shortfall, Some(Shortfall::Topology { .. })),
            "{first:?}"
        );
        assert!(first.repair_rounds > 0);
    }
}
