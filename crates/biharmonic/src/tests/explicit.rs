//! The explicit representation: what makes a basis, how local it is, and the way there and back.

use std::ops::ControlFlow;
use std::sync::Arc;

use msplines_common::linalg::Mat;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::{Outcome, unobserved};

use super::{farthest_knots, largest_difference, space, spline_on, spread_knots};
use crate::{
    BasisKind, BiharmonicSpline, Creases, ExplicitBasis, ExplicitError, Form, Laplacian, Space,
};

/// Differences that rounding explains, against values of size 1.
const EXACT: f64 = 1e-12;

const MIXTURES: [BasisKind; 3] = [
    BasisKind::JointQp,
    BasisKind::NEIGHBOUR,
    BasisKind::Cardinal,
];

fn basis(space: &Arc<Space>, knots: &[u32], kind: BasisKind) -> ExplicitBasis {
    ExplicitBasis::build(space, knots, kind, &mut unobserved()).unwrap()
}

fn implicit(spline: &BiharmonicSpline) -> (&[f64], &[f64]) {
    match spline.form() {
        Form::Implicit {
            coefficients,
            constant,
        } => (coefficients, constant),
        Form::KnotValues(_) => panic!("a smooth spline"),
    }
}

#[test]
fn the_joint_basis_is_local_well_conditioned_and_sums_to_one() {
    let mesh = shapes::bumpy_sphere(4000);
    let space = Arc::new(space(&mesh));
    let knots = farthest_knots(&mesh, 200);
    let joint = basis(&space, &knots, BasisKind::JointQp);
    assert_eq!(joint.outcome(), Outcome::Converged);
    let locality = joint.locality().unwrap();
    assert!(locality.unity_error < EXACT, "{locality:?}");
    assert!(locality.outside[1] < 0.006, "{locality:?}");
    assert!(locality.worst_outside < 0.05, "{locality:?}");
    assert!(
        locality.smallest > -0.06 && locality.largest < 1.0,
        "{locality:?}"
    );
    assert!(joint.condition() < 8.0, "{}", joint.condition());
    let neighbour = basis(&space, &knots, BasisKind::NEIGHBOUR);
    let before = neighbour.locality().unwrap();
    assert!(before.outside[1] > 2.5 * locality.outside[1], "{before:?}");
    assert!(before.smallest < locality.smallest, "{before:?}");
}

/// Where knots are scattered at random, the bounds that suffice elsewhere leave `P` with conditions of 15
/// and 12.
#[test]
fn scattered_knots_leave_the_basis_well_conditioned() {
    let mesh = shapes::bumpy_sphere(4000);
    let vertices = mesh.vertex_count() as u32;
    let space = Arc::new(space(&mesh));
    for seed in [1, 10] {
        let scattered = |k: u32| (k * k * (7 + seed) + 977 * k * (seed + 1)) % vertices;
        let mut knots: Vec<u32> = (0..150).map(scattered).collect();
        knots.sort_unstable();
        knots.dedup();
        let basis = basis(&space, &knots, BasisKind::JointQp);
        assert!(basis.condition() < 8.0, "{}", basis.condition());
        let locality = basis.locality().unwrap();
        assert!(locality.outside[1] < 0.013, "{locality:?}");
        assert!(locality.unity_error < EXACT, "{locality:?}");
    }
}

#[test]
fn rows_of_the_mixture_sum_to_one_within_their_bounds() {
    let mesh = zoo::knotted();
    let space = Arc::new(space(&mesh));
    let basis = basis(&space, &farthest_knots(&mesh, 80), BasisKind::JointQp);
    let mixture = basis.mixture().unwrap();
    let mut sums = vec![0.0; 80];
    for column in 0..80 {
        let (rows, values) = mixture.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            sums[row as usize] += value;
            let bounds = if row as usize == column {
                0.5..1.5
            } else {
                -0.1..0.6
            };
            assert!(bounds.contains(&value), "{row} {column} {value}");
        }
    }
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-14));
}

