//! Fits against the equations they solve, and laws of their solutions.

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use nalgebra::DMatrix;
use proptest::prelude::*;

use super::{
    SOFT, SOLVE_TOLERANCE, coordinates, dense_laplacian, fitted, given, largest_difference,
    positions, selected, square, torus,
};
use crate::{Constraints, Selection, fit};

#[test]
fn soft_constraints_give_the_dense_least_squares_solution() {
    for mesh in [torus(9, 7), square(8, 9)] {
        let n = mesh.vertex_count();
        let controls = [3, 17, 30, 44, 60];
        for weight in [0.3, 1.0, 20.0] {
            let mut matrix = dense_laplacian(&mesh).insert_rows(n, controls.len(), 0.0);
            let mut rhs = DMatrix::zeros(n + controls.len(), 3);
            for (row, &control) in controls.iter().enumerate() {
                matrix[(n + row, control as usize)] = weight;
                let position = mesh.positions()[control as usize];
                (0..3).for_each(|side| rhs[(n + row, side)] = weight * position[side]);
            }
            let expected = matrix.svd(true, true).solve(&rhs, 0.0).unwrap();
            let expected: Vec<f64> = expected.transpose().iter().copied().collect();
            let spline = fitted(&mesh, &given(&controls, Constraints::Soft { weight }));
            let difference = largest_difference(spline.vertex_values(), &expected);
            assert!(
                difference < SOLVE_TOLERANCE,
                "weight {weight}: {difference}"
            );
        }
    }
}

#[test]
fn hard_constraints_interpolate_and_minimise_over_the_rest() {
    let mesh = torus(9, 7);
    let controls = [3, 17, 30, 44, 60];
    let spline = fitted(&mesh, &given(&controls, Constraints::Hard));
    let values = coordinates(&mesh);
    for &control in &controls {
        let range = 3 * control as usize..3 * control as usize + 3;
        assert_eq!(spline.vertex_values()[range.clone()], values[range]);
    }
    // The gradient of the energy vanishes at every vertex that is no control.
    let laplacian = dense_laplacian(&mesh);
    let x = DMatrix::from_row_slice(mesh.vertex_count(), 3, spline.vertex_values());
    let gradient = laplacian.transpose() * (&laplacian * x);
    for vertex in (0..mesh.vertex_count()).filter(|v| !controls.contains(&(*v as u32))) {
        assert!(
            gradient.row(vertex).amax() < SOLVE_TOLERANCE,
            "vertex {vertex}"
        );
    }
}

#[test]
fn heavy_soft_constraints_approach_hard_ones() {
    let mesh = square(8, 9);
    let controls = [3, 17, 30, 44, 60];
    let hard = fitted(&mesh, &given(&controls, Constraints::Hard));
    let soft = fitted(&mesh, &given(&controls, Constraints::Soft { weight: 1e4 }));
    assert!(largest_difference(soft.vertex_values(), hard.vertex_values()) < 1e-6);
}

#[test]
fn all_vertices_as_hard_controls_reproduce_the_data() {
    let mesh = square(7, 6);
    let all: Vec<u32> = (0..42).rev().collect();
    let values = coordinates(&mesh);
    assert_eq!(
        fitted(&mesh, &given(&all, Constraints::Hard)).vertex_values(),
        values
    );
    for selection in [Selection::Greedy, Selection::Combined { solves: 5 }] {
        let spline = fitted(&mesh, &selected(42, selection, Constraints::Hard));
        assert_eq!(spline.vertex_values(), values);
    }
}

#[test]
fn constant_data_are_reproduced() {
    let mesh = torus(12, 9);
    let values = vec![-7.25; mesh.vertex_count()];
    let data = VertexData {
        dimension: 1,
        values: &values,
    };
    for constraints in [SOFT, Constraints::Hard] {
        let options = selected(9, Selection::Combined { solves: 3 }, constraints);
        let fit = fit(&mesh, data, &options, &mut unobserved()).unwrap();
        assert_eq!(fit.spline.vertex_values(), values);
        assert_eq!(fit.spline.controls().len(), 9);
    }
}

#[test]
fn a_surface_far_from_the_origin_is_the_same_surface() {
    let mesh = torus(16, 12);
    let options = selected(24, Selection::Combined { solves: 6 }, SOFT);
    let near = fitted(&mesh, &options);
    let shift = 1048576.0;
    let moved: Vec<f64> = coordinates(&mesh).iter().map(|x| x + shift).collect();
    let far = fit(&mesh, positions(&moved), &options, &mut unobserved())
        .unwrap()
        .spline;
    let back: Vec<f64> = far.vertex_values().iter().map(|x| x - shift).collect();
    // The coordinates themselves keep ten digits.
    assert!(largest_difference(near.vertex_values(), &back) < 1e-8);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn renumbering_the_vertices_renumbers_the_surface(keys in prop::collection::vec(0u64.., 96)) {
        let mesh = square(12, 8);
        let mut order: Vec<u32> = (0..96).collect();
        order.sort_by_key(|&v| (keys[v as usize], v));
        // Vertex `order[v]` of the mesh is vertex `v` of the other one.
        let mut rank = vec![0; 96];
        order.iter().enumerate().for_each(|(v, &old)| rank[old as usize] = v as u32);
        let faces = mesh.faces().iter().map(|f| f.map(|v| rank[v as usize])).collect();
        let points = order.iter().map(|&old| mesh.positions()[old as usize]).collect();
        let other = TriangleMesh::build(points, faces).unwrap();
        let options = selected(14, Selection::Combined { solves: 4 }, SOFT);
        let (one, two) = (fitted(&mesh, &options), fitted(&other, &options));
        let mapped: Vec<u32> = two.controls().iter().map(|&v| order[v as usize]).collect();
        prop_assert_eq!(one.controls(), mapped);
    }

    #[test]
    fn the_surface_is_affine_in_its_data(a in prop::array::uniform9(-2.0..2.0), seed in 0u32..40) {
        let mesh = torus(9, 7);
        let controls: Vec<u32> = (0..6).map(|i| (seed + i * 10) % 63).collect();
        let values = coordinates(&mesh);
        let map = |p: &[f64]| (0..3).map(|r| a[3 * r] * p[0] + a[3 * r + 1] * p[1] + a[3 * r + 2] * p[2] + 5.0).collect::<Vec<_>>();
        let mapped: Vec<f64> = values.chunks_exact(3).flat_map(map).collect();
        let options = given(&controls, SOFT);
        let one = fitted(&mesh, &options);
        let two = fit(&mesh, positions(&mapped), &options, &mut unobserved()).unwrap().spline;
        let expected: Vec<f64> = one.vertex_values().chunks_exact(3).flat_map(map).collect();
        prop_assert!(largest_difference(two.vertex_values(), &expected) < SOLVE_TOLERANCE);
    }
}
