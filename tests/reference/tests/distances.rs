//! Distances between surfaces against CGAL's: of T-splines from what they were fitted to, of random
//! copies from what they are copies of.

use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{SurfaceTree, distance};
use msplines_reference::record::Comparison;
use msplines_reference::t_splines::{Whole, generated, model_names, models, tessellated};
use msplines_reference::{Library, cgal_hausdorff, cgal_sampled, meshes};
use nalgebra::Point3;

type Failure = Box<dyn std::error::Error>;

/// Points that are drawn from each surface, here and there.
const POINTS: usize = 100_000;
/// Error that CGAL's distance may have, over the diagonal.
const ERROR: f64 = 2e-5;
/// Segments along each edge of a face.
const SEGMENTS: u32 = 2;
/// Rounding of a closest point, whose coordinates are of the size of the diagonal.
const ROUNDING: f64 = 1e-14;
/// Standard errors by which two means of independent samples differ but once in a million.
const STANDARD_ERRORS: f64 = 5.0;
/// That none of as many points as CGAL drew is as far as CGAL's thirtieth is as unlikely as thirty
/// tosses of a coin that all fall alike.
const RANK: usize = 30;

/// Mean, mean square and their variances.
struct Moments {
    mean: [f64; 2],
    variance: [f64; 2],
}

impl Moments {
    fn of(distances: &[f64]) -> Self {
        let mean = |power: i32| {
            let sum: f64 = distances.iter().map(|d| d.powi(power)).sum();
            sum / distances.len() as f64
        };
        let variance = |power: i32| mean(2 * power) - mean(power).powi(2);
        Self {
            mean: [1, 2].map(mean),
            variance: [1, 2].map(variance),
        }
    }
}

/// The comparisons of all fits.
struct Comparisons {
    points: Comparison,
    means: Comparison,
    above: Comparison,
    below: Comparison,
}

impl Comparisons {
    fn new() -> Self {
        let new =
            |quantity: &str, bound, why: &str| Comparison::new(quantity, Library::Cgal, bound, why);
        Self {
            points: new("distance of points", ROUNDING, "relative to the diagonal"),
            means: new(
                "mean and mean square distance",
                STANDARD_ERRORS,
                "in standard errors: both sides draw points of their own",
            ),
            above: new(
                "sampled over Hausdorff distance",
                ERROR,
                "relative to the diagonal: points are no farther than the surface, but for CGAL's error",
            ),
            below: new(
                "sampled under ranked distance",
                0.0,
                "relative to the diagonal: of as many points one is as far as CGAL's thirtieth",
            ),
        }
    }

    fn add(
        &mut self,
        name: &str,
        input: &TriangleMesh,
        shown: &TriangleMesh,
    ) -> Result<(), Failure> {
        let diagonal = input.diagonal();
        let (mut hausdorff, mut ranked) = (0.0_f64, 0.0_f64);
        let (mut mean, mut variance) = ([0.0; 2], [0.0; 2]);
        for (from, to) in [(input, shown), (shown, input)] {
            hausdorff = hausdorff.max(cgal_hausdorff(from, to, ERROR * diagonal)? / diagonal);
            let theirs = cgal_sampled(from, to, POINTS)?;
            assert_eq!(theirs.len(), POINTS, "{name}");
            self.points.add(name, misses(&theirs, to, diagonal));
            let mut sorted: Vec<f64> = theirs.iter().map(|(_, d)| d / diagonal).collect();
            sorted.sort_by(f64::total_cmp);
            ranked = ranked.max(sorted[POINTS - RANK]);
            let moments = Moments::of(&sorted);
            for power in 0..2 {
                mean[power] += moments.mean[power] / 2.0;
                // Of the mean of two means, and ours varies as much as theirs.
                variance[power] += 2.0 * moments.variance[power] / (4 * POINTS) as f64;
            }
        }
        let ours = distance(input, shown, POINTS, 7)?;
        println!("{name}: {ours:?}, Hausdorff {hausdorff:e}, thirtieth {ranked:e}");
        let found = [ours.mean, ours.rms * ours.rms];
        let apart = [0, 1].map(|k| (found[k] - mean[k]).abs() / variance[k].sqrt());
        self.means.add(name, apart);
        self.above.add(name, [(ours.max - hausdorff).max(0.0)]);
        self.below.add(name, [(ranked - ours.max).max(0.0)]);
        Ok(())
    }

    fn finish(self) {
        for comparison in [self.points, self.means, self.above, self.below] {
            comparison.finish();
        }
    }
}

/// Differences of the distances of points from a surface, over the diagonal.
fn misses<'a>(
    theirs: &'a [(Point3<f64>, f64)],
    to: &TriangleMesh,
    diagonal: f64,
) -> impl Iterator<Item = f64> + 'a {
    let tree = SurfaceTree::build(to);
    theirs.iter().map(move |(point, theirs)| {
        let ours = tree.closest(point).expect("a surface").distance;
        (ours - theirs).abs() / diagonal
    })
}

#[test]
fn distances_are_those_of_cgal() -> Result<(), Failure> {
    let mut comparisons = Comparisons::new();
    for Whole {
        name,
        mesh,
        surface,
    } in generated().into_iter().chain(models(&model_names()))
    {
        comparisons.add(&name, &mesh, &tessellated(&surface, SEGMENTS))?;
    }
    for (seed, (name, mesh)) in meshes::generated().into_iter().enumerate() {
        let copy = meshes::jittered(&mesh, 0.3, seed as u64);
        comparisons.add(&format!("{name} and a jittered copy"), &mesh, &copy)?;
    }
    comparisons.finish();
    Ok(())
}

/// The checks above can fail.
#[test]
fn a_distance_of_other_surfaces_is_another() -> Result<(), Failure> {
    let mesh = msplines_common::mesh::shapes::torus(1.0, 0.4, 1_500);
    let moved = mesh
        .positions()
        .iter()
        .map(|p| p + nalgebra::Vector3::new(0.0, 0.0, 0.01));
    let moved = mesh.with_positions(moved.collect());
    let theirs = cgal_hausdorff(&mesh, &moved, 1e-4)?;
    // Where the torus is level it is a hundredth away, and nowhere more.
    assert!((theirs - 0.01).abs() < 2e-4, "{theirs}");
    let ours = distance(&mesh, &moved, POINTS, 1)?.max * mesh.diagonal();
    assert!((ours - theirs).abs() < 2e-4, "{ours}");
    Ok(())
}
