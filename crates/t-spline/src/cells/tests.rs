//! The mesh's laws, and patches against the spline.

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;

use super::tile::Chart;
use super::*;
use crate::complex::{Beyond, CylinderComplex, Point};
use crate::samples::{
    Sequence, large_double_torus, large_torus, open_cylinder, random_mesh, surfaces_with_zeros,
};
use crate::space::tests::{random_points, random_space};
use crate::tmesh::Grid;

fn random_spline(complex: &Arc<CylinderComplex>, splits: usize, seed: u64) -> TSpline {
    let space = random_space(complex, splits, seed);
    let mut numbers = Sequence(seed);
    let control = (0..space.unknowns())
        .map(|_| Vector3::from_fn(|_, _| numbers.unit() - 0.5))
        .collect();
    TSpline::new(Arc::new(space), control)
}

const COARSE: CellOptions = CellOptions {
    tolerance: 1e-3,
    degree: 5,
};

/// Closed surfaces and their Euler characteristics.
fn closed() -> Vec<(Arc<CylinderComplex>, i64)> {
    let mut surfaces: Vec<_> = surfaces_with_zeros().into_iter().map(|s| (s, -2)).collect();
    surfaces.extend([0.0, 0.37].map(|twist| (large_torus(twist), 0)));
    surfaces
}

/// Asserts that faces agree about the edges between them.
fn assert_sides_agree(mesh: &QuadMesh, is_closed: bool) {
    let mut uses = vec![Vec::new(); mesh.edges().len()];
    for part in mesh.faces().iter().flat_map(|f| f.sides.iter().flatten()) {
        let length = part.range[1] - part.range[0];
        assert_eq!(length, mesh.edges()[part.edge.edge as usize].length);
        uses[part.edge.edge as usize].push(part.edge.reversed);
    }
    for found in uses {
        let twice = found.len() == 2 && found[0] != found[1];
        assert!(twice || !is_closed && found.len() == 1, "{found:?}");
    }
}

#[test]
fn meshes_have_the_characteristic_of_their_surface() {
    for (seed, (complex, characteristic)) in closed().into_iter().enumerate() {
        for splits in [0, 10, 80] {
            let grid = Grid {
                columns: 3,
                rows: 1,
            };
            let leaves = random_mesh(&complex, grid, splits, seed as u64);
            let mesh = QuadMesh::of_leaves(&leaves);
            assert_eq!(mesh.characteristic(), characteristic);
            assert_eq!(mesh.faces().len(), leaves.leaves().len());
            assert_sides_agree(&mesh, true);
            let valence = |v: &Vertex| match v.zero {
                // One zero of order 2, or two of order 1.
                Some(_) => 4 * (4 / complex.zeros() as u32 - complex.zeros() as u32 % 2),
                None if v.is_t_junction => 3,
                None => 4,
            };
            assert!(mesh.vertices().iter().all(|v| v.valence == valence(v)));
            assert_eq!(mesh.extraordinary().count(), complex.zeros());
            let anchors = leaves.anchors().len() + complex.zeros();
            assert_eq!(mesh.vertices().len(), anchors);
        }
    }
    for (top, characteristic) in [
        (Beyond::Boundary { index: 1 }, 0),
        (Beyond::Pole { index: 0 }, 1),
    ] {
        let mesh = random_spline(&open_cylinder(top), 40, 1).quad_mesh();
        assert_eq!(mesh.characteristic(), characteristic);
        assert_sides_agree(&mesh, false);
    }
}

#[test]
fn polylines_of_edges_run_between_their_vertices() {
    for (complex, _) in closed() {
        let spline = random_spline(&complex, 30, 3);
        let mesh = spline.quad_mesh();
        for edge in 0..mesh.edges().len() as u32 {
            let line = mesh.polyline(edge, 64);
            assert_eq!(line.len(), 65);
            let ends = mesh.edges()[edge as usize].ends;
            let ends = ends.map(|v| mesh.vertices()[v as usize].point);
            let points = spline.evaluate(&[line[0], ends[0], line[63], line[64]], Order::Value);
            let [start, same, near, end] = points.positions[..] else {
                panic!("four points");
            };
            assert!((start - same).norm() < 1e-12);
            // A step of 1/64, however steep the random surface.
            assert!((near - end).norm() < 0.5, "{}", (near - end).norm());
        }
    }
}

