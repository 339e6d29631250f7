//! Laws of the mesher: exactness, angles, topology, and what is refused.

mod refusals;
mod solids;
mod stencil_angles;

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::TetFacts;
use msplines_common::progress::unobserved;
use nalgebra::{Point3, Vector3};

use super::crossings::crossings;
use super::grid::{Grid, STEPS};
use super::lattice::Lattice;
use super::{Filled, MesherError, MesherOptions, Spacing, Wanted, fill};

/// Dihedral angles that the method promises, in degrees.
///
/// # Reference
/// [Labelle2007] abstract.
const BOUNDS: [f64; 2] = [10.7, 164.8];

fn options(along_diagonal: f64) -> MesherOptions {
    MesherOptions {
        spacing: Spacing::AlongDiagonal(along_diagonal),
        ..MesherOptions::default()
    }
}

fn filled(surface: &TriangleMesh, options: &MesherOptions) -> Filled {
    fill(surface, options, &mut unobserved()).unwrap()
}

fn moved(surface: &TriangleMesh, to: impl Fn(Point3<f64>) -> Point3<f64>) -> TriangleMesh {
    surface.with_positions(surface.positions().iter().map(|&p| to(p)).collect())
}

/// Both surfaces as one.
fn both(one: &TriangleMesh, two: &TriangleMesh) -> TriangleMesh {
    let shift = one.vertex_count() as u32;
    let positions = [one.positions(), two.positions()].concat();
    let second = two.faces().iter().map(|face| face.map(|v| v + shift));
    TriangleMesh::build(
        positions,
        one.faces().iter().copied().chain(second).collect(),
    )
    .unwrap()
}

fn turned(surface: &TriangleMesh) -> TriangleMesh {
    let faces = surface.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriangleMesh::build(surface.positions().to_vec(), faces).unwrap()
}

