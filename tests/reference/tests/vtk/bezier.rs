//! Bézier cells of any shape and degree, polynomial and rational, against VTK.

use msplines_common::bspline::bernstein::{self, binomial};
use msplines_common::bspline::{BezierCells, CellShape};
use msplines_io::{Field, write_cells};
use msplines_reference::Library;
use msplines_reference::python::Python;
use msplines_reference::record::Comparison;
use nalgebra::{Point3, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

use crate::{Failure, POINTS, ROUNDING, VTK, coordinates, read};

/// Cells of each kind.
const CELLS: usize = 5;
/// Shapes and degrees: surfaces of Powell-Sabin splines are the triangles of degree 2; a triangle of
/// degree 9 has four rings of points.
const KINDS: [(CellShape, [usize; 3]); 12] = [
    (CellShape::Triangles, [1, 0, 0]),
    (CellShape::Triangles, [2, 0, 0]),
    (CellShape::Triangles, [3, 0, 0]),
    (CellShape::Triangles, [4, 0, 0]),
    (CellShape::Triangles, [5, 0, 0]),
    (CellShape::Triangles, [6, 0, 0]),
    (CellShape::Triangles, [9, 0, 0]),
    (CellShape::Quads, [3, 3, 0]),
    (CellShape::Quads, [2, 3, 0]),
    (CellShape::Quads, [4, 1, 0]),
    (CellShape::Hexahedra, [3, 3, 3]),
    (CellShape::Hexahedra, [1, 2, 3]),
];

/// Returns the values of all Bernstein polynomials of a cell, in the order of [`BezierCells`].
fn polynomials(shape: CellShape, degree: [usize; 3], at: [f64; 3]) -> Vec<f64> {
    if shape == CellShape::Triangles {
        let (d, [v, w, _]) = (degree[0], at);
        let power = |x: f64, n: usize| x.powi(n as i32);
        let value = |i: usize, j: usize| {
            let count = binomial(d, j) * binomial(d - j, i);
            count * power(1.0 - v - w, d - i - j) * power(v, i) * power(w, j)
        };
        let rows = (0..=d).flat_map(|j| (0..=d - j).map(move |i| (i, j)));
        return rows.map(|(i, j)| value(i, j)).collect();
    }
    let directions = if shape == CellShape::Quads { 2 } else { 3 };
    let mut product = vec![1.0];
    for d in 0..directions {
        let mut factor = vec![0.0; degree[d] + 1];
        bernstein::values(at[d], &mut factor);
        let rows = factor.iter();
        product = rows
            .flat_map(|f| product.iter().map(move |p| f * p))
            .collect();
    }
    product
}

/// Returns a point of a cell.
fn evaluate(cells: &BezierCells, cell: usize, at: [f64; 3]) -> Point3<f64> {
    let degree = cells.degree().expect("one degree");
    let per_cell = cells.shape().points_per_cell(degree);
    let range = cell * per_cell..(cell + 1) * per_cell;
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    let values = polynomials(cells.shape(), degree, at);
    for (value, point) in values.into_iter().zip(range) {
        let share = value * cells.weights().map_or(1.0, |weights| weights[point]);
        sum += cells.points()[point].coords * share;
        total += share;
    }
    Point3::from(sum / total)
}

/// Returns parameters inside of a cell, on its edges and at its corners.
fn parameters(shape: CellShape, random: &mut impl Rng) -> [f64; 3] {
    let mut at = [0; 3].map(|_| match random.random_range(0..6) {
        0 => 0.0,
        1 => 1.0,
        _ => random.random::<f64>(),
    });
    if shape != CellShape::Hexahedra {
        at[2] = 0.0;
    }
    // Folds the half of the square that lies outside of the triangle into it.
    if shape == CellShape::Triangles && at[0] + at[1] > 1.0 {
        at = [1.0 - at[0], 1.0 - at[1], 0.0];
    }
    at
}

#[test]
fn bezier_cells_of_all_shapes_and_degrees_are_evaluated_alike() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let mut random = Pcg64Mcg::seed_from_u64(10);
    let why = "relative to the diagonal of the cube of the control points";
    let mut comparison = Comparison::new("Bézier cells", Library::Vtk, ROUNDING, why);
    for (shape, degree) in KINDS {
        for is_rational in [false, true] {
            let name = format!("{shape:?} {degree:?}, rational: {is_rational}");
            let per_cell = shape.points_per_cell(degree);
            let points: Vec<Point3<f64>> = (0..CELLS * per_cell)
                .map(|_| Point3::from([0; 3].map(|_| random.random_range(-1.0..1.0))))
                .collect();
            let weights = is_rational.then(|| {
                let weights = points.iter().map(|_| random.random_range(0.5..2.0));
                weights.collect::<Vec<f64>>()
            });
            let cells = BezierCells::build(shape, degree, points, weights)?;
            let folder = tempfile::tempdir()?;
            let path = folder.path().join("cells.vtu");
            let heights: Vec<f64> = cells.points().iter().map(|p| p.z).collect();
            let faces: Vec<f64> = (0..CELLS).map(|cell| 3.0 * cell as f64).collect();
            let field = |name, values| {
                [Field {
                    name,
                    components: 1,
                    values,
                }]
            };
            write_cells(
                &path,
                &cells,
                &field("height", &heights),
                &field("face", &faces),
            )?;
            let found = read(&mut python, VTK, &path)?;
            assert_eq!(found.points, coordinates(cells.points()), "{name}");
            assert_eq!(found.point_data["height"], json!(heights), "{name}");
            assert_eq!(found.cell_data["face"], json!(faces), "{name}");
            let places: Vec<(usize, [f64; 3])> = (0..POINTS)
                .map(|_| {
                    (
                        random.random_range(0..CELLS),
                        parameters(shape, &mut random),
                    )
                })
                .collect();
            let asked: Vec<_> = places.iter().map(|(c, [r, s, t])| (c, r, s, t)).collect();
            let question = json!({"path": &path, "places": asked});
            let theirs: Vec<[f64; 3]> = python.ask("bezier_points", &question)?;
            assert_eq!(theirs.len(), POINTS, "{name}");
            for ((cell, at), theirs) in places.into_iter().zip(theirs) {
                let apart = evaluate(&cells, cell, at) - Point3::from(theirs);
                comparison.add(&name, [apart.norm() / 12.0_f64.sqrt()]);
            }
        }
    }
    comparison.finish();
    Ok(())
}
