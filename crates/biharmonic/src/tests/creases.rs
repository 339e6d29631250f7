//! Creases: where they are found, and what they are good for.

use msplines_common::linalg::Mat;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use std::sync::Arc;

use super::{fit_positions, largest, positions};
use crate::{
    BiharmonicSpline, CreaseChoice, Creases, Extension, FitError, Form, KnotChoice, Laplacian,
    Options, PartsError, Space,
};

/// Returns a unit cube of `steps` squares along each edge, each cut into two triangles.
fn cube(steps: u32) -> TriangleMesh {
    shapes::cube(steps)
}

fn run(mesh: &TriangleMesh, count: usize, creases: CreaseChoice) -> BiharmonicSpline {
    let options = Options {
        knots: KnotChoice::Optimised { count },
        creases,
        ..Options::default()
    };
    fit_positions(mesh, &options).spline
}

fn mean_error(spline: &BiharmonicSpline, values: &[f64]) -> f64 {
    let found = spline.vertex_values().unwrap();
    let norm = |v: usize| {
        let square = |i: usize| (found[3 * v + i] - values[3 * v + i]).powi(2);
        (square(0) + square(1) + square(2)).sqrt()
    };
    (0..values.len() / 3).map(norm).sum::<f64>() / (values.len() / 3) as f64
}

const BY_ANGLE: CreaseChoice = CreaseChoice::SharperThan { degrees: 40.0 };

#[test]
fn the_edges_of_a_cube_are_found() {
    let mesh = cube(6);
    let creases = Creases::sharper_than(&mesh, 0.7);
    assert_eq!(creases.edges().len(), 12 * 6);
    assert!(Creases::sharper_than(&mesh, 1.6).is_empty());
    assert!(Creases::sharper_than(&zoo::closed(), 1.5).is_empty());
}

/// With its creases a cube takes eight knots; without them it is a pillow.
#[test]
fn eight_knots_make_a_cube() {
    let mesh = cube(12);
    let values = positions(&mesh);
    let smooth = mean_error(&run(&mesh, 8, CreaseChoice::None), &values);
    let sharp = run(&mesh, 8, BY_ANGLE);
    let error = mean_error(&sharp, &values);
    assert!(error < 1e-3 && smooth > 50.0 * error, "{error} {smooth}");
}

#[test]
fn linear_functions_cost_no_energy_on_a_cube_with_creases() {
    const TOLERANCE: f64 = 1e-5; // the share of the smooth energy that stays
    let mesh = Arc::new(cube(8));
    let creases = Creases::sharper_than(&mesh, 0.7);
    let space = Space::with_creases(Arc::clone(&mesh), Laplacian::Cotangent, creases).unwrap();
    let x = Mat::from_fn(mesh.vertex_count(), 1, |v, _| mesh.positions()[v].x);
    let energy = &space.bilaplacian().unwrap().matrix;
    let smooth = space.operators().bilaplacian();
    let cost = |m: &msplines_common::linalg::SymmetricMatrix| {
        (x.transpose() * m.multiply(x.as_ref()))[(0, 0)]
    };
    assert!(cost(energy) < TOLERANCE * cost(&smooth));
}

#[test]
fn subdivision_keeps_creases_straight() {
    const TOLERANCE: f64 = 2e-3;
    let mesh = cube(8);
    let spline = run(&mesh, 8, BY_ANGLE);
    let (fine, values) = spline
        .subdivision_values(1, Extension::AreaWeighted)
        .unwrap();
    let expected = positions(&fine);
    let difference = Mat::from_fn(values.len(), 1, |i, _| values[i] - expected[i]);
    assert!(largest(&difference) < TOLERANCE, "{}", largest(&difference));
}

#[test]
fn a_spline_with_creases_is_stored_by_its_knot_values() {
    let mesh = cube(6);
    let spline = run(&mesh, 20, BY_ANGLE);
    let Form::KnotValues(values) = spline.form() else {
        panic!("no Green's coefficients with creases");
    };
    let at_vertices = spline.vertex_values().unwrap();
    for (k, &knot) in spline.knots().iter().enumerate() {
        for c in 0..3 {
            assert!((values[3 * k + c] - at_vertices[3 * knot as usize + c]).abs() < 1e-12);
        }
    }
    let (space, knots) = (spline.space(), spline.knots().to_vec());
    let form = Form::KnotValues(values.clone());
    let again = BiharmonicSpline::from_parts(space, 3, knots.clone(), form).unwrap();
    assert_eq!(again.vertex_values().unwrap(), at_vertices);
    let implicit = Form::Implicit {
        coefficients: vec![0.0; 60],
        constant: vec![0.0; 3],
    };
    let error = BiharmonicSpline::from_parts(space, 3, knots, implicit).unwrap_err();
    assert_eq!(error, PartsError::Creases);
}

#[test]
fn creases_that_do_not_exist_are_refused() {
    let mesh = cube(4);
    let error = Creases::along(&mesh, &[mesh_edge(&mesh), [0, 0]]).unwrap_err();
    assert!(matches!(error, FitError::NoSuchCrease { index: 1, .. }));
    for degrees in [-1.0, 181.0, f64::NAN] {
        let error = CreaseChoice::SharperThan { degrees }.on(&mesh).unwrap_err();
        assert!(matches!(error, FitError::CreaseAngle { .. }), "{error}");
    }
}

fn mesh_edge(mesh: &TriangleMesh) -> [u32; 2] {
    mesh.topology().edge_vertices(0)
}
