//! Harmonic and biharmonic functions on a mesh, and the Laplacians they come from.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::intrinsic_delaunay;
use msplines_common::operators::{Operators, assemble, mesh_operators};
use msplines_compare::peers::PeerRow;
use serde_json::json;

use super::adapter::{Adapter, Inputs};
use super::contest::{Rival, Timed};
use super::factor::{Lap, knots, largest_difference};
use super::{Contest, Failure, Model, Settings, Stand};

/// A package, what of it is asked, the name shown and what must be known of it.
pub(super) type Peer = (&'static str, &'static str, &'static str, &'static str);

const BIHARMONIC: [Peer; 2] = [
    (
        "libigl",
        "harmonic",
        "libigl harmonic, k = 2",
        "keeps no factor, so that each right-hand side costs the same again",
    ),
    (
        "libigl",
        "min_quad",
        "libigl min_quad_with_fixed",
        "the matrix is made with cotmatrix, massmatrix and SciPy",
    ),
];
const HARMONIC: [Peer; 3] = [
    (
        "libigl",
        "harmonic",
        "libigl harmonic, k = 1",
        "keeps no factor",
    ),
    (
        "potpourri3d",
        "harmonic",
        "potpourri3d cotan_laplacian, SciPy splu",
        "",
    ),
    (
        "robust_laplacian",
        "harmonic",
        "robust_laplacian, SciPy splu",
        "its Laplacian is the intrinsic Delaunay one, ours here the cotangent one",
    ),
];
const LAPLACIAN: [Peer; 2] = [
    ("libigl", "laplacian", "libigl cotmatrix and massmatrix", ""),
    (
        "potpourri3d",
        "laplacian",
        "potpourri3d cotan_laplacian and vertex_areas",
        "",
    ),
];
const INTRINSIC: [Peer; 1] = [(
    "robust_laplacian",
    "laplacian",
    "robust_laplacian mesh_laplacian",
    "works on the tufted cover, twice the faces, which also takes surfaces that are no manifolds",
)];

pub(super) fn run(settings: &Settings, model: Model) -> Result<Vec<PeerRow>, Failure> {
    let stand = settings.stand(model)?;
    let mut rows = Vec::new();
    for (order, task, peers) in [
        (
            2,
            "Biharmonic interpolation of 1 % of the vertices",
            &BIHARMONIC[..],
        ),
        (
            1,
            "Harmonic interpolation of 1 % of the vertices",
            &HARMONIC,
        ),
    ] {
        rows.extend(interpolation(settings, &stand, order, task, peers)?);
    }
    for (task, build, peers) in [
        (
            "Cotangent Laplacian and areas",
            cotangent as Build,
            &LAPLACIAN[..],
        ),
        (
            "Intrinsic Delaunay Laplacian and areas",
            intrinsic,
            &INTRINSIC,
        ),
    ] {
        rows.extend(laplacian(settings, &stand, task, build, peers)?);
    }
    Ok(rows)
}

fn inputs(mesh: &TriangleMesh, is_knot: &[bool]) -> Result<Inputs, Failure> {
    let inputs = Inputs::new()?;
    inputs.put("vertices", 3, flat(mesh))?;
    let faces = mesh.faces().as_flattened().iter().map(|&v| f64::from(v));
    inputs.put("faces", 3, faces.collect())?;
    let knots = (0..is_knot.len()).filter(|&vertex| is_knot[vertex]);
    inputs.put("knots", 1, knots.map(|vertex| vertex as f64).collect())?;
    Ok(inputs)
}

pub(super) fn flat(mesh: &TriangleMesh) -> Vec<f64> {
    let positions = mesh.positions().iter();
    positions.flat_map(|p| [p.x, p.y, p.z]).collect()
}

fn interpolation(
    settings: &Settings,
    stand: &Stand,
    order: u32,
    task: &str,
    peers: &[Peer],
) -> Result<Vec<PeerRow>, Failure> {
    let mesh = &stand.mesh;
    let is_knot = knots(mesh.vertex_count());
    let inputs = inputs(mesh, &is_knot)?;
    let (data, diagonal) = (flat(mesh), mesh.diagonal());
    let rms = |x: &[f64]| {
        let squares = x.iter().zip(&data).map(|(x, y)| (x - y) * (x - y));
        (squares.sum::<f64>() / mesh.vertex_count() as f64).sqrt() / diagonal
    };
    let contest = Contest {
        task,
        input: &stand.name,
        steps: &[
            "first result from the mesh",
            "other values at the same knots",
        ],
        measure: "root mean square distance from the mesh that the knots are taken from, and \
                  difference, against the diagonal",
        quality: &|x| Some(rms(x)),
        difference: &|x, y| Some(largest_difference(x, y) / diagonal),
    };
    let question = |ask: &str| json!({"ask": ask, "order": order});
    let mut ours = || interpolate(mesh, &is_knot, order);
    contest_all(settings, &contest, peers, &inputs, &question, &mut ours)
}

