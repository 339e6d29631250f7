//! Solids of known volume, of several parts, and with sheets that touch.

use msplines_common::mesh::{Facts, shapes, zoo};

use super::super::{Crossings, Parts};
use super::*;

fn anything(along_diagonal: f64) -> MesherOptions {
    MesherOptions {
        wanted: Wanted::Anything,
        farthest: 100.0,
        ..options(along_diagonal)
    }
}

#[test]
fn volume_and_distance_approach_those_of_the_surface() {
    let surface = zoo::closed();
    let volume = Facts::measure(&surface).volume.unwrap();
    let mut errors = Vec::new();
    for along in [10.0, 20.0, 40.0] {
        let filled = filled(&surface, &options(along));
        let facts = check(&filled);
        let attempt = &filled.report.attempts[0];
        assert_eq!(
            (filled.report.attempts.len(), facts.boundary_genus),
            (1, Some(0))
        );
        assert!(attempt.farthest < 0.5 / along && attempt.rms < attempt.farthest);
        errors.push((facts.volume / volume - 1.0).abs());
    }
    // Vertices of the boundary are on the surface, so that the error is of second order.
    assert!(errors[0] < 0.1 && errors[2] < errors[0] / 8.0, "{errors:?}");
}

#[test]
fn a_box_on_the_lattice_keeps_its_faces() {
    for spacing in [0.25, 0.125] {
        let options = MesherOptions {
            spacing: Spacing::Length(spacing),
            ..options(1.0)
        };
        let filled = filled(&block([2.0, 1.0, 1.0]), &options);
        let facts = check(&filled);
        assert_eq!(filled.report.attempts.len(), 1);
        assert!(
            (facts.volume - 2.0).abs() < 2.0 * spacing,
            "{}",
            facts.volume
        );
        assert_eq!(
            facts
                .bounding_box
                .map(|p| p.map(|x| (x * 1e6).round() / 1e6)),
            [[0.0; 3], [2.0, 1.0, 1.0]]
        );
    }
}

#[test]
fn parts_that_overlap_become_one() {
    let ball = shapes::sphere(1000);
    let near = both(&ball, &moved(&ball, |p| p + Vector3::new(1.2, 0.1, 0.0)));
    let refused = fill(&near, &anything(25.0), &mut unobserved()).unwrap_err();
    assert!(matches!(refused, MesherError::Crossing { .. }), "{refused}");
    let united = MesherOptions {
        crossings: Crossings::United,
        ..anything(25.0)
    };
    let one = filled(&near, &united);
    let facts = check(&one);
    assert_eq!(
        (facts.components, facts.boundary_euler_characteristic),
        (1, 2)
    );
    // Two unit balls, their centres this far apart, less the lens they share.
    let d = 1.45f64.sqrt();
    let lens = std::f64::consts::PI * (4.0 + d) * (2.0 - d).powi(2) / 12.0;
    let expected = 8.0 / 3.0 * std::f64::consts::PI - lens;
    assert!(
        (facts.volume / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        facts.volume
    );
}

#[test]
fn a_void_stays_and_parts_are_kept_or_dropped() {
    let ball = shapes::sphere(1000);
    let hollow = both(&ball, &turned(&moved(&ball, |p| p * 0.5)));
    let facts = check(&filled(&hollow, &anything(25.0)));
    assert_eq!((facts.components, facts.boundary_components), (1, 2));
    assert!((facts.volume / (4.0 / 3.0 * std::f64::consts::PI * 0.875) - 1.0).abs() < 0.02);
    let apart = both(
        &moved(&ball, |p| p * 0.5),
        &moved(&ball, |p| p + Vector3::new(3.0, 0.0, 0.0)),
    );
    assert_eq!(check(&filled(&apart, &anything(25.0))).components, 2);
    let largest = MesherOptions {
        parts: Parts::Largest,
        ..anything(25.0)
    };
    let kept = filled(&apart, &largest);
    let facts = check(&kept);
    assert_eq!((facts.components, kept.report.attempts[0].parts), (1, 2));
    assert!(facts.bounding_box[0][0] > 1.9);
}

#[test]
fn contacts_are_undone_and_angles_kept() {
    let ball = shapes::sphere(600);
    let (mut rounds, mut unmoved) = (0, 0);
    for gap in 0..12 {
        // Gaps down to a fraction of the spacing, in directions that no lattice plane has.
        let offset = Vector3::new(1.7, 0.9, 0.6).normalize() * (2.0 + 0.01 * f64::from(gap));
        let surface = both(&ball, &moved(&ball, |p| p + offset));
        let filled = filled(&surface, &anything(30.0));
        check(&filled);
        rounds += filled.report.attempts[0].repair_rounds;
        unmoved += filled.report.attempts[0].unmoved_points;
    }
    assert!(rounds > 0 && unmoved > 0, "no contact was met: {rounds}");
}

#[test]
fn thin_parts_ask_for_a_finer_lattice() {
    // A ball with a plate through it, thinner than the first spacing.
    let plate = moved(&block([3.0, 3.0, 0.09]), |p| {
        p - Vector3::new(1.5, 1.5, 0.045)
    });
    let thin = MesherOptions {
        farthest: 1.0,
        ..options(20.0)
    };
    let filled = filled(&plate, &thin);
    check(&filled);
    let attempts = &filled.report.attempts;
    assert!(attempts.len() > 1 && attempts[0].shortfall.is_some());
    assert!(attempts.last().unwrap().shortfall.is_none());
}
