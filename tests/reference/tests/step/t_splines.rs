//! Shells of T-splines that were fitted to whole surfaces.

use msplines_common::bspline::BezierShell;
use msplines_common::evaluate::Order;
use msplines_common::mesh::shapes;
use msplines_io::write_step;
use msplines_reference::Library;
use msplines_reference::draw;
use msplines_reference::meshes;
use msplines_reference::record::Comparison;
use msplines_reference::t_splines::{Whole, generated, models, tessellated, whole};
use msplines_t_spline::cells::CellOptions;

use crate::{Failure, TOLERANCE, measures};

/// How far patches of caps may be from the surface, over the diagonal, and their degree: what the program
/// writes.
const SHELL: (f64, u8) = (1e-5, 5);
/// What OpenCASCADE is asked for, of an area.
const ACCURACY: f64 = 1e-8;
/// Its quadrature stops early, by powers of ten.
const QUADRATURE: f64 = 1e-5;
/// Triangles lie inside of what bends: the area of those of a quarter of an edge is that much less.
const TESSELLATION: f64 = 1e-2;
/// Segments along each edge of a face.
const SEGMENTS: u32 = 4;
/// Faces of a shell that are evaluated, about, and where.
const FACES: usize = 200;
const PLACES: [[f64; 2]; 3] = [[0.0, 0.0], [0.31, 0.72], [1.0, 0.5]];
/// Rounding of numbers that came through a file with all their digits.
const ROUNDING: f64 = 1e-13;
/// Models that are read.
const MODELS: [&str; 2] = ["kitten_40k.ply", "fertility_30k.ply"];

/// More models of genus 2 and above, and their numbers of control points.
const MORE: [(&str, usize); 2] = [("double_torus_2k.ply", 500), ("eight_g2.ply", 500)];

/// The quantities of all fits.
struct Comparisons {
    exact: Comparison,
    approximate: Comparison,
    area: Comparison,
    shown: Comparison,
}

fn comparisons() -> Comparisons {
    let new = |quantity: &str, bound, why: &str| {
        Comparison::new(quantity, Library::OpenCascade, bound, why)
    };
    Comparisons {
        exact: new(
            "STEP exact patches of T-splines",
            ROUNDING,
            "relative to the diagonal",
        ),
        approximate: new(
            "STEP patches of caps of T-splines",
            1.5,
            "over the tolerance: between the points where it is measured a patch may be farther",
        ),
        area: new(
            "STEP area of T-splines",
            QUADRATURE,
            "relative to a Gauss rule on the patches",
        ),
        shown: new(
            "STEP area of T-splines and of their triangles",
            TESSELLATION,
            "relative; triangles lie inside of what bends",
        ),
    }
}

/// Returns the length of the shortest edge, along its control points.
fn shortest(shell: &BezierShell) -> f64 {
    let lengths = shell.edges().iter().map(|edge| {
        let steps = edge.curve.points.windows(2).map(|p| (p[1] - p[0]).norm());
        steps.sum::<f64>()
    });
    lengths.fold(f64::INFINITY, f64::min)
}

/// Fits of more surfaces of genus 2 and above, most of all zeros.
fn more() -> Vec<Whole> {
    let mut fits = vec![whole("genus 4", shapes::genus(4, 5_000), &[], 1_200)];
    let others = MORE.into_iter().filter_map(|(name, most)| {
        let mesh = meshes::model(name)?;
        Some(whole(name, mesh, &[], most))
    });
    fits.extend(others);
    fits
}

fn add(found: &mut Comparisons, whole: &Whole) -> Result<(), Failure> {
    let Whole {
        name,
        mesh,
        surface,
    } = whole;
    let diagonal = mesh.diagonal();
    let (share, degree) = SHELL;
    let tolerance = share * diagonal;
    let work = surface
        .spline()
        .patchwork(&CellOptions { tolerance, degree })?;
    let (shell, report) = (work.shell()?, work.report());
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("shell.step");
    write_step(&path, &shell)?;

    // OpenCASCADE tells no shorter edges from points.
    let shortest = shortest(&shell);
    assert!(shortest > TOLERANCE, "{name}: {shortest:e}");
    let shape = draw::read_step(&path, ACCURACY)?;
    let said = &shape.said;
    assert!(shape.is_valid, "{name}: {said}");
    let count = shell.faces().len();
    assert_eq!(count, report.exact + report.approximate, "{name}");
    let parts = ["FACE", "SHELL", "SOLID"].map(|part| shape.counts.get(part).copied());
    assert_eq!(parts, [Some(count), Some(1), Some(1)], "{name}: {said}");
    assert_eq!(shape.free_bounds, 0, "{name}: {said}");
    // Edges are as far from their patches as we say, or as near as OpenCASCADE tells apart.
    let allowed = TOLERANCE.max(2.0 * shell.tolerance());
    assert!(
        shape.tolerance <= allowed,
        "{name}: {} of {allowed:e}",
        shape.tolerance
    );
    let zeros = surface.domain().zeros().len() + surface.domain().poles().len();
    assert_eq!(report.approximate == 0, zeros == 0, "{name}");

    let stride = count.div_ceil(FACES);
    let faces = (0..count).filter(|face| face % stride == 0 || *face >= report.exact);
    let places: Vec<_> = faces.flat_map(|f| PLACES.map(|at| (f, at))).collect();
    let theirs = draw::surface_points(&path, &places)?;
    let points: Vec<_> = places
        .iter()
        .map(|&(face, at)| work.place(face, at))
        .collect();
    let ours = surface.spline().evaluate(&points, Order::Value).positions;
    for ((theirs, ours), (face, _)) in theirs.iter().zip(&ours).zip(&places) {
        let apart = (theirs - ours).norm();
        if *face < report.exact {
            found.exact.add(name, [apart / diagonal]);
        } else {
            found.approximate.add(name, [apart / tolerance]);
        }
    }

    let [area, _] = measures(shell.faces());
    found.area.add(name, [(shape.area / area - 1.0).abs()]);
    let shown = tessellated(surface, SEGMENTS);
    let faces = 0..shown.face_count() as u32;
    let triangles: f64 = faces.map(|face| 0.5 * shown.face_normal(face).norm()).sum();
    found
        .shown
        .add(name, [(shape.area / triangles - 1.0).abs()]);
    println!(
        "{name}: {count} faces, {report:?}, tolerance {:e}, theirs {:e}, area {} and {area} and {triangles}",
        shell.tolerance(),
        shape.tolerance,
        shape.area,
    );
    Ok(())
}

#[test]
fn shells_of_fits_are_the_surface_and_exact_ones_valid_and_closed() -> Result<(), Failure> {
    let mut found = comparisons();
    let fits = generated().into_iter().chain(models(&MODELS));
    for whole in fits.chain(more()) {
        add(&mut found, &whole)?;
    }
    let Comparisons {
        exact,
        approximate,
        area,
        shown,
    } = found;
    for comparison in [exact, approximate, area, shown] {
        comparison.finish();
    }
    Ok(())
}