/// Runs a task against each peer of a list.
pub(super) fn contest_all(
    settings: &Settings,
    contest: &Contest<'_>,
    peers: &[Peer],
    inputs: &Inputs,
    question: &dyn Fn(&str) -> serde_json::Value,
    ours: &mut dyn FnMut() -> Result<Timed, Failure>,
) -> Result<Vec<PeerRow>, Failure> {
    let mut rows = Vec::new();
    for &(package, ask, name, remark) in peers {
        let (mut adapter, version) = match Adapter::start(settings, package, inputs) {
            Ok((adapter, version)) => (Some(adapter), Ok(version)),
            Err(reason) => (None, Err(reason)),
        };
        let rival = Rival {
            name,
            version,
            remark,
        };
        let mut theirs = || match &mut adapter {
            Some(adapter) => adapter.ask(&question(ask)),
            None => Err("it is not there".into()),
        };
        rows.extend(contest.run(settings, &rival, ours, &mut theirs)?);
    }
    Ok(rows)
}

/// From the mesh to a function with the positions at the knots, then another one with other values.
fn interpolate(mesh: &TriangleMesh, is_knot: &[bool], order: u32) -> Result<Timed, Failure> {
    let knots: Vec<u32> = (0..is_knot.len() as u32)
        .filter(|&vertex| is_knot[vertex as usize])
        .collect();
    let values = Mat::from_fn(knots.len(), 3, |k, axis| {
        mesh.positions()[knots[k] as usize][axis]
    });
    let others = Mat::from_fn(knots.len(), 3, |k, axis| 2.0 * values[(k, axis)]);
    let mut lap = Lap::start();
    let operators = mesh_operators(mesh);
    let matrix = if order == 1 {
        operators.laplacian
    } else {
        operators.bilaplacian()
    };
    let is_free = |row: usize| !is_knot[row];
    let ordering = Ordering::minimum_degree(&matrix, is_free)?;
    let symbolic = Symbolic::analyze_kept(&matrix, &ordering, is_free);
    let factor = Cholesky::factor(symbolic, &matrix)?;
    let first = extend(&matrix, &factor, &knots, &values);
    lap.end();
    let _other = extend(&matrix, &factor, &knots, &others);
    lap.end();
    let vertices = 0..mesh.vertex_count();
    let result = vertices.flat_map(|row| [0, 1, 2].map(|axis| first[(row, axis)]));
    Ok(lap.with(result.collect()))
}

/// Returns the function of least energy with these values at the knots.
fn extend(
    matrix: &SymmetricMatrix,
    factor: &Cholesky,
    knots: &[u32],
    values: &Mat<f64>,
) -> Mat<f64> {
    let mut x = matrix.multiply_columns(knots, values.as_ref());
    x *= -1.0;
    factor.solve_in_place(x.as_mut());
    for (k, &knot) in knots.iter().enumerate() {
        for axis in 0..values.ncols() {
            x[(knot as usize, axis)] = values[(k, axis)];
        }
    }
    x
}

/// From a mesh to its operators.
type Build = fn(&TriangleMesh) -> Result<Operators, Failure>;

fn cotangent(mesh: &TriangleMesh) -> Result<Operators, Failure> {
    Ok(mesh_operators(mesh))
}

fn intrinsic(mesh: &TriangleMesh) -> Result<Operators, Failure> {
    let flipped = intrinsic_delaunay(mesh)?;
    let vertices = mesh.vertex_count();
    Ok(assemble(vertices, &flipped.faces, &flipped.lengths))
}

fn laplacian(
    settings: &Settings,
    stand: &Stand,
    task: &str,
    build: Build,
    peers: &[Peer],
) -> Result<Vec<PeerRow>, Failure> {
    let mesh = &stand.mesh;
    let inputs = inputs(mesh, &knots(mesh.vertex_count()))?;
    let area = |x: &[f64]| x.iter().skip(3).step_by(4).sum::<f64>();
    let true_area: f64 = (0..mesh.face_count() as u32)
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            (b - a).cross(&(c - a)).norm() / 2.0
        })
        .sum();
    let flux = |x: &[f64]| -> Vec<f64> {
        let rows = x.chunks_exact(4).flat_map(|row| row[..3].to_vec());
        rows.collect()
    };
    let contest = Contest {
        task,
        input: &stand.name,
        steps: &["from the mesh"],
        measure: "how far the areas of the vertices are from that of the surface, against it; \
                  difference of the Laplacians of the positions against the largest",
        quality: &|x| Some((area(x) / true_area - 1.0).abs()),
        difference: &|x, y| {
            let (x, y) = (flux(x), flux(y));
            let scale = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            Some(largest_difference(&x, &y) / scale)
        },
    };
    let positions = Mat::from_fn(mesh.vertex_count(), 3, |v, axis| mesh.positions()[v][axis]);
    let mut ours = || {
        let mut lap = Lap::start();
        let operators = build(mesh)?;
        lap.end();
        let flux = operators.laplacian.multiply(positions.as_ref());
        let rows = operators.mass.iter().enumerate();
        let result = rows.flat_map(|(v, &area)| [flux[(v, 0)], flux[(v, 1)], flux[(v, 2)], area]);
        Ok(lap.with(result.collect()))
    };
    let question = |ask: &str| json!({"ask": ask});
    contest_all(settings, &contest, peers, &inputs, &question, &mut ours)
}
