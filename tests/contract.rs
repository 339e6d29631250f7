//! Laws that every method keeps on every mesh it accepts.

use std::ops::ControlFlow;

use msplines_common::evaluate::{Order, Samples, VertexData};
use msplines_common::mesh::{SurfacePoint, TriangleMesh, zoo};
use msplines_common::progress::{Outcome, unobserved};
use msplines_tests::{Places, largest_difference, mean_distance, methods, positions, spread};
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::ThreadPoolBuilder;

/// Two solves of a well-scaled system of a few hundred unknowns, both to rounding.
const DIRECT: f64 = 1e-9;
/// Fits at given places are iterated to a relative residual of 1e-6, at condition numbers up to 100.
const ITERATED: f64 = 1e-4;

type Failure = Box<dyn std::error::Error>;

fn data(values: &[f64]) -> VertexData<'_> {
    VertexData {
        dimension: 3,
        values,
    }
}

/// Calls `law` with each method on each mesh of the zoo, named for messages.
fn everywhere(
    law: impl Fn(&str, msplines_tests::Fit, &TriangleMesh) -> Result<(), Failure>,
) -> Result<(), Failure> {
    for (index, mesh) in zoo::all().iter().enumerate() {
        for (name, fit) in methods() {
            law(&format!("{name} on mesh {index} of the zoo"), fit, mesh)?;
        }
    }
    Ok(())
}

#[test]
fn any_number_of_threads_gives_the_same_bits() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let with = |threads: usize| -> Result<Vec<u64>, Failure> {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            let places = Places::Chosen(mesh.vertex_count() / 12);
            let fitted = pool.install(|| {
                fit(mesh, data(&values), places, &mut unobserved()).map(|fitted| fitted.values)
            })?;
            Ok(fitted.iter().map(|value| value.to_bits()).collect())
        };
        let one = with(1)?;
        for threads in [2, 3] {
            assert_eq!(one, with(threads)?, "{name}, {threads} threads");
        }
        Ok(())
    })
}

#[test]
fn more_coefficients_give_a_smaller_error() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let error = |count: usize| -> Result<f64, Failure> {
            let fitted = fit(
                mesh,
                data(&values),
                Places::Chosen(count),
                &mut unobserved(),
            )?;
            assert!(fitted.values.iter().all(|v| v.is_finite()), "{name}");
            Ok(mean_distance(&fitted.values, &values) / mesh.diagonal())
        };
        let (coarse, fine) = (
            error(mesh.vertex_count() / 20)?,
            error(mesh.vertex_count() / 5)?,
        );
        assert!(
            fine < 0.6 * coarse,
            "{name}: {coarse} with few, {fine} with four times as many"
        );
        Ok(())
    })
}

#[test]
fn constants_are_reproduced() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values: Vec<f64> = (0..mesh.vertex_count())
            .flat_map(|_| [3.0, -7.0, 0.25])
            .collect();
        let places = Places::Given(spread(mesh, 20));
        let fitted = fit(mesh, data(&values), places, &mut unobserved())?;
        let difference = largest_difference(&fitted.values, &values);
        assert!(difference < DIRECT, "{name}: {difference:e}");
        Ok(())
    })
}

#[test]
fn an_affine_map_of_the_data_is_one_of_the_spline() -> Result<(), Failure> {
    let turn = Matrix3::new(0.0, -2.0, 0.5, 1.0, 0.3, 0.0, 0.2, 0.0, -1.5);
    let shift = Vector3::new(10.0, -20.0, 30.0);
    let map = |values: &[f64]| -> Vec<f64> {
        let (points, _) = values.as_chunks::<3>();
        points
            .iter()
            .flat_map(|&p| <[f64; 3]>::from(turn * Vector3::from(p) + shift))
            .collect()
    };
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let places = Places::Given(spread(mesh, mesh.vertex_count() / 12));
        let mapped = fit(mesh, data(&map(&values)), places.clone(), &mut unobserved())?.values;
        let fitted = fit(mesh, data(&values), places, &mut unobserved())?.values;
        let difference = largest_difference(&mapped, &map(&fitted)) / mesh.diagonal();
        assert!(difference < ITERATED, "{name}: {difference:e}");
        Ok(())
    })
}

