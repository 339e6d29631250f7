//! The distance between two surfaces, sampled on both.

use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::tree::SurfaceTree;
use crate::mesh::{SurfacePoint, TriangleMesh};

/// Samples searched one after another, each from where the last one ended. Fixed, so that the
/// result does not depend on the number of threads.
const BLOCK: usize = 512;

/// Two-sided distance between two surfaces as a fraction of the diagonal of the first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    /// Mean over the samples of both surfaces.
    pub mean: f64,
    /// Root of the mean square over the samples of both surfaces.
    pub rms: f64,
    /// Largest distance of a sample: a lower bound of the Hausdorff distance.
    pub max: f64,
}

/// Why a distance cannot be measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DistanceError {
    /// A surface has no area, or a coordinate that is not finite.
    #[error("the {which} surface has no area to sample, or coordinates that are not finite")]
    NoArea {
        /// `first` or `second`.
        which: &'static str,
    },
    /// No samples were asked for.
    #[error("at least one sample is needed")]
    NoSamples,
}

/// Returns the distance between two surfaces from `samples` area-uniform points on each, drawn with
/// `seed`, to the other surface.
///
/// Lengths are taken relative to the centre of the first surface and divided by its diagonal. The
/// result is the same for any number of threads. Cost: O((samples + faces) log faces).
///
/// # Errors
/// If a surface has no area or no samples are asked for.
pub fn distance(
    input: &TriangleMesh,
    output: &TriangleMesh,
    samples: usize,
    seed: u64,
) -> Result<Distance, DistanceError> {
    if samples == 0 {
        return Err(DistanceError::NoSamples);
    }
    let [low, high] = input.bounding_box();
    let centre = nalgebra::center(&low, &high);
    let [first, second] = [input, output].map(|mesh| {
        mesh.with_positions(
            mesh.positions()
                .iter()
                .map(|p| Point3::from(p - centre))
                .collect(),
        )
    });
    let mut random = Pcg64::seed_from_u64(seed);
    let mut there = sample(&first, samples, &mut random, "first")?;
    let mut back = sample(&second, samples, &mut random, "second")?;
    let (to_second, to_first) = (SurfaceTree::build(&second), SurfaceTree::build(&first));
    to_distances(&mut there, &to_second);
    to_distances(&mut back, &to_first);
    let (mut sum, mut squares, mut max) = (0.0, 0.0, 0.0f64);
    for squared in there.iter().chain(&back).map(|point| point.x) {
        sum += squared.sqrt();
        squares += squared;
        max = max.max(squared);
    }
    let count = (2 * samples) as f64;
    let diagonal = input.diagonal();
    Ok(Distance {
        mean: sum / count / diagonal,
        rms: (squares / count).sqrt() / diagonal,
        max: max.sqrt() / diagonal,
    })
}

/// Replaces each point by its squared distance in the first coordinate.
fn to_distances(points: &mut [Point3<f64>], tree: &SurfaceTree) {
    points.par_chunks_mut(BLOCK).for_each(|block| {
        let mut hint = None;
        for point in block {
            if let Some((slot, squared)) = tree.search(point, hint) {
                hint = Some(slot);
                point.x = squared;
            }
        }
    });
}

fn sample(
    mesh: &TriangleMesh,
    samples: usize,
    random: &mut Pcg64,
    which: &'static str,
) -> Result<Vec<Point3<f64>>, DistanceError> {
    let points =
        area_uniform_points(mesh, samples, random).ok_or(DistanceError::NoArea { which })?;
    Ok(points
        .into_iter()
        .map(|point| mesh.position(point))
        .collect())
}

