//! Edits: what they move, and what they leave.

use msplines_common::evaluate::Order;

use super::*;
use crate::complex::{Beyond, CylinderComplex};
use crate::samples::{Sequence, large_double_torus, large_torus, open_cylinder};
use crate::space::tests::{random_points, random_space};

fn random_spline(complex: &Arc<CylinderComplex>, seed: u64) -> TSpline {
    let space = Arc::new(random_space(complex, 40, seed));
    let mut numbers = Sequence(seed);
    let vector = |_| Vector3::from_fn(|_, _| numbers.unit() - 0.5);
    let control = (0..space.unknowns()).map(vector).collect();
    TSpline::new(space, control)
}

fn surfaces() -> Vec<TSpline> {
    let pole = open_cylinder(Beyond::Pole { index: 0 });
    let all = [large_torus(0.37), large_double_torus(), pole];
    (0..)
        .zip(all)
        .map(|(seed, complex)| random_spline(&complex, seed))
        .collect()
}

/// Rounding of sums of some twenty products of numbers below 1.
const ROUNDING: f64 = 1e-14;

#[test]
fn a_movement_changes_its_support_only_and_in_proportion() {
    for spline in surfaces() {
        let space = spline.space();
        let points = random_points(space.mesh().complex(), 6000, 5);
        let before = spline.evaluate(&points, Order::Value).positions;
        let rows = space.rows(&points, Order::Value);
        let by = Vector3::new(0.3, -2.0, 0.7);
        let of_cap = space.functions().len() as u32;
        let mut chosen = vec![0, of_cap / 2];
        // A point, and coefficients of caps: the constant and another.
        chosen.extend(
            (space.caps().coefficients() > 0)
                .then_some([of_cap, of_cap + 4])
                .iter()
                .flatten(),
        );
        for unknown in chosen {
            let moved = spline
                .with_moved(&[(unknown, by)])
                .expect("a control point");
            let after = moved.evaluate(&points, Order::Value).positions;
            let mut inside = 0;
            for i in 0..points.len() {
                let row = rows.row(i);
                let own = row
                    .unknowns
                    .iter()
                    .zip(row.values)
                    .filter(|(u, _)| **u == unknown);
                let (count, share) = own.fold((0, 0.0), |(n, s), (_, v)| (n + 1, s + v));
                if count == 0 {
                    assert_eq!(after[i], before[i]);
                } else {
                    inside += 1;
                    assert!((after[i] - before[i] - by * share).norm() < ROUNDING);
                }
            }
            assert!(
                inside > 5 && 2 * inside < points.len(),
                "{inside} of {unknown}"
            );
        }
    }
}

#[test]
fn all_points_moved_alike_move_the_surface() {
    let by = Vector3::new(-1.0, 0.25, 3.0);
    for spline in surfaces() {
        let is_point = |kind| !matches!(kind, ControlKind::Coefficient { .. });
        let all = spline.control_points().into_iter().enumerate();
        let moves = all
            .filter(|(_, p)| is_point(p.kind))
            .map(|(i, _)| (i as u32, by));
        let moved = spline
            .with_moved(&moves.collect::<Vec<_>>())
            .expect("points");
        let points = random_points(spline.space().mesh().complex(), 3000, 9);
        let [before, after] =
            [&spline, &moved].map(|s| s.evaluate(&points, Order::Value).positions);
        let misses = before.iter().zip(&after).map(|(a, b)| (b - a - by).norm());
        assert!(misses.fold(0.0, f64::max) < 10.0 * ROUNDING);
    }
}

#[test]
fn control_points_stand_where_their_functions_do() {
    for spline in surfaces() {
        let points = spline.control_points();
        assert_eq!(points.len(), spline.control().len());
        let space = spline.space();
        for (cap, own) in space.caps().caps().iter().enumerate() {
            let first = space.functions().len() + own.offset as usize;
            let centre = points[first];
            assert_eq!(centre.kind, ControlKind::Centre { cap: cap as u32 });
            // There the surface is its constant, but for what a unit away from a zero makes.
            let there = spline.evaluate(&[centre.at], Order::Value).positions[0];
            assert!(
                (there - centre.position).norm() < 1e-12,
                "{there} {centre:?}"
            );
            let second = ControlKind::Coefficient {
                cap: cap as u32,
                monomial: 1,
            };
            assert_eq!(points[first + 1].kind, second);
        }
        for (function, point) in space.functions().iter().zip(&points) {
            assert_eq!(
                (point.kind, point.at),
                (ControlKind::Point, function.node.into())
            );
        }
    }
}