/// Returns the patch over a point, and its parameters there if they are linear.
fn over(patches: &[Patch], point: Point) -> Option<(&Patch, [f64; 2])> {
    let share = |range: [i64; 2], at: f64| (at - range[0] as f64) / (range[1] - range[0]) as f64;
    patches.iter().find_map(|patch| {
        let at = [share(patch.tile.x, point.x), share(patch.tile.y, point.y)];
        let inside = at.iter().all(|t| (0.0..=1.0).contains(t));
        (patch.tile.cylinder == point.cylinder && inside).then_some((patch, at))
    })
}

#[test]
fn exact_cells_are_the_spline() {
    let mut surfaces = closed();
    surfaces.push((open_cylinder(Beyond::Boundary { index: 1 }), 0));
    for (seed, (complex, _)) in surfaces.into_iter().enumerate() {
        let spline = random_spline(&complex, 50, seed as u64);
        let work = spline.patchwork(&COARSE).expect("patches");
        let points = random_points(&complex, 2000, 9);
        let truth = spline.evaluate(&points, Order::Value).positions;
        let (mut exact, mut error) = (0, 0.0_f64);
        for (&point, truth) in points.iter().zip(truth) {
            let (patch, at) = over(&work.patches, point).expect("tiles cover the surface");
            if patch.is_exact() {
                exact += 1;
                error = error.max((patch.position(at) - truth).norm());
            }
        }
        println!(
            "{exact} points in exact cells, error {error:e}, {:?}",
            work.report()
        );
        // Control points are of the size of 1.
        assert!(error < 1e-12, "{error:e}");
        assert!(exact > 500 && (complex.zeros() > 0 || exact == points.len()));
        let cells = work.cells().expect("cells");
        let report = work.report();
        assert_eq!(cells.len(), report.exact + report.approximate);
        assert!(complex.zeros() > 0 || report.approximate == 0 && report.gap < 1e-12);
    }
}

#[test]
fn cells_in_caps_are_within_the_tolerance() {
    for (seed, complex) in [
        large_double_torus(),
        open_cylinder(Beyond::Pole { index: 0 }),
    ]
    .iter()
    .chain(&surfaces_with_zeros()[1..])
    .enumerate()
    {
        let spline = random_spline(complex, 20, seed as u64);
        for (tolerance, degree) in [(1e-2, 3), (1e-3, 5)] {
            let options = CellOptions { tolerance, degree };
            let work = spline.patchwork(&options).expect("patches");
            let report = work.report();
            assert!(report.approximate > 0);
            let at_zeros = work
                .patches
                .iter()
                .filter(|p| matches!(p.chart, Chart::Zero { .. }));
            // 4 (m + 1) patches around a zero of order m, and the orders sum to 2 g - 2 = 2.
            let zeros = complex.zeros();
            assert_eq!(
                at_zeros.count(),
                4 * (zeros + if zeros > 0 { 2 } else { 0 })
            );
            assert!(report.deviation <= tolerance);
            // Edges are compared elsewhere than where sides were measured.
            assert!(report.gap <= 1.5 * tolerance);
            let mut numbers = Sequence(7);
            let mut worst = 0.0_f64;
            for patch in &work.patches[report.exact..] {
                let at = [numbers.unit(), numbers.unit()];
                let point = patch.tile.point(complex, patch.chart, at);
                let truth = spline.evaluate(&[point], Order::Value).positions[0];
                worst = worst.max((patch.position(at) - truth).norm());
            }
            println!("{report:?}, elsewhere {worst:e}");
            // Between the points where the deviation is measured it may be a little larger.
            assert!(worst <= 1.5 * tolerance, "{worst:e}");
        }
    }
}

