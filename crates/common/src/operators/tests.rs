//! Closed forms of single triangles, and laws of the Laplacian and of its solves.

use faer::Mat;
use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::mesh::{TriangleMesh, shapes};

/// Rounding of a few operations.
const EXACT: f64 = 1e-13;

/// Rounding of sums and solves over a mesh of some hundred vertices.
const SOLVED: f64 = 1e-9;

fn is_close(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance * (1.0 + expected.abs())
}

fn turned<T: Copy>(values: [T; 3], turn: usize) -> [T; 3] {
    std::array::from_fn(|i| values[(i + turn) % 3])
}

/// Sides of a triangle from corner 0 to 1, 1 to 2 and 2 to 0; its area, half the cotangents of the
/// angles opposite to the sides, and the areas of the corners.
type Known = ([f64; 3], f64, [f64; 3], [f64; 3]);

/// Triangles with all angles below, one at, and one above a right angle.
fn known() -> [Known; 3] {
    let root = 3.0_f64.sqrt();
    let third = root / 3.0;
    [
        ([2.0; 3], root, [root / 6.0; 3], [third; 3]),
        // The right angle is at corner 1, the Voronoi vertex in the middle of the side opposite to it.
        (
            [3.0, 4.0, 5.0],
            6.0,
            [2.0 / 3.0, 3.0 / 8.0, 0.0],
            [1.5, 3.0, 1.5],
        ),
        // 120° at corner 1.
        (
            [2.0, 2.0, 2.0 * root],
            root,
            [root / 2.0, root / 2.0, -root / 6.0],
            [root / 4.0, root / 2.0, root / 4.0],
        ),
    ]
}

#[test]
fn single_triangles_have_their_closed_forms() {
    for (sides, area, weights, areas) in known() {
        for turn in 0..3 {
            let (sides, weights, areas) = (
                turned(sides, turn),
                turned(weights, turn),
                turned(areas, turn),
            );
            assert!(is_close(triangle_area(sides), area, EXACT));
            let found = half_cotangents(sides);
            let Operators { laplacian, mass } = assemble(3, &[[0, 1, 2]], &[sides]);
            for i in 0..3 {
                assert!(is_close(found[i], weights[i], EXACT), "{found:?}");
                assert!(is_close(mass[i], areas[i], EXACT), "{mass:?}");
                let (a, b) = (i as u32, (i as u32 + 1) % 3);
                let place = laplacian.place(a.max(b), a.min(b)).unwrap();
                assert!(is_close(laplacian.values()[place], -weights[i], EXACT));
                // Side i and the side before it meet at corner i.
                let sum = weights[i] + weights[(i + 2) % 3];
                assert!(is_close(laplacian.diagonal()[i], sum, EXACT));
            }
        }
    }
}

#[test]
fn a_needle_keeps_its_area_and_impossible_sides_have_none() {
    for base in [1e-3_f64, 1e-8, 1e-12] {
        let area = 0.5 * base * (1.0 - 0.25 * base * base).sqrt();
        assert!((triangle_area([1.0, base, 1.0]) / area - 1.0).abs() < EXACT);
    }
    assert_eq!(triangle_area([1.0, 2.0, 3.0]), 0.0);
    assert_eq!(triangle_area([1.0, 2.0, 4.0]), 0.0);
}

#[test]
fn an_edge_from_a_vertex_to_itself_adds_its_area_alone() {
    let Operators { laplacian, mass } = assemble(2, &[[0, 0, 1]], &[[2.0; 3]]);
    let weight = 3.0_f64.sqrt() / 6.0;
    assert!(is_close(mass[0] / mass[1], 2.0, EXACT));
    for diagonal in laplacian.diagonal() {
        assert!(is_close(diagonal, 2.0 * weight, EXACT));
    }
}

/// A square of `n × n` cells in the plane, its inner vertices moved by up to a fifth of a cell.
fn moved_square(n: u32, moves: &[f64]) -> TriangleMesh {
    let width = n + 1;
    let position = |v: u32| {
        let (i, j) = (v / width, v % width);
        let is_inner = i % n != 0 && j % n != 0;
        let by = |k: u32| {
            if is_inner {
                moves[(2 * v + k) as usize % moves.len()]
            } else {
                0.0
            }
        };
        Point3::new(f64::from(i) + by(0), f64::from(j) + by(1), 0.0)
    };
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let v = i * width + j;
            faces.push([v, v + width, v + width + 1]);
            faces.push([v, v + width + 1, v + 1]);
        }
    }
    TriangleMesh::build((0..width * width).map(position).collect(), faces).unwrap()
}