/// The box from the origin to a corner, of 12 triangles.
fn block(corner: [f64; 3]) -> TriangleMesh {
    let positions = (0..8u32)
        .map(|i| {
            let at = [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
            Point3::new(at[0] * corner[0], at[1] * corner[1], at[2] * corner[2])
        })
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    TriangleMesh::build(positions, faces).unwrap()
}

fn check(filled: &Filled) -> TetFacts {
    filled.mesh.topology().sanity_check();
    let facts = TetFacts::measure(&filled.mesh);
    assert_eq!(facts.not_positive, 0);
    let attempt = filled.report.attempts.last().unwrap();
    assert_eq!(
        attempt.euler_characteristic,
        facts.boundary_euler_characteristic
    );
    let found = [facts.dihedral_angle.min, facts.dihedral_angle.max];
    assert_eq!([attempt.smallest_angle, attempt.largest_angle], found);
    let [low, high] = found.map(f64::to_degrees);
    assert!(low > BOUNDS[0] && high < BOUNDS[1], "{low} {high}");
    facts
}

/// Checks that the ends of a lattice edge differ exactly where there is a cut, and returns the
/// number of lattice points inside.
fn consistent(surface: &TriangleMesh, spacing: f64) -> usize {
    let grid = Grid::build(surface, spacing).unwrap();
    let found = crossings(&grid, &grid.rounded(surface), surface.faces());
    let lattice = Lattice::build(&grid, &found, false);
    let mut cuts: Vec<(u32, u8)> = Vec::new();
    for id in 0..grid.point_count() as u32 {
        let at = grid.coordinates(id);
        assert_eq!(grid.id(at), id);
        for (direction, step) in STEPS.into_iter().enumerate() {
            let to = [0, 1, 2].map(|axis| at[axis] + step[axis]);
            let within = (0..3).all(|axis| (0..=grid.size[axis]).contains(&to[axis]));
            let differ =
                within && lattice.inside[id as usize] != lattice.inside[grid.id(to) as usize];
            cuts.extend(differ.then_some((id, direction as u8)));
        }
    }
    let found: Vec<(u32, u8)> = lattice
        .cuts
        .iter()
        .map(|cut| (cut.ends[0], cut.direction))
        .collect();
    assert_eq!(found, cuts);
    lattice.inside.iter().filter(|&&inside| inside).count()
}

#[test]
fn signs_agree_in_all_directions_even_where_everything_coincides() {
    // Faces, edges and vertices of the box lie on lattice planes, lines and points.
    let cube = block([2.0, 2.0, 2.0]);
    for spacing in [0.25, 0.5, 1.0, 2.0] {
        let inside = consistent(&cube, spacing);
        // Moved infinitesimally, as many lattice points are inside as there are in the volume.
        let expected = 2.0 * (2.0 / spacing).powi(3);
        assert_eq!(inside as f64, expected, "{spacing}");
    }
    let octahedron = {
        let positions = [
            [1, 0, 0],
            [-1, 0, 0],
            [0, 1, 0],
            [0, -1, 0],
            [0, 0, 1],
            [0, 0, -1],
        ];
        let positions = positions.map(|p| Point3::from(p.map(f64::from))).to_vec();
        let faces = [
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        TriangleMesh::build(positions, faces.to_vec()).unwrap()
    };
    for spacing in [1.0, 0.5, 0.125] {
        assert!(consistent(&octahedron, spacing) > 0);
    }
}

#[test]
fn lattice_points_inside_are_those_inside_a_ball() {
    let ball = msplines_common::mesh::shapes::sphere(2000);
    let inside = consistent(&ball, 0.1);
    // Two points per cubed spacing; the inscribed polyhedron is smaller by less than one percent.
    let expected = 2.0 * 4.0 / 3.0 * std::f64::consts::PI / 1e-3;
    assert!(
        (inside as f64 / expected - 1.0).abs() < 0.01,
        "{inside} {expected}"
    );
}

#[test]
fn shifts_and_scales_of_two_change_nothing() {
    let surface = msplines_common::mesh::zoo::closed();
    let one = filled(&surface, &options(12.0)).mesh;
    let two = filled(&moved(&surface, |p| p * 8.0), &options(12.0)).mesh;
    assert_eq!(one.cells(), two.cells());
    let scaled: Vec<_> = one.positions().iter().map(|p| p * 8.0).collect();
    assert_eq!(scaled, two.positions());
    let far = Vector3::new(1e6, -2e6, 3e6);
    let three = filled(&moved(&surface, |p| p + far), &options(12.0)).mesh;
    let apart = |p: &Point3<f64>, q: &Point3<f64>| (q - far - p).norm();
    let largest = one
        .positions()
        .iter()
        .zip(three.positions())
        .map(|(p, q)| apart(p, q));
    // Rounding of the shifted coordinates and of the whole numbers.
    assert!(largest.fold(0.0, f64::max) < 1e-6);
}

#[test]
fn threads_and_orientation_change_no_bit() {
    let surface = msplines_common::mesh::shapes::bumpy_sphere(20_000);
    let on = |threads: usize, surface: &TriangleMesh| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| filled(surface, &options(15.0)))
    };
    let one = on(1, &surface);
    for other in [on(3, &surface), on(2, &turned(&surface))] {
        assert_eq!(one.mesh.positions(), other.mesh.positions());
        assert_eq!(one.mesh.cells(), other.mesh.cells());
        assert_eq!(one.report.attempts[0].cells, other.report.attempts[0].cells);
    }
    assert_eq!(one.report, on(4, &surface).report);
}

#[test]
fn wanted_topology_is_met_or_refused() {
    let knot = msplines_common::mesh::zoo::knotted();
    let error = fill(&knot, &options(20.0), &mut unobserved()).unwrap_err();
    assert_eq!(error, MesherError::Genus { genus: 1 });
    let like = MesherOptions {
        wanted: Wanted::LikeInput,
        ..options(40.0)
    };
    for (surface, euler) in [(knot, 0), (msplines_common::mesh::zoo::genus(2), -2)] {
        let facts = check(&filled(&surface, &like));
        assert_eq!(facts.boundary_euler_characteristic, euler);
    }
}
