//! One lattice: from crossings to a mesh, or to what is wrong with it.

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::{TetMesh, dihedral_angles};
use msplines_common::metrics::SurfaceTree;
use nalgebra::Point3;
use rayon::prelude::*;

use super::boundary::Boundary;
use super::crossings::crossings;
use super::error::{MesherError, Shortfall};
use super::grid::Grid;
use super::lattice::Lattice;
use super::options::{MesherOptions, Parts, Wanted};
use super::parts::Labels;
use super::report::Attempt;
use super::tetrahedra::{Origin, Tetrahedra, tetrahedra};
use super::warp::warp;

/// Rounds after which contacts are given up; one or two are usual, as each lets at least one more
/// lattice point keep its place.
const MOST_ROUNDS: u32 = 20;

/// Points searched by one task; fixed, though the result does not depend on it.
const BLOCK: usize = 512;

/// Returns the mesh from a lattice of this spacing, or what is wrong with it.
pub(super) fn run(
    surface: &TriangleMesh,
    spacing: f64,
    expected: Option<i64>,
    options: &MesherOptions,
) -> Result<(Attempt, Result<TetMesh, Shortfall>), MesherError> {
    let grid = Grid::build(surface, spacing)?;
    let points = grid.rounded(surface);
    let mut attempt = Attempt {
        spacing,
        lattice_points: grid.point_count(),
        ..Attempt::default()
    };
    let crossings = crossings(&grid, &points, surface.faces());
    let lattice = Lattice::build(&grid, &crossings, is_inwards(surface)?);
    if !lattice.inside.contains(&true) {
        attempt.shortfall = Some(Shortfall::Empty);
        return Ok((attempt, Err(Shortfall::Empty)));
    }
    let result = stuff(&grid, &lattice, &mut attempt)
        .and_then(|solid| choose(solid, options, &mut attempt))
        .and_then(|solid| measure(surface, solid, expected, options, &mut attempt));
    attempt.shortfall = result.as_ref().err().cloned();
    Ok((attempt, result))
}

/// Returns whether normals point into the solid.
fn is_inwards(surface: &TriangleMesh) -> Result<bool, MesherError> {
    let [low, high] = surface.bounding_box();
    let (centre, scale) = (nalgebra::center(&low, &high), (high - low).norm());
    let volume: f64 = (0..surface.face_count() as u32)
        .map(|face| {
            let [a, b, c] = surface.triangle(face).map(|p| (p - centre) / scale);
            a.dot(&b.cross(&c))
        })
        .sum();
    // Below this the sum is rounding: what it would enclose is thinner than any lattice.
    if volume.abs() > 1e-12 {
        Ok(volume < 0.0)
    } else {
        Err(MesherError::NoVolume)
    }
}

/// Returns the inside of the lattice, with contacts of the boundary with itself undone.
fn stuff(grid: &Grid, lattice: &Lattice, attempt: &mut Attempt) -> Result<Tetrahedra, Shortfall> {
    let mut unmoved: Vec<u32> = Vec::new();
    loop {
        let solid = tetrahedra(grid, &warp(lattice, &unmoved));
        // A layer of lattice points can be moved onto the boundary from both sides.
        if solid.cells.is_empty() {
            return Err(Shortfall::Empty);
        }
        let boundary = Boundary::build(&solid);
        attempt.unmoved_points = unmoved.len();
        attempt.euler_characteristic = boundary.euler_characteristic;
        let Some(&place) = boundary.contacts.first() else {
            return Ok(solid);
        };
        let before = unmoved.len();
        unmoved.extend(moved_at(&solid, &boundary));
        unmoved.sort_unstable();
        unmoved.dedup();
        attempt.repair_rounds += 1;
        if unmoved.len() == before || attempt.repair_rounds > MOST_ROUNDS {
            let position = solid.positions[place as usize].coords.data.0[0];
            return Err(Shortfall::Contact { position });
        }
    }
}

/// Returns the lattice points that were moved into a contact; where there are none, those next to it.
fn moved_at(solid: &Tetrahedra, boundary: &Boundary) -> Vec<u32> {
    let moved = |&vertex: &u32| match solid.origins[vertex as usize] {
        Origin::Moved(point) => Some(point),
        Origin::Inside | Origin::Cut(_) => None,
    };
    let at: Vec<u32> = boundary.contacts.iter().filter_map(moved).collect();
    if !at.is_empty() {
        return at;
    }
    let touches = |face: &&[u32; 3]| {
        face.iter()
            .any(|vertex| boundary.contacts.binary_search(vertex).is_ok())
    };
    let faces = boundary.faces.iter().filter(touches);
    faces.flatten().filter_map(moved).collect()
}