proptest! {
    #[test]
    fn linear_functions_are_harmonic_and_have_the_energy_of_the_plane(
        moves in prop::collection::vec(-0.2..0.2, 34),
        [a, b, c] in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let n = 4;
        let mesh = moved_square(n, &moves);
        let Operators { laplacian, mass } = mesh_operators(&mesh);
        let value = |v: usize| a * mesh.positions()[v].x + b * mesh.positions()[v].y + c;
        let x = Mat::from_fn(mesh.vertex_count(), 1, |v, _| value(v));
        let lx = laplacian.multiply(x.as_ref());
        for (v, p) in mesh.positions().iter().enumerate() {
            let side = f64::from(n);
            let is_inner = p.x > 0.0 && p.x < side && p.y > 0.0 && p.y < side;
            prop_assert!(!is_inner || lx[(v, 0)].abs() < SOLVED, "{v}: {}", lx[(v, 0)]);
        }
        let area = f64::from(n * n);
        let energy: f64 = (0..mesh.vertex_count()).map(|v| x[(v, 0)] * lx[(v, 0)]).sum();
        prop_assert!(is_close(energy, (a * a + b * b) * area, SOLVED));
        prop_assert!(is_close(mass.iter().sum(), area, SOLVED));
    }
}

/// Right-hand sides with nothing special about them.
fn sides(rows: usize) -> Mat<f64> {
    Mat::from_fn(rows, 2, |i, j| ((i * 31 + j * 17) % 23) as f64 - 10.0)
}

fn mean(values: &Mat<f64>, side: usize) -> f64 {
    values.col(side).iter().sum::<f64>() / values.nrows() as f64
}

#[test]
fn solutions_of_both_equations_satisfy_them() {
    let mesh = shapes::bumpy_sphere(200);
    let operators = mesh_operators(&mesh);
    let poisson = Poisson::factor(&operators).unwrap();
    let b = sides(mesh.vertex_count());
    let mut x = b.clone();
    poisson.solve_in_place(x.as_mut());
    let harmonic = operators.laplacian.multiply(x.as_ref());
    let y = poisson.solve_biharmonic(b.clone());
    let biharmonic = operators.bilaplacian().multiply(y.as_ref());
    for side in 0..2 {
        let mean_of_b = mean(&b, side);
        assert!(mean_of_b.abs() > 0.1, "a mean to be taken away");
        for v in 0..mesh.vertex_count() {
            let expected = b[(v, side)] - mean_of_b;
            assert!(is_close(harmonic[(v, side)], expected, SOLVED));
            assert!(is_close(biharmonic[(v, side)], expected, SOLVED));
        }
        assert!(mean(&y, side).abs() < SOLVED);
        assert!(x.col(side).iter().any(|x| *x == 0.0), "a grounded vertex");
    }
}

#[test]
fn a_balanced_side_is_solved_as_it_stands() {
    let mesh = shapes::torus(1.0, 0.4, 150);
    let operators = mesh_operators(&mesh);
    let poisson = Poisson::factor(&operators).unwrap();
    let mut b = sides(mesh.vertex_count());
    for side in 0..2 {
        let mean = mean(&b, side);
        (0..b.nrows()).for_each(|v| b[(v, side)] -= mean);
    }
    let mut x = b.clone();
    poisson.solve_balanced_in_place(x.as_mut());
    let found = operators.laplacian.multiply(x.as_ref());
    for side in 0..2 {
        let mut column = (0..b.nrows()).map(|v| (found[(v, side)], b[(v, side)]));
        assert!(column.all(|(found, b)| is_close(found, b, SOLVED)));
        assert!(x.col(side).iter().any(|x| *x == 0.0), "a grounded vertex");
    }
}

#[test]
fn two_surfaces_are_refused() {
    let one = shapes::sphere(50);
    let count = one.vertex_count() as u32;
    let mut positions = one.positions().to_vec();
    positions.extend(
        one.positions()
            .iter()
            .map(|p| p + nalgebra::Vector3::x() * 5.0),
    );
    let mut faces = one.faces().to_vec();
    faces.extend(one.faces().iter().map(|f| f.map(|v| v + count)));
    let lengths: Vec<[f64; 3]> = faces
        .iter()
        .map(|f| {
            let at = |i: usize| positions[f[i % 3] as usize];
            std::array::from_fn(|i| (at(i + 1) - at(i)).norm())
        })
        .collect();
    let refused = Poisson::factor(&assemble(positions.len(), &faces, &lengths));
    assert_eq!(
        refused.err(),
        Some(PoissonError::NotConnected { components: 2 })
    );
}