#[test]
fn there_and_back_is_the_same_spline_on_every_surface() {
    for mesh in zoo::all() {
        let space = Arc::new(space(&mesh));
        let spline = spline_on(&space, farthest_knots(&mesh, 60));
        let before = spline.vertex_values().unwrap();
        for kind in MIXTURES {
            let basis = basis(&space, spline.knots(), kind);
            let points = basis.control_points(&spline).unwrap();
            let back = basis.spline(&points, 3).unwrap();
            let after = back.vertex_values().unwrap();
            let error = largest_difference(&before, &after) / mesh.diagonal();
            assert!(error < EXACT, "{kind:?} {error}");
            let again = basis.control_points(&back).unwrap();
            let error = largest_difference(&points, &again) / mesh.diagonal();
            assert!(error < EXACT, "{kind:?} {error}");
        }
    }
}

#[test]
fn creases_change_nothing_about_the_way_there_and_back() {
    let mesh = shapes::cube(8);
    let creases = Creases::sharper_than(&mesh, 0.6);
    let shared = Arc::new(mesh.clone());
    let space = Arc::new(Space::with_creases(shared, Laplacian::Cotangent, creases).unwrap());
    let spline = spline_on(&space, farthest_knots(&mesh, 50));
    let basis = basis(&space, spline.knots(), BasisKind::JointQp);
    let back = basis.spline(&basis.control_points(&spline).unwrap(), 3);
    let (before, after) = (spline.vertex_values(), back.unwrap().vertex_values());
    assert!(largest_difference(&before.unwrap(), &after.unwrap()) < EXACT);
    assert!(basis.locality().unwrap().unity_error < 1e-10); // creases keep 1e-6 of the energy
    let masks = ExplicitBasis::build(&space, spline.knots(), BasisKind::PAPER, &mut unobserved());
    assert_eq!(masks.unwrap_err(), ExplicitError::Creases);
}

#[test]
fn a_spline_is_the_sum_of_control_points_times_functions() {
    let mesh = zoo::genus(2);
    let space = Arc::new(space(&mesh));
    let spline = spline_on(&space, farthest_knots(&mesh, 50));
    let before = spline.vertex_values().unwrap();
    for kind in MIXTURES {
        let basis = basis(&space, spline.knots(), kind);
        let points = basis.control_points(&spline).unwrap();
        let mut sum = vec![0.0; before.len()];
        for j in 0..50 {
            let function = basis.function(j).unwrap();
            for (to, value) in sum.chunks_mut(3).zip(&function) {
                (0..3).for_each(|c| to[c] += value * points[3 * j + c]);
            }
        }
        assert!(largest_difference(&before, &sum) < EXACT * mesh.diagonal());
        let whole = basis.local_functions(50).unwrap();
        let matrix = Mat::from_fn(50, 3, |j, c| points[3 * j + c]);
        let product = whole.functions.multiply(matrix.as_ref());
        let difference = (0..before.len()).map(|i| (product[(i / 3, i % 3)] - before[i]).abs());
        assert!(difference.fold(0.0, f64::max) < EXACT * mesh.diagonal());
        assert!(whole.lost.iter().all(|&lost| lost < EXACT));
    }
}