#[test]
fn shells_are_closed() {
    for (complex, _) in closed() {
        let spline = random_spline(&complex, 40, 2);
        let options = CellOptions {
            degree: 3,
            ..COARSE
        };
        let work = spline.patchwork(&options).expect("patches");
        let shell = work.shell().expect("a shell");
        let components = shell.components();
        assert!(components.len() == 1 && components[0].is_closed);
        if complex.zeros() == 0 {
            assert!(shell.tolerance() < 1e-11, "{}", shell.tolerance());
        }
    }
    let spline = random_spline(&open_cylinder(Beyond::Pole { index: 0 }), 10, 2);
    let shell = spline.patchwork(&COARSE).expect("patches").shell();
    let shell = shell.expect("a shell");
    let once = shell.components();
    assert!(once.len() == 1 && !once[0].is_closed);
}

#[test]
fn threads_do_not_matter() {
    let spline = random_spline(&large_double_torus(), 20, 4);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| spline.patchwork(&COARSE).expect("patches"))
    };
    let [one, three] = [run(1), run(3)];
    assert_eq!(one.patches, three.patches);
    assert_eq!((one.mesh, one.report), (three.mesh, three.report));
}

#[test]
fn what_cannot_be_had_is_refused() {
    let spline = random_spline(&large_double_torus(), 0, 4);
    for (tolerance, degree) in [(0.0, 5), (f64::NAN, 5), (1e-3, 2), (1e-3, 10)] {
        let refused = spline.patchwork(&CellOptions { tolerance, degree });
        let error = refused.expect_err("refused");
        assert!(matches!(error, CellError::Options { .. }));
        assert!(error.to_string().contains("a degree from 3 to 9"));
    }
}

/// Edges are no shorter, in units: rounding parts what is one line by a few units, and the leaves of these meshes
/// are wider than a thousand times this.
const SHORTEST: i64 = 1 << 20;

#[test]
fn no_edge_is_what_rounding_left() {
    for (seed, (complex, characteristic)) in closed().into_iter().enumerate() {
        for splits in [0, 12, 40] {
            let spline = random_spline(&complex, splits, seed as u64);
            let work = spline.patchwork(&COARSE).expect("patches");
            assert_sides_agree(&work.mesh, true);
            assert_eq!(work.mesh.characteristic(), characteristic);
            let lengths = work.mesh.edges().iter().map(|edge| edge.length);
            let shortest = lengths.min().expect("edges");
            assert!(shortest >= SHORTEST, "{seed}, {splits}: {shortest}");
        }
    }
}

#[test]
fn tiles_are_shifted_by_rounding_alone() {
    for (seed, (complex, _)) in closed().into_iter().enumerate() {
        let spline = random_spline(&complex, 40, seed as u64);
        let work = spline.patchwork(&COARSE).expect("patches");
        let mut most = 0;
        for Patch { tile, cell, .. } in &work.patches {
            let pairs = [(tile.x, cell.x), (tile.y, cell.y)].into_iter();
            let ends = pairs.flat_map(|(from, to)| [to[0] - from[0], to[1] - from[1]]);
            most = ends.map(i64::abs).fold(most, i64::max);
        }
        // One unit where two lines meet, and in a chain one for each.
        assert!(most <= 4, "{seed}: {most}");
    }
}

#[test]
fn lines_that_meet_nowhere_stay() {
    // Each turn around the torus comes back three units beside its line.
    let size = (1_i64 << 43) + 77;
    let complex = Arc::new(CylinderComplex::torus(size, size / 2, 3).expect("a torus"));
    let spline = random_spline(&complex, 10, 5);
    let work = spline.patchwork(&COARSE).expect("patches");
    assert_sides_agree(&work.mesh, true);
    assert_eq!(work.mesh.characteristic(), 0);
    let shortest = work.mesh.edges().iter().map(|edge| edge.length).min();
    assert_eq!(shortest, Some(3));
}
