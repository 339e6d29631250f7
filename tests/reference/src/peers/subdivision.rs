//! One step of subdivision, from arrays to arrays.

use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness, catmull_clark};
use msplines_common::mesh::{TriangleMesh, subdivide_loop};
use msplines_compare::peers::PeerRow;
use nalgebra::Point3;
use serde_json::json;

use super::adapter::Inputs;
use super::contest::{Rival, Timed, version_of};
use super::factor::Lap;
use super::surface::{Peer, contest_all, flat};
use super::{Contest, Failure, MIDDLE, Settings, Stand};
use crate::{Library, bindings, openmesh_loop, polygon};

const LOOP: [Peer; 2] = [
    (
        "libigl",
        "loop",
        "libigl loop",
        "other weights than those of Loop 1987, as the difference shows",
    ),
    ("pymeshlab", "loop", "PyMeshLab Loop", ""),
];
const CATMULL_CLARK: [Peer; 1] = [(
    "pymeshlab",
    "catmull_clark",
    "PyMeshLab Catmull-Clark",
    "its quads are pairs of triangles, and its vertices lie elsewhere",
)];
/// How far from a vertex its counterpart is looked for, against the diagonal.
const REACH: f64 = 1e-3;

pub(super) fn run(settings: &Settings) -> Result<Vec<PeerRow>, Failure> {
    let stand = settings.stand(MIDDLE)?;
    let mut rows = by_loop(settings, &stand)?;
    rows.extend(by_catmull_clark(settings, &stand)?);
    Ok(rows)
}

fn inputs(mesh: &TriangleMesh) -> Result<Inputs, Failure> {
    let inputs = Inputs::new()?;
    inputs.put("vertices", 3, flat(mesh))?;
    let corners = mesh.faces().as_flattened().iter();
    inputs.put("faces", 3, corners.map(|&v| f64::from(v)).collect())?;
    Ok(inputs)
}

fn by_loop(settings: &Settings, stand: &Stand) -> Result<Vec<PeerRow>, Failure> {
    let mesh = &stand.mesh;
    let diagonal = mesh.diagonal();
    let contest = Contest {
        task: "Loop subdivision",
        input: &format!("{}, {} faces", stand.name, mesh.face_count()),
        steps: &["one step, from arrays to arrays"],
        measure: MEASURE,
        quality: &|_| None,
        difference: &|a, b| Some(unmatched(a, b, diagonal)),
    };
    let mut ours = || {
        let (positions, faces) = (mesh.positions().to_vec(), mesh.faces().to_vec());
        let mut lap = Lap::start();
        let fine = subdivide_loop(&TriangleMesh::build(positions, faces)?, 1);
        lap.end();
        Ok(lap.with(flat(&fine)))
    };
    let rival = Rival {
        name: "OpenMesh LoopT",
        version: version_of(Library::OpenMesh),
        remark: "",
    };
    let mut rows = contest.run(settings, &rival, &mut ours, &mut || {
        let mut lap = Lap::start();
        let (positions, _) = openmesh_loop(mesh);
        lap.end();
        Ok(lap.with(positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect()))
    })?;
    let question = |ask: &str| json!({"ask": ask});
    let inputs = inputs(mesh)?;
    let others = contest_all(settings, &contest, &LOOP, &inputs, &question, &mut ours)?;
    rows.extend(others);
    Ok(rows)
}

/// What the rows of subdivision say.
const MEASURE: &str = "none, the schemes are exact; difference: largest distance of a vertex from \
                       the nearest one of the peer, against the diagonal";

fn by_catmull_clark(settings: &Settings, stand: &Stand) -> Result<Vec<PeerRow>, Failure> {
    let mesh = &stand.mesh;
    let diagonal = mesh.diagonal();
    let corners = mesh.faces().as_flattened().to_vec();
    let offsets: Vec<u32> = (0..=mesh.face_count() as u32).map(|f| 3 * f).collect();
    let contest = Contest {
        task: "Catmull-Clark subdivision",
        input: &format!("{}, {} triangles", stand.name, mesh.face_count()),
        steps: &["one step, from arrays to arrays"],
        measure: MEASURE,
        quality: &|_| None,
        difference: &|a, b| Some(unmatched(a, b, diagonal)),
    };
    let mut ours = || {
        let positions = mesh.positions().to_vec();
        let (corners, offsets) = (corners.clone(), offsets.clone());
        let mut lap = Lap::start();
        let control = PolygonMesh::build(positions, corners, offsets)?;
        let rules = Rules::default();
        let smooth = Sharpness::smooth(control.topology(), rules);
        let refined = catmull_clark(control.topology(), &smooth, rules);
        let found: Vec<Point3<f64>> = refined.stencils.apply(control.positions());
        lap.end();
        Ok(lap.with(found.iter().flat_map(|p| [p.x, p.y, p.z]).collect()))
    };
    let control = PolygonMesh::build(mesh.positions().to_vec(), corners.clone(), offsets.clone())?;
    let smooth = Sharpness::smooth(control.topology(), Rules::default());
    let control = polygon::control(&control, &smooth, Rules::default(), 1);
    let rival = Rival {
        name: "OpenSubdiv",
        version: version_of(Library::OpenSubdiv),
        remark: "the positions alone, in double precision",
    };
    let mut rows = contest.run(settings, &rival, &mut ours, &mut || opensubdiv(&control))?;
    let question = |ask: &str| json!({"ask": ask});
    let inputs = inputs(mesh)?;
    let peers = &CATMULL_CLARK;
    rows.extend(contest_all(
        settings, &contest, peers, &inputs, &question, &mut ours,
    )?);
    Ok(rows)
}

fn opensubdiv(control: &bindings::Control) -> Result<Timed, Failure> {
    let mut lap = Lap::start();
    let positions = bindings::opensubdiv_positions(control)?;
    lap.end();
    Ok(lap.with(positions))
}

/// Returns the largest distance of a point of `ours` from the nearest one of `theirs` against the
/// diagonal, at most [`REACH`]; infinite if there are not as many.
fn unmatched(ours: &[f64], theirs: &[f64], diagonal: f64) -> f64 {
    if ours.len() != theirs.len() {
        return f64::INFINITY;
    }
    let (ours, _) = ours.as_chunks::<3>();
    let (theirs, _) = theirs.as_chunks::<3>();
    let mut sorted = theirs.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let farthest = ours.iter().map(|&p| nearest(&sorted, p, REACH * diagonal));
    farthest.fold(0.0, f64::max) / diagonal
}

/// Returns the distance of the nearest of points that ascend in their first coordinate, at most `reach`.
fn nearest(sorted: &[[f64; 3]], p: [f64; 3], reach: f64) -> f64 {
    let middle = sorted.partition_point(|q| q[0] < p[0]);
    let distance = |q: &[f64; 3]| (Point3::from(*q) - Point3::from(p)).norm();
    let mut best = reach;
    // Both ways until the first coordinate alone is farther away.
    for q in &sorted[middle..] {
        if q[0] - p[0] >= best {
            break;
        }
        best = best.min(distance(q));
    }
    for q in sorted[..middle].iter().rev() {
        if p[0] - q[0] >= best {
            break;
        }
        best = best.min(distance(q));
    }
    best
}