#[test]
fn functions_cut_off_after_three_rings_lose_little_and_say_how_much() {
    let mesh = shapes::bumpy_sphere(4000);
    let space = Arc::new(space(&mesh));
    let basis = basis(&space, &farthest_knots(&mesh, 200), BasisKind::JointQp);
    let local = basis.local_functions(3).unwrap();
    let mean = local.lost.iter().sum::<f64>() / 200.0;
    let third = basis.locality().unwrap().outside[2];
    assert!(
        (mean - third).abs() < EXACT && mean < 0.003,
        "{mean} {third}"
    );
    assert!(local.lost.iter().all(|&lost| lost < 0.01));
    let ones = Mat::from_fn(200, 1, |_, _| 1.0);
    let sums = local.functions.multiply(ones.as_ref());
    let off = (0..4002)
        .map(|v| (sums[(v, 0)] - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(off < 0.01, "{off}");
    assert!(local.functions.entry_count() < 60 * 4002);
}

/// [Hou2017] Eq. (8): with `N = S_T P` and `c_j` the mean of `ψ_j` both systems have one solution.
#[test]
fn the_augmented_system_of_the_paper_gives_the_same_control_points() {
    const TOLERANCE: f64 = 1e-9; // S_T has the condition of the bi-Laplacian
    for mesh in [zoo::closed(), zoo::with_boundary()] {
        let space = Arc::new(space(&mesh));
        let spline = spline_on(&space, farthest_knots(&mesh, 40));
        let basis = basis(&space, spline.knots(), BasisKind::JointQp);
        let (w, a) = implicit(&spline);
        let mut augmented = Mat::zeros(41, 40);
        for j in 0..40 {
            let unit: Vec<f64> = (0..40).map(|k| f64::from(u8::from(k == j))).collect();
            let function = basis.spline(&unit, 1).unwrap();
            let (mask, constant) = implicit(&function);
            assert!(mask.iter().sum::<f64>().abs() < EXACT * mask[j].abs());
            let values = basis.function(j).unwrap();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            assert!((mean - constant[0]).abs() < EXACT);
            (0..40).for_each(|i| augmented[(i, j)] = mask[i]);
            augmented[(40, j)] = constant[0];
        }
        let scale = augmented.norm_max();
        (0..40).for_each(|j| augmented[(40, j)] *= scale);
        let right = Mat::from_fn(
            41,
            3,
            |i, c| {
                if i < 40 { w[3 * i + c] } else { scale * a[c] }
            },
        );
        use faer::linalg::solvers::SolveLstsq;
        let found = augmented.col_piv_qr().solve_lstsq(&right);
        let points = basis.control_points(&spline).unwrap();
        let difference = (0..120).map(|i| (found[(i / 3, i % 3)] - points[i]).abs());
        let largest = difference.fold(0.0, f64::max);
        assert!(largest < TOLERANCE * mesh.diagonal(), "{largest}");
    }
}

#[test]
fn constants_have_constant_control_points() {
    let mesh = zoo::with_two_boundaries();
    let space = Arc::new(space(&mesh));
    let basis = basis(&space, &farthest_knots(&mesh, 30), BasisKind::JointQp);
    let spline = basis.spline(&[1e6; 30], 1).unwrap();
    let values = spline.vertex_values().unwrap();
    assert!(values.iter().all(|value| (value - 1e6).abs() < 1e-8));
    let points = basis.control_points(&spline).unwrap();
    assert!(points.iter().all(|value| (value - 1e6).abs() < 1e-8));
}

#[test]
fn cardinal_control_points_are_the_values_at_the_knots() {
    let mesh = zoo::closed();
    let space = Arc::new(space(&mesh));
    let spline = spline_on(&space, spread_knots(mesh.vertex_count(), 40));
    let basis = basis(&space, spline.knots(), BasisKind::Cardinal);
    let values = spline.vertex_values().unwrap();
    let at_knots = spline
        .knots()
        .iter()
        .map(|&k| &values[3 * k as usize..][..3]);
    let expected: Vec<f64> = at_knots.flatten().copied().collect();
    let points = basis.control_points(&spline).unwrap();
    assert!(largest_difference(&points, &expected) < 1e-14);
    assert!((basis.condition() - 1.0).abs() < 1e-12);
}

#[test]
fn an_edit_moves_the_surface_near_its_knot_and_nowhere_else() {
    let mesh = shapes::bumpy_sphere(4000);
    let space = Arc::new(space(&mesh));
    let spline = spline_on(&space, farthest_knots(&mesh, 200));
    let basis = basis(&space, spline.knots(), BasisKind::JointQp);
    let before = spline.vertex_values().unwrap();
    assert_eq!(
        basis.edit(&spline, &[]).unwrap().vertex_values().unwrap(),
        before
    );
    let moved = basis
        .edit(
            &spline,
            &[(17, vec![0.0, 0.0, 0.3]), (17, vec![0.1, 0.0, 0.0])],
        )
        .unwrap();
    let after = moved.vertex_values().unwrap();
    let function = basis.function(17).unwrap();
    let local = basis.local_functions(3).unwrap();
    let (near, _) = local.functions.column(17);
    let length = 0.1f64.hypot(0.3);
    for v in 0..mesh.vertex_count() {
        let change = [0, 1, 2].map(|c| after[3 * v + c] - before[3 * v + c]);
        let expected = [0.1 * function[v], 0.0, 0.3 * function[v]];
        let off = [0, 1, 2].map(|c| (change[c] - expected[c]).abs());
        assert!(off.iter().all(|&off| off < EXACT));
        let distance = change.iter().map(|x| x * x).sum::<f64>().sqrt();
        let outside = near.binary_search(&(v as u32)).is_err();
        assert!(!outside || distance < 0.01 * length, "{v} {distance}");
    }
    let knot = spline.knots()[17] as usize;
    assert!(after[3 * knot + 2] - before[3 * knot + 2] > 0.3 * 0.4);
    let points = [&spline, &moved].map(|s| basis.control_points(s).unwrap());
    let shift: Vec<f64> = (0..600).map(|i| points[1][i] - points[0][i]).collect();
    for (i, value) in shift.iter().enumerate() {
        let expected = [(51, 0.1), (53, 0.3)].iter().find(|e| e.0 == i);
        assert!((value - expected.map_or(0.0, |e| e.1)).abs() < EXACT);
    }
}

/// What the ledger says of difference masks: local, singular, and not a partition of unity.
#[test]
fn difference_masks_are_local_but_do_not_sum_to_one() {
    let mesh = shapes::bumpy_sphere(1500);
    let space = Arc::new(space(&mesh));
    let knots = farthest_knots(&mesh, 100);
    let masks = basis(&space, &knots, BasisKind::DifferenceMasks { rings: 3 });
    let locality = masks.locality().unwrap();
    assert!(locality.outside[1] < 0.1, "{locality:?}");
    assert!(locality.unity_error > 0.1, "{locality:?}");
    assert!(masks.mixture().is_none());
    assert!(masks.condition() > 1e2, "{}", masks.condition());
    let spline = spline_on(&space, knots);
    let points = masks.control_points(&spline).unwrap();
    let back = masks.spline(&points, 3).unwrap();
    let (before, after) = (spline.vertex_values(), back.vertex_values());
    let error = largest_difference(&before.unwrap(), &after.unwrap());
    assert!(error < 1e-6 * mesh.diagonal(), "{error}");
    let moved = masks.edit(&spline, &[(3, vec![1.0, 0.0, 0.0])]).unwrap();
    let found = masks.control_points(&moved).unwrap();
    assert!((found[9] - points[9] - 1.0).abs() < 1e-3);
}

#[test]
fn few_knots_and_all_vertices_make_a_basis_too() {
    let mesh = zoo::closed();
    let space = Arc::new(space(&mesh));
    let n = mesh.vertex_count();
    for count in [1, 2, 3, 5, n] {
        let spline = spline_on(&space, spread_knots(n, count));
        for kind in MIXTURES {
            let basis = basis(&space, spline.knots(), kind);
            let back = basis.spline(&basis.control_points(&spline).unwrap(), 3);
            let (before, after) = (spline.vertex_values(), back.unwrap().vertex_values());
            let error = largest_difference(&before.unwrap(), &after.unwrap());
            assert!(error < EXACT * mesh.diagonal(), "{count} {kind:?} {error}");
            assert!(basis.locality().unwrap().unity_error < EXACT);
        }
    }
}

#[test]
fn a_basis_has_the_same_bits_on_any_number_of_threads() {
    let mesh = zoo::knotted();
    let knots = farthest_knots(&mesh, 80);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let space = Arc::new(space(&mesh));
            let basis = basis(&space, &knots, BasisKind::JointQp);
            (basis.mixture().unwrap().clone(), basis.locality().unwrap())
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn an_observer_stops_the_work() {
    let mesh: TriangleMesh = zoo::closed();
    let space = Arc::new(space(&mesh));
    let knots = farthest_knots(&mesh, 60);
    for seen in 0..4 {
        let mut left = seen;
        let found = ExplicitBasis::build(&space, &knots, BasisKind::JointQp, &mut |progress| {
            assert_eq!(progress.phase, "basis");
            if left == 0 {
                return ControlFlow::Break(());
            }
            left -= 1;
            ControlFlow::Continue(())
        });
        assert_eq!(found.unwrap_err(), ExplicitError::Stopped);
    }
}

#[test]
fn kinds_that_do_not_exist_are_refused() {
    let shared = Arc::new(space(&zoo::closed()));
    let knots = spread_knots(642, 40);
    let build = |kind| ExplicitBasis::build(&shared, &knots, kind, &mut unobserved());
    let text = |error: ExplicitError| error.to_string();
    assert_eq!(
        text(build(BasisKind::Neighbour { beta: 0.5 }).unwrap_err()),
        "neighbours cannot have the share 0.5 of a control point; give at least 0 and less than 0.5"
    );
    assert_eq!(
        text(build(BasisKind::DifferenceMasks { rings: 0 }).unwrap_err()),
        "difference masks cannot reach 0 rings far; give 1 to 8"
    );
    let large = ExplicitError::TooLarge {
        vertices: 100_000,
        knots: 5_000,
        numbers: 500_000_000,
    };
    assert!(text(large).contains("need 4 GB"));
}

#[test]
fn what_does_not_belong_to_a_basis_is_refused_with_its_place() {
    let mesh = zoo::closed();
    let shared = Arc::new(space(&mesh));
    let knots = spread_knots(mesh.vertex_count(), 40);
    let spline = spline_on(&shared, knots.clone());
    let text = |error: ExplicitError| error.to_string();
    let own = basis(&shared, &knots, BasisKind::NEIGHBOUR);
    let others = basis(&shared, &knots[1..], BasisKind::NEIGHBOUR);
    assert_eq!(
        text(others.control_points(&spline).unwrap_err()),
        "the spline has 40 knots, the basis 39, and number 0 is the first that differs; build the \
         basis for the knots of the spline"
    );
    let elsewhere = Arc::new(space(&zoo::knotted()));
    let stranger = basis(&elsewhere, &knots, BasisKind::NEIGHBOUR);
    assert_eq!(
        stranger.edit(&spline, &[]).unwrap_err(),
        ExplicitError::OtherSpace
    );
    assert_eq!(
        text(own.function(40).unwrap_err()),
        "there is no control point 40; the basis has 40, counted from 0"
    );
    let edit = |index, by: &[f64]| own.edit(&spline, &[(index, by.to_vec())]).unwrap_err();
    assert_eq!(
        edit(40, &[0.0; 3]),
        ExplicitError::NoSuchControlPoint {
            index: 40,
            knots: 40
        }
    );
    assert_eq!(
        edit(4, &[0.0; 2]),
        ExplicitError::Length {
            found: 2,
            expected: 3
        }
    );
    assert_eq!(
        edit(4, &[0.0, f64::NAN, 0.0]),
        ExplicitError::NotFinite { index: 1 }
    );
    let short = own.spline(&[0.0; 119], 3).unwrap_err();
    assert_eq!(
        short,
        ExplicitError::Length {
            found: 119,
            expected: 120
        }
    );
}