#[test]
fn drags_fade_and_take_the_nearest_wholly() {
    let spline = &surfaces()[1];
    let by = Vector3::new(0.0, 0.0, 1.0);
    let at = spline.control_points()[7].position;
    let drag = |within| Drag { at, by, within };
    assert_eq!(spline.dragged_by(&drag(0.0)), Ok(vec![(7, by)]));
    let wide = spline.dragged_by(&drag(0.4)).expect("a drag");
    assert!(wide.len() > 3 && wide.len() < spline.control().len());
    for (index, moved) in wide {
        let distance = (spline.control_points()[index as usize].position - at).norm();
        let share = (1.0 - (distance / 0.4).powi(2)).powi(2);
        assert!((moved - by * share).norm() < ROUNDING && distance < 0.4);
    }
    assert_eq!(
        spline.dragged_by(&drag(-1.0)),
        Err(EditError::Number { index: 0 })
    );
}

#[test]
fn pulled_points_arrive_by_the_least_change() {
    for spline in surfaces() {
        let complex = spline.space().mesh().complex();
        let places = random_points(complex, 3, 11);
        let to = |i: usize| Point3::new(i as f64, 0.5, -1.0);
        let pulls: Vec<Pull> = (0..3)
            .map(|i| Pull {
                at: places[i],
                to: to(i),
            })
            .collect();
        let moves = spline.pulled_by(&pulls).expect("points apart");
        let pulled = spline.with_moved(&moves).expect("control points");
        let found = pulled.evaluate(&places, Order::Value).positions;
        (0..3).for_each(|i| assert!((found[i] - to(i)).norm() < 1e-12, "{} {i}", found[i]));
        // Any other change that does it as well differs by one that moves none of the points: it is
        // orthogonal to the least one.
        let rows = spline.space().rows(&places, Order::Value);
        let mut other = vec![0.0; spline.control().len()];
        let mut numbers = Sequence(4);
        other.iter_mut().for_each(|x| *x = numbers.unit() - 0.5);
        let mut lines = Vec::new();
        for i in 0..3 {
            let mut line = vec![0.0; other.len()];
            let row = rows.row(i);
            row.unknowns
                .iter()
                .zip(row.values)
                .for_each(|(u, v)| line[*u as usize] += v);
            lines.push(DVector::from_vec(line));
        }
        let basis = DMatrix::from_columns(&lines).qr().q();
        let other = DVector::from_vec(other);
        let kept = &other - &basis * (basis.transpose() * &other);
        let along: f64 = moves.iter().map(|(u, m)| m.x * kept[*u as usize]).sum();
        assert!(along.abs() < 1e-12, "{along}");
        let twice = [
            pulls[0],
            Pull {
                to: to(5),
                ..pulls[0]
            },
        ];
        assert_eq!(spline.pulled_by(&twice), Err(EditError::TooNear));
    }
}

#[test]
fn what_is_no_movement_is_refused_by_name() {
    let spline = &surfaces()[0];
    let count = spline.control().len();
    let beyond = spline
        .with_moved(&[(count as u32, Vector3::zeros())])
        .expect_err("no such");
    assert_eq!(
        beyond.to_string(),
        format!("there is no control point {count}: there are {count}, counted from 0")
    );
    assert_eq!(spline.pulled_by(&[]), Ok(Vec::new()));
    let far = [(0, Vector3::new(1e308, 0.0, 0.0))];
    assert_eq!(spline.with_moved(&far), Err(EditError::Number { index: 0 }));
    let nan = [(0, Vector3::zeros()), (1, Vector3::new(f64::NAN, 0.0, 0.0))];
    assert_eq!(spline.with_moved(&nan), Err(EditError::Number { index: 1 }));
}
