//! Tori whose forms are known exactly.

use msplines_common::mesh::{TriangleMesh, shapes};

use crate::complex::UNITS;
use crate::domain::{Domain, End, PeriodicForm, SnapOptions};

use super::{farthest_jump, farthest_vertex};

/// A grid of 16 columns and 12 rows on a torus, laid out on the lattice of `(width, 0)` and `(skew, 1)`.
fn lattice(width: f64, skew: f64) -> PeriodicForm {
    let (columns, rows) = (16, 12);
    let id = |i: u32, j: u32| (j % rows) * columns + i % columns;
    let mut faces = Vec::new();
    let mut form = Vec::new();
    let [right, up] = [[width / 16.0, 0.0], [skew / 12.0, 1.0 / 12.0]];
    let minus = |a: [f64; 2]| a.map(|x| -x);
    let both = [right[0] + up[0], right[1] + up[1]];
    for j in 0..rows {
        for i in 0..columns {
            faces.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            form.extend([right, up, minus(both)]);
            faces.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
            form.extend([both, minus(right), minus(up)]);
        }
    }
    let positions = shapes::torus(2.0, 1.0, 192).positions().to_vec();
    let positions = positions
        .into_iter()
        .cycle()
        .take((columns * rows) as usize);
    PeriodicForm {
        mesh: TriangleMesh::build(positions.collect(), faces).expect("a torus"),
        form,
        ends: Vec::<End>::new(),
    }
}

#[test]
fn skewed_lattices_are_twists() {
    for (width, skew) in [(1.0, 0.0), (0.75, 0.2), (1.5, -0.4)] {
        let domain =
            Domain::of_form(&lattice(width, skew), &SnapOptions::default()).expect("a torus");
        let [own] = domain.complex().cylinders() else {
            panic!("one cylinder")
        };
        assert!((own.circumference as f64 / UNITS - width).abs() < 1e-13);
        assert_eq!(own.height as f64, UNITS);
        // The way up by one period comes back at `skew`, so that what is above 0 starts at -skew.
        let start = own.top[0].start as f64;
        assert_eq!(start, 0.0);
        let crate::complex::Beyond::Cylinder { start, .. } = own.top[0].beyond else {
            panic!("glued to itself")
        };
        let twist = (-skew).rem_euclid(width);
        assert!(
            (start as f64 / UNITS - twist).abs() < 1e-13,
            "{} {twist}",
            start as f64 / UNITS
        );
        assert!(farthest_jump(&domain) < 20.0 && farthest_vertex(&domain) < 20.0);
    }
}
