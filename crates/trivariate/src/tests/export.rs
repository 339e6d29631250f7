//! What other programs read.

use msplines_common::bspline::{bernstein, vtk_hexahedron_order};
use msplines_common::{Point3, Vector3};

use super::maps::{parameters, shear};
use crate::TrivariateSpline;
use crate::export::gismo_xml;

fn spline() -> TrivariateSpline {
    TrivariateSpline::from_map(3, shear).expect("a spline")
}

/// VTK's Bézier hexahedron: corners, edges, faces and inside of degree 3, with their places in the
/// lattice written out by hand.
fn vtk_places() -> Vec<[usize; 3]> {
    let mut places = vec![
        [0, 0, 0],
        [3, 0, 0],
        [3, 3, 0],
        [0, 3, 0],
        [0, 0, 3],
        [3, 0, 3],
        [3, 3, 3],
        [0, 3, 3],
    ];
    for k in [0, 3] {
        places.extend([[1, 0, k], [2, 0, k], [3, 1, k], [3, 2, k]]);
        places.extend([[1, 3, k], [2, 3, k], [0, 1, k], [0, 2, k]]);
    }
    for [i, j] in [[0, 0], [3, 0], [3, 3], [0, 3]] {
        places.extend([[i, j, 1], [i, j, 2]]);
    }
    for i in [0, 3] {
        places.extend([[i, 1, 1], [i, 2, 1], [i, 1, 2], [i, 2, 2]]);
    }
    for j in [0, 3] {
        places.extend([[1, j, 1], [2, j, 1], [1, j, 2], [2, j, 2]]);
    }
    for k in [0, 3] {
        places.extend([[1, 1, k], [2, 1, k], [1, 2, k], [2, 2, k]]);
    }
    for k in [1, 2] {
        places.extend([[1, 1, k], [2, 1, k], [1, 2, k], [2, 2, k]]);
    }
    places
}

#[test]
fn bezier_cells_in_the_order_of_vtk_are_the_solid() {
    let spline = spline();
    let (cells, order, places) = (
        spline.bezier_cells(),
        vtk_hexahedron_order([3; 3]),
        vtk_places(),
    );
    for (cell, points) in cells.points().chunks_exact(64).enumerate() {
        let listed: Vec<Point3<f64>> = order.iter().map(|&at| points[at]).collect();
        for at in parameters(5, 0.2, cell as u64) {
            let rows = at.map(|x| {
                let mut row = [0.0; 4];
                bernstein::values(x, &mut row);
                row
            });
            let terms = listed.iter().zip(&places);
            let sum: Vector3<f64> = terms
                .map(|(p, &[i, j, k])| p.coords * (rows[0][i] * rows[1][j] * rows[2][k]))
                .sum();
            let span = [cell % 3, cell / 3 % 3, cell / 9];
            let parameter = std::array::from_fn(|d| (span[d] as f64 + at[d]) / 3.0);
            assert!((spline.position(parameter).coords - sum).norm() < 1e-13);
        }
    }
}

#[test]
fn gismo_text_has_knots_and_points() {
    let (spline, text) = (spline(), gismo_xml(&spline()));
    assert_eq!(text.matches("<KnotVector degree=\"3\">").count(), 3);
    let knots = text
        .split("degree=\"3\">")
        .nth(1)
        .and_then(|t| t.split('<').next());
    let knots: Vec<f64> = knots
        .expect("knots")
        .split(' ')
        .map(|k| k.parse().expect("a number"))
        .collect();
    assert_eq!((knots.len(), knots[3], knots[6]), (10, 0.0, 1.0));
    let coefficients = text
        .split("geoDim=\"3\">")
        .nth(1)
        .and_then(|t| t.split('<').next());
    let numbers: Vec<f64> = coefficients
        .expect("points")
        .split_whitespace()
        .map(|x| x.parse().expect("a number"))
        .collect();
    let expected: Vec<f64> = spline
        .points()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    assert_eq!(numbers, expected);
}
