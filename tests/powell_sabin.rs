//! Laws of Powell-Sabin surfaces on every mesh of the zoo: closed, open, knotted, with handles.

use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, TriangleMesh, zoo};
use msplines_common::progress::unobserved;
use msplines_conformal::{Atlas, AtlasOptions};
use msplines_powell_sabin::{
    PowellSabinSurface, SurfaceOptions, VertexCondition, estimate_normals, fit_surface,
};
use nalgebra::Vector3;
use rayon::ThreadPoolBuilder;

type Failure = Box<dyn std::error::Error>;

/// Interpolation to rounding, relative to the diagonal.
const EXACT: f64 = 1e-14;
/// Central differences with this step, relative to a face, of a surface of quadratic pieces.
const STEP: f64 = 1e-5;
/// Their rounding, and what a piece that ends within a step bends.
const DIFFERENCES: f64 = 1e-4;

fn surface(mesh: &TriangleMesh) -> Result<PowellSabinSurface, Failure> {
    let atlas = Atlas::of_surface(mesh, &AtlasOptions::default(), &mut unobserved())?.atlas;
    let normals = estimate_normals(atlas.mesh())?;
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let options = SurfaceOptions::default();
    Ok(fit_surface(&atlas, &conditions, &options, &mut unobserved())?.spline)
}

fn values(spline: &PowellSabinSurface, points: &[SurfacePoint]) -> Result<Vec<f64>, Failure> {
    let mut samples = Samples::default();
    spline.prepare(points, Order::Value)?.evaluate(&mut samples);
    Ok(samples.values)
}

#[test]
fn every_corner_of_every_face_is_its_vertex() -> Result<(), Failure> {
    for mesh in zoo::all() {
        let spline = surface(&mesh)?;
        let domain = spline.mesh();
        for corner in 0..3 {
            let mut at = [0.0; 3];
            at[corner] = 1.0;
            let faces = 0..domain.face_count() as u32;
            let points: Vec<SurfacePoint> = faces.map(|face| SurfacePoint { face, at }).collect();
            let found = values(&spline, &points)?;
            for (place, face) in found.chunks(3).zip(domain.faces()) {
                let vertex = domain.positions()[face[corner] as usize].coords;
                let miss = (Vector3::from_column_slice(place) - vertex).norm();
                assert!(miss <= EXACT * domain.diagonal(), "{miss}");
            }
        }
    }
    Ok(())
}

#[test]
fn any_number_of_threads_gives_the_same_bits() -> Result<(), Failure> {
    for mesh in zoo::all() {
        let with = |threads: usize| -> Result<Vec<u64>, Failure> {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            let spline = pool.install(|| surface(&mesh).map_err(|e| e.to_string()))?;
            let parts = spline.parts();
            let numbers = parts.gradients.iter().flatten().flatten();
            Ok(numbers.map(|x| x.to_bits()).collect())
        };
        assert_eq!(with(1)?, with(3)?);
    }
    Ok(())
}

#[test]
fn derivatives_are_those_of_the_values() -> Result<(), Failure> {
    for mesh in zoo::all() {
        let spline = surface(&mesh)?;
        let domain = spline.mesh();
        for face in (0..domain.face_count() as u32).step_by(7) {
            let at = [0.31, 0.42, 0.27];
            let mut samples = Samples::default();
            let point = SurfacePoint { face, at };
            spline
                .prepare(&[point], Order::First)?
                .evaluate(&mut samples);
            let [a, b, c] = domain.triangle(face);
            let [along, left] = domain.face_frame(face);
            // Along each of two sides, by the frame and by differences.
            for (side, step) in [(b - a, [-1.0, 1.0, 0.0]), (c - a, [-1.0, 0.0, 1.0])] {
                let moved = |sign: f64| SurfacePoint {
                    face,
                    at: [0, 1, 2].map(|i| at[i] + sign * STEP * step[i]),
                };
                let ends = values(&spline, &[moved(1.0), moved(-1.0)])?;
                let [u, v] = [side.dot(&along), side.dot(&left)];
                for k in 0..3 {
                    let difference = (ends[k] - ends[3 + k]) / (2.0 * STEP);
                    let derivative = u * samples.first[k] + v * samples.first[3 + k];
                    let miss = (difference - derivative).abs();
                    assert!(miss <= DIFFERENCES * side.norm(), "face {face}: {miss}");
                }
            }
        }
    }
    Ok(())
}

#[test]
fn a_point_that_does_not_exist_is_an_error() -> Result<(), Failure> {
    let spline = surface(&zoo::with_boundary())?;
    let faces = spline.mesh().face_count();
    let nowhere = SurfacePoint {
        face: faces as u32,
        at: [1.0, 0.0, 0.0],
    };
    let error = spline.prepare(&[nowhere], Order::Value).err();
    assert!(matches!(
        error,
        Some(EvaluateError::NoSuchFace { point: 0, .. })
    ));
    let outside = SurfacePoint {
        face: 0,
        at: [2.0, -1.0, 0.0],
    };
    let error = spline.prepare(&[outside], Order::Value).err();
    assert!(matches!(
        error,
        Some(EvaluateError::OutsideFace { point: 0, face: 0 })
    ));
    Ok(())
}
