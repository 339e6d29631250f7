//! Decomposition into layers: parts that add up, detail that sits where it is wanted.

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::{Outcome, unobserved};

use super::{positions, space};
use crate::{DecomposeError, Decomposition, FitError, KnotChoice, Layer, Options, decompose};

fn layers(mesh: &TriangleMesh, counts: &[usize], weights: Option<&[f64]>) -> Decomposition {
    let values = positions(mesh);
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    let layers: Vec<Layer<'_>> = counts
        .iter()
        .map(|&count| Layer {
            knots: KnotChoice::Optimised { count },
            weights,
        })
        .collect();
    let space = Arc::new(space(mesh));
    decompose(
        &space,
        data,
        &layers,
        &Options::default(),
        &mut unobserved(),
    )
    .unwrap()
}

fn energy(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum()
}

#[test]
fn layers_and_residual_add_up_to_the_data() {
    const TOLERANCE: f64 = 1e-14;
    let mesh = shapes::bumpy_sphere(2500);
    let parts = layers(&mesh, &[40, 150], None);
    let sum = parts.recombine(&[1.0, 1.0, 1.0]).unwrap();
    for (a, b) in sum.iter().zip(&positions(&mesh)) {
        assert!((a - b).abs() < TOLERANCE * mesh.diagonal());
    }
    assert_eq!(parts.outcome(), Outcome::Converged);
    let first = positions(&mesh);
    let after_one: Vec<f64> = first
        .iter()
        .zip(&parts.layer_values[0])
        .map(|(a, b)| a - b)
        .collect();
    assert!(energy(&parts.residual) < 0.2 * energy(&after_one));
}

#[test]
fn factors_scale_the_parts() {
    let mesh = shapes::bumpy_sphere(1200);
    let parts = layers(&mesh, &[30], None);
    assert_eq!(parts.recombine(&[1.0, 0.0]).unwrap(), parts.layer_values[0]);
    let doubled = parts.recombine(&[1.0, 2.0]).unwrap();
    let plain = positions(&mesh);
    for i in 0..plain.len() {
        assert!((doubled[i] - plain[i] - parts.residual[i]).abs() < 1e-12);
    }
    let too_few = parts.recombine(&[1.0]).unwrap_err();
    assert_eq!(too_few, DecomposeError::Factors { found: 1, parts: 2 });
    let text = parts.recombine(&[1.0, f64::NAN]).unwrap_err().to_string();
    assert_eq!(text, "factor 1 is NaN; give finite factors");
}

/// A region of large weight is followed closely, the rest stays smooth.
#[test]
fn detail_gathers_in_the_region_of_interest() {
    let mesh = shapes::bumpy_sphere(4000);
    let region: Vec<bool> = mesh.positions().iter().map(|p| p.x > 0.4).collect();
    let weights: Vec<f64> = region.iter().map(|&r| if r { 10.0 } else { 1.0 }).collect();
    let inside = |parts: &Decomposition| {
        let square = |i: usize| parts.residual[i].powi(2);
        (0..parts.residual.len())
            .filter(|i| region[i / 3])
            .map(square)
            .sum::<f64>()
    };
    let plain = inside(&layers(&mesh, &[40, 120], None));
    let weighted = inside(&layers(&mesh, &[40, 120], Some(&weights)));
    assert!(weighted < 0.5 * plain, "{weighted} {plain}");
}

#[test]
fn what_cannot_be_decomposed_is_refused() {
    let mesh = shapes::sphere(200);
    let values = positions(&mesh);
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    let space = Arc::new(space(&mesh));
    let run = |layers: &[Layer<'_>]| {
        decompose(&space, data, layers, &Options::default(), &mut unobserved()).unwrap_err()
    };
    assert_eq!(run(&[]), DecomposeError::NoLayers);
    let layer = |count| Layer {
        knots: KnotChoice::Optimised { count },
        weights: None,
    };
    let error = run(&[layer(20), layer(9999)]);
    let DecomposeError::Layer { layer: 2, source } = &error else {
        panic!("{error}");
    };
    assert!(matches!(source, FitError::KnotCount { .. }));
    assert!(
        error.to_string().starts_with("layer 2: 9999 knots"),
        "{error}"
    );
}