#[test]
fn numbering_does_not_matter() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let count = mesh.vertex_count() as u32;
        // A step without a common factor visits every vertex.
        let step = (count / 3..)
            .find(|&s| greatest_common_divisor(s, count) == 1)
            .unwrap_or(1);
        let renumber = |v: u32| ((u64::from(v) * u64::from(step)) % u64::from(count)) as u32;
        let mut moved = vec![Point3::origin(); count as usize];
        for (v, &position) in (0..).zip(mesh.positions()) {
            moved[renumber(v) as usize] = position;
        }
        let faces = mesh.faces().iter().map(|face| face.map(renumber)).collect();
        let other = TriangleMesh::build(moved, faces)?;

        let places = spread(mesh, mesh.vertex_count() / 12);
        let mut others: Vec<u32> = places.iter().map(|&v| renumber(v)).collect();
        others.sort_unstable();
        let (a, b) = (positions(mesh), positions(&other));
        let a = fit(mesh, data(&a), Places::Given(places), &mut unobserved())?.values;
        let b = fit(&other, data(&b), Places::Given(others), &mut unobserved())?.values;
        let back: Vec<f64> = (0..count)
            .flat_map(|v| b[3 * renumber(v) as usize..][..3].to_vec())
            .collect();
        let difference = largest_difference(&a, &back) / mesh.diagonal();
        assert!(difference < ITERATED, "{name}: {difference:e}");
        Ok(())
    })
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

#[test]
fn evaluated_corners_are_the_values_at_the_vertices() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let places = Places::Given(spread(mesh, 40));
        let fitted = fit(mesh, data(&values), places, &mut unobserved())?;
        let corners = (0..mesh.face_count() as u32).step_by(7);
        let corners: Vec<(u32, usize)> = corners.map(|face| (face, face as usize % 3)).collect();
        let points: Vec<SurfacePoint> = corners
            .iter()
            .map(|&(face, corner)| {
                let mut at = [0.0; 3];
                at[corner] = 1.0;
                SurfacePoint { face, at }
            })
            .collect();
        let mut samples = Samples::default();
        fitted
            .spline
            .prepare(&points, Order::Value)?
            .evaluate(&mut samples);
        let expected: Vec<f64> = corners
            .iter()
            .flat_map(|&(face, corner)| {
                let vertex = mesh.faces()[face as usize][corner] as usize;
                fitted.values[3 * vertex..][..3].to_vec()
            })
            .collect();
        assert_eq!(
            (samples.dimension, samples.values.len()),
            (3, expected.len()),
            "{name}"
        );
        let difference = largest_difference(&samples.values, &expected) / mesh.diagonal();
        assert!(difference < DIRECT, "{name}: {difference:e}");
        Ok(())
    })
}

#[test]
fn an_order_or_a_point_that_does_not_exist_is_an_error() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let places = Places::Given(spread(mesh, 20));
        let fitted = fit(mesh, data(&values), places, &mut unobserved())?;
        let centre = [1.0 / 3.0; 3];
        let inside = [SurfacePoint {
            face: 0,
            at: centre,
        }];
        let outside = [SurfacePoint {
            face: mesh.face_count() as u32,
            at: centre,
        }];
        let spline = &fitted.spline;
        assert!(spline.prepare(&inside, Order::Value).is_ok(), "{name}");
        assert!(spline.prepare(&outside, Order::Value).is_err(), "{name}");
        // A method that gets derivatives replaces this line by their comparison with differences.
        assert!(spline.prepare(&inside, Order::Second).is_err(), "{name}");
        Ok(())
    })
}

#[test]
fn bad_data_is_refused_with_a_text() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let good = positions(mesh);
        let mut with_nan = good.clone();
        with_nan[10] = f64::NAN;
        let count = mesh.vertex_count();
        let cases = [
            ("NaN", with_nan, Places::Chosen(20)),
            ("a value too few", good[1..].to_vec(), Places::Chosen(20)),
            (
                "more places than vertices",
                good.clone(),
                Places::Chosen(count + 1),
            ),
            ("no place", good.clone(), Places::Given(Vec::new())),
            ("a place twice", good.clone(), Places::Given(vec![3, 3, 5])),
            (
                "a place that does not exist",
                good,
                Places::Given(vec![0, 1, count as u32]),
            ),
        ];
        for (case, values, places) in cases {
            let refused = fit(mesh, data(&values), places, &mut unobserved());
            match refused {
                Ok(_) => panic!("{name}: {case} was accepted"),
                Err(text) => assert!(text.len() > 10, "{name}: {case}: {text}"),
            }
        }
        Ok(())
    })
}

#[test]
fn a_stopped_fit_gives_the_best_so_far() -> Result<(), Failure> {
    everywhere(|name, fit, mesh| {
        let values = positions(mesh);
        let mut calls = 0;
        let mut stop = |_: &msplines_common::progress::Progress| {
            calls += 1;
            if calls > 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let fitted = fit(mesh, data(&values), Places::Chosen(60), &mut stop)?;
        assert_eq!(fitted.outcome, Outcome::Stopped, "{name}");
        assert!(fitted.values.iter().all(|v| v.is_finite()), "{name}");
        Ok(())
    })
}