/// Returns points drawn uniformly by area, in order of their faces; `None` without area.
fn area_uniform_points(
    mesh: &TriangleMesh,
    samples: usize,
    random: &mut Pcg64,
) -> Option<Vec<SurfacePoint>> {
    let mut total = 0.0;
    let until: Vec<f64> = (0..mesh.face_count() as u32)
        .map(|face| {
            total += mesh.face_normal(face).norm();
            total
        })
        .collect();
    if !(total > 0.0 && f64::is_finite(total)) {
        return None;
    }
    let mut draws: Vec<f64> = (0..samples)
        .map(|_| random.random::<f64>() * total)
        .collect();
    // In order of faces, so that a search starts near the last one.
    draws.sort_unstable_by(f64::total_cmp);
    let mut face = 0;
    let points = draws.into_iter().map(|draw| {
        while face + 1 < until.len() && until[face] <= draw {
            face += 1;
        }
        let (root, across) = (random.random::<f64>().sqrt(), random.random::<f64>());
        SurfacePoint {
            face: face as u32,
            at: [1.0 - root, root * (1.0 - across), root * across],
        }
    });
    Some(points.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    /// A sphere of this many vertices lies within 3e-4 of the round one.
    const VERTICES: usize = 10_000;

    #[test]
    fn concentric_spheres_are_their_difference_of_radii_apart() {
        let sphere = shapes::sphere(VERTICES);
        let larger = sphere.with_positions(sphere.positions().iter().map(|p| p * 1.25).collect());
        let found = distance(&sphere, &larger, 5_000, 1).unwrap();
        let expected = 0.25 / sphere.diagonal();
        for measure in [found.mean, found.rms, found.max] {
            assert!((measure / expected - 1.0).abs() < 2e-3, "{found:?}");
        }
    }

    #[test]
    fn shifted_planes_are_the_shift_apart_however_far_away() {
        let patch = shapes::height_field(400);
        let moved = |x: f64, z: f64| {
            patch.with_positions(
                patch
                    .positions()
                    .iter()
                    .map(|p| Point3::new(p.x + x, p.y, z))
                    .collect(),
            )
        };
        for far in [0.0, 1e9] {
            let found = distance(&moved(far, 0.0), &moved(far, 0.5), 1_000, 1).unwrap();
            let expected = 0.5 / 8f64.sqrt();
            assert!((found.mean - expected).abs() < 1e-6, "{found:?}");
            assert!((found.max - expected).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn samples_are_uniform_by_area() {
        // Two squares of area 1 and 3; the side of the larger is 3.
        let positions = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [4., 0.], [4., 1.]];
        let positions = positions.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        let faces = vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]];
        let mesh = TriangleMesh::build(positions, faces).unwrap();
        let mut random = Pcg64::seed_from_u64(3);
        let points = area_uniform_points(&mesh, 40_000, &mut random).unwrap();
        let mut counts = [0; 4];
        let mut sum = nalgebra::Vector3::zeros();
        for point in &points {
            counts[point.face as usize] += 1;
            sum += mesh.position(*point).coords;
        }
        // Standard deviations are 66 and 97 samples; the tests allow five.
        assert!(
            counts[..2].iter().all(|&n: &i32| (n - 5_000).abs() < 330),
            "{counts:?}"
        );
        assert!(
            counts[2..].iter().all(|&n: &i32| (n - 15_000).abs() < 485),
            "{counts:?}"
        );
        assert!((sum / 40_000.0 - nalgebra::Vector3::new(2.0, 0.5, 0.0)).norm() < 0.04);
    }

    #[test]
    fn threads_do_not_change_a_bit_and_seeds_do() {
        let (one, two) = (shapes::sphere(1_000), shapes::bumpy_sphere(1_000));
        let on = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| distance(&one, &two, 3_000, seed).unwrap())
        };
        assert_eq!(on(1, 7), on(3, 7));
        assert_ne!(on(1, 7), on(1, 8));
    }

    #[test]
    fn a_surface_without_area_is_named() {
        let sphere = shapes::sphere(100);
        let point = sphere.with_positions(vec![Point3::origin(); sphere.vertex_count()]);
        let error = distance(&sphere, &point, 10, 1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the second surface has no area to sample, or coordinates that are not finite"
        );
        assert_eq!(
            distance(&sphere, &sphere, 0, 1),
            Err(DistanceError::NoSamples)
        );
    }
}