/// Counts the parts, and drops all but one if that is asked for.
fn choose(
    solid: Tetrahedra,
    options: &MesherOptions,
    attempt: &mut Attempt,
) -> Result<Tetrahedra, Shortfall> {
    let labels = Labels::build(&solid);
    attempt.parts = labels.count();
    match options.parts {
        _ if attempt.parts == 1 => Ok(solid),
        Parts::Largest => {
            let kept = labels.largest(&solid);
            attempt.euler_characteristic = Boundary::build(&kept).euler_characteristic;
            Ok(kept)
        }
        Parts::All if options.wanted == Wanted::Sphere => {
            let vertex = labels.in_smallest(&solid);
            Err(Shortfall::SeveralParts {
                parts: attempt.parts,
                position: solid.positions[vertex as usize].coords.data.0[0],
            })
        }
        Parts::All => Ok(solid),
    }
}

/// Returns the mesh if its boundary has the right topology and nothing of the surface is far.
fn measure(
    surface: &TriangleMesh,
    solid: Tetrahedra,
    expected: Option<i64>,
    options: &MesherOptions,
    attempt: &mut Attempt,
) -> Result<TetMesh, Shortfall> {
    let contact = Shortfall::Contact {
        position: solid.positions[0].coords.data.0[0],
    };
    // What is left here has no contacts, so that this does not fail.
    let mesh = TetMesh::build(solid.positions, solid.cells).map_err(|_| contact)?;
    let boundary = mesh.boundary();
    attempt.cells = mesh.cell_count();
    attempt.vertices = mesh.vertex_count();
    attempt.boundary_faces = boundary.face_count();
    (attempt.smallest_angle, attempt.largest_angle) = angles(&mesh);
    let far = farthest(surface, &boundary, attempt.spacing);
    let diagonal = surface.diagonal();
    attempt.farthest = far.distance / diagonal;
    attempt.rms = far.rms / diagonal;
    let position = far.point.coords.data.0[0];
    if let Some(expected) = expected
        && attempt.euler_characteristic != expected
    {
        let found = attempt.euler_characteristic;
        return Err(Shortfall::Topology {
            found,
            expected,
            position,
        });
    }
    if far.distance > options.farthest * attempt.spacing {
        return Err(Shortfall::PartLost {
            vertex: far.vertex,
            position,
            distance: far.distance,
        });
    }
    Ok(mesh)
}

/// Returns the smallest and the largest dihedral angle.
fn angles(mesh: &TetMesh) -> (f64, f64) {
    (0..mesh.cell_count() as u32)
        .into_par_iter()
        .flat_map_iter(|cell| dihedral_angles(&mesh.tetrahedron(cell)))
        // order-free: smallest and largest numbers.
        .fold(
            || (f64::INFINITY, 0.0),
            |(low, high), angle| (angle.min(low), angle.max(high)),
        )
        // order-free: smallest and largest numbers.
        .reduce(
            || (f64::INFINITY, 0.0),
            |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1)),
        )
}

/// The point of a surface that is farthest from another one.
struct Farthest {
    point: Point3<f64>,
    /// A vertex of its triangle.
    vertex: u32,
    distance: f64,
    rms: f64,
}

/// Returns the point of `surface` farthest from `boundary`, among its vertices and, where its
/// triangles are large against `spacing`, points of them less than half of that apart.
fn farthest(surface: &TriangleMesh, boundary: &TriangleMesh, spacing: f64) -> Farthest {
    let tree = SurfaceTree::build(boundary);
    let mut points: Vec<(u32, Point3<f64>)> =
        (0..).zip(surface.positions().iter().copied()).collect();
    for (face, corners) in surface.faces().iter().enumerate() {
        let [a, b, c] = surface.triangle(face as u32);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let pieces = (longest / (0.5 * spacing)).ceil() as u32;
        for i in 0..=pieces {
            // Vertices are there already, and edges of small triangles are close to them.
            for j in (0..=pieces - i).filter(|j| ![0, pieces].contains(&(i + j)) || pieces > 2) {
                let at = [i, j].map(|x| f64::from(x) / f64::from(pieces));
                points.push((corners[0], a + (b - a) * at[0] + (c - a) * at[1]));
            }
        }
    }
    let distances: Vec<f64> = points
        .par_chunks(BLOCK)
        .flat_map_iter(|block| {
            let distance = |(_, point): &(u32, Point3<f64>)| {
                tree.closest(point).map_or(0.0, |closest| closest.distance)
            };
            block.iter().map(distance).collect::<Vec<_>>()
        })
        .collect();
    let squares: f64 = distances.iter().map(|d| d * d).sum();
    let place = (0..distances.len())
        .rev()
        .max_by(|&a, &b| distances[a].total_cmp(&distances[b]))
        .unwrap_or(0);
    Farthest {
        point: points[place].1,
        vertex: points[place].0,
        distance: distances[place],
        rms: (squares / distances.len() as f64).sqrt(),
    }
}
