//! What pictures show of a solid: numbers on its boundary, the input with its parameters, and the solid
//! cut open.

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::metrics::SurfaceTree;
use msplines_picture::cells::cut_hexahedra;
use msplines_picture::edges;
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::measure::hexahedra;
use rayon::prelude::*;

use super::boundary::{CubeSurface, nearest_face, positions};
use crate::case::Cut;
use crate::run::Companion;

/// Tiles along the side of a face of the cube.
const TILES: f64 = 8.0;
/// Cells in each direction of a solid that is cut open.
const CUT_CELLS: usize = 32;

fn column(name: &str, values: Vec<f64>) -> VertexAttribute {
    VertexAttribute {
        name: name.to_owned(),
        values,
    }
}

/// Parameters, and the face of the cube and the tile on it, of points of the surface.
fn parameter_fields(parameters: &[[f64; 3]]) -> Vec<VertexAttribute> {
    let mut fields: Vec<VertexAttribute> = ["u", "v", "w"]
        .iter()
        .enumerate()
        .map(|(axis, name)| column(name, parameters.iter().map(|at| at[axis]).collect()))
        .collect();
    let tile = |at: &[f64; 3]| {
        let (face, [a, b]) = nearest_face(*at);
        let index = |x: f64| (TILES * x).floor().clamp(0.0, TILES - 1.0);
        (face as f64 * TILES + index(b)) * TILES + index(a)
    };
    let face = |at: &[f64; 3]| nearest_face(*at).0 as f64;
    fields.push(column("face", parameters.iter().map(face).collect()));
    fields.push(column("tile", parameters.iter().map(tile).collect()));
    fields
}

/// The determinant of the first derivatives over its mean.
fn determinants(spline: &TrivariateSpline, parameters: &[[f64; 3]], mean: f64) -> Vec<f64> {
    let at = parameters.par_iter();
    at.map(|&at| spline.jet(at).determinant() / mean).collect()
}

/// Returns numbers at the vertices of the boundary: parameters, face and tile, determinant, and the
/// distance to the input, where there is one, over the diagonal.
pub(super) fn boundary_fields(
    spline: &TrivariateSpline,
    cells: usize,
    mean: f64,
    input: Option<&TriangleMesh>,
) -> Vec<VertexAttribute> {
    let parameters = CubeSurface::new(cells).parameters();
    let mut fields = parameter_fields(&parameters);
    fields.push(column(
        "determinant",
        determinants(spline, &parameters, mean),
    ));
    if let Some(input) = input {
        let (tree, diagonal) = (SurfaceTree::build(input), input.diagonal());
        let distance = |point: &Point3<f64>| {
            let closest = tree.closest(point);
            closest.map_or(0.0, |closest| {
                (input.position(closest.point) - point).norm() / diagonal
            })
        };
        let points = positions(spline, &parameters);
        fields.push(column(
            "distance",
            points.par_iter().map(distance).collect(),
        ));
    }
    fields
}

/// Returns the lines on the boundary, the input with its parameters, and the solid cut open.
pub(super) fn companions(
    spline: &TrivariateSpline,
    (input, parameters): (&TriangleMesh, &[[f64; 3]]),
    (cells, cut, mean): (usize, Cut, f64),
) -> Vec<Companion> {
    let [lines, cube_edges] = CubeSurface::new(cells).lines(spline.spans());
    let diagonal = input.diagonal();
    let pairs = positions(spline, parameters);
    let pairs = pairs.iter().zip(input.positions());
    let errors = pairs.map(|(found, expected)| (found - expected).norm() / diagonal);
    let mut input_fields = parameter_fields(parameters);
    input_fields.push(column("error", errors.collect()));
    let mut companions = vec![
        Companion {
            name: "spline",
            mesh: None,
            edges: lines,
            creases: cube_edges,
            fields: Vec::new(),
        },
        Companion {
            name: "input",
            mesh: Some(input.clone()),
            edges: edges(input.faces()),
            creases: Vec::new(),
            fields: input_fields,
        },
    ];
    companions.extend(cut_open(spline, cut, mean));
    companions
}

/// The skin of what a cut leaves, with parameters, determinants and scaled Jacobians.
pub(super) fn cut_open(spline: &TrivariateSpline, cut: Cut, mean: f64) -> Option<Companion> {
    let solid = hexahedra(spline, CUT_CELLS);
    let place = |cell: usize| cell / CUT_CELLS.pow(cut.axis as u32) % CUT_CELLS;
    let is_kept = |cell: usize| (place(cell) as f64 + 0.5) / (CUT_CELLS as f64) < cut.keep;
    let skin = cut_hexahedra(&solid.cells, is_kept);
    let mut triangles = [skin.outer.triangles, skin.fresh.triangles].concat();
    let mut lines = [skin.outer.edges, skin.fresh.edges].concat();
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let renumber = |v: &mut u32| *v = used.partition_point(|other| other < v) as u32;
    triangles.as_flattened_mut().iter_mut().for_each(renumber);
    lines.as_flattened_mut().iter_mut().for_each(renumber);
    lines.iter_mut().for_each(|line| line.sort_unstable());
    lines.sort_unstable();
    lines.dedup();
    let positions = used.iter().map(|&v| solid.points[v as usize]).collect();
    let mesh = TriangleMesh::build(positions, triangles).ok()?;
    // A vertex is as good as the worst of its cells that are left.
    let mut scaled = vec![f64::INFINITY; solid.points.len()];
    let kept = solid.cells.iter().zip(&solid.scaled_jacobians).enumerate();
    for (_, (corners, &jacobian)) in kept.filter(|(cell, _)| is_kept(*cell)) {
        for &corner in corners {
            scaled[corner as usize] = scaled[corner as usize].min(jacobian);
        }
    }
    let side = CUT_CELLS + 1;
    let parameter = |&v: &u32| {
        let v = v as usize;
        [v % side, v / side % side, v / (side * side)].map(|i| i as f64 / CUT_CELLS as f64)
    };
    let parameters: Vec<[f64; 3]> = used.iter().map(parameter).collect();
    let mut fields = parameter_fields(&parameters);
    fields.push(column(
        "determinant",
        determinants(spline, &parameters, mean),
    ));
    let scaled = used.iter().map(|&v| scaled[v as usize]);
    fields.push(column("scaled_jacobian", scaled.collect()));
    Some(Companion {
        name: "cut",
        mesh: Some(mesh),
        edges: lines,
        creases: Vec::new(),
        fields,
    })
}
