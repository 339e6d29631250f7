//! Moduli of tori.

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;

use super::shapes::{hopf, length_and_area, revolution};
use crate::{Atlas, FormChoice, Lattice};

/// The modulus of a torus by its form.
fn modulus(mesh: &TriangleMesh) -> [f64; 2] {
    let found = Atlas::closed(mesh, &FormChoice::default(), &mut unobserved()).unwrap();
    assert_eq!(
        (found.atlas.folded_faces(), found.atlas.zeros().len()),
        (0, 0)
    );
    let homology = found.basis.homology();
    let value = |part: &nalgebra::DVector<f64>| {
        let rows = homology.integer_periods();
        let row = |row: &Vec<i64>| {
            row.iter()
                .zip(part.iter())
                .map(|(n, a)| *n as f64 * a)
                .sum::<f64>()
        };
        rows.iter().map(row).collect::<Vec<_>>()
    };
    let [u, v] = [value(&found.form.real), value(&found.form.imaginary)];
    Lattice::reduced([[u[0], v[0]], [u[1], v[1]]])
        .unwrap()
        .modulus()
}

#[test]
fn tori_of_revolution_have_the_modulus_of_their_closed_form() {
    // The tube has length 2π in dφ/(R + r cos φ) r; the integral is 2π r / √(R² - r²).
    let exact = 0.8 / (4.0f64 - 0.64).sqrt();
    let errors = [1, 2].map(|k| {
        let [real, imaginary] = modulus(&revolution(40 * k, 24 * k, 2.0, 0.8));
        real.hypot(imaginary - 1.0 / exact)
    });
    let rate = (errors[0] / errors[1]).log2();
    assert!(
        errors[1] < 1e-2 && (rate - 2.0).abs() < 0.2,
        "{errors:?}, rate {rate}"
    );
}

#[test]
fn hopf_tori_are_skewed_as_their_curves_say() {
    let colatitude = |t: f64| 0.9 + 0.25 * (2.0 * t).sin() + 0.1 * t.cos();
    let slope = |t: f64| 0.5 * (2.0 * t).cos() - 0.1 * t.sin();
    let [length, area] = length_and_area(colatitude, slope);
    let exact = Lattice::reduced([[std::f64::consts::TAU, 0.0], [0.5 * area, 0.5 * length]]);
    let exact = exact.unwrap().modulus();
    assert!(exact[0].abs() > 0.05, "not skewed: {exact:?}");
    let errors = [1, 2].map(|k| {
        let found = modulus(&hopf(48 * k, 48 * k, colatitude));
        // A surface and its mirror image differ by the sign of the real part.
        (found[0].abs() - exact[0].abs()).hypot(found[1] - exact[1])
    });
    let rate = (errors[0] / errors[1]).log2();
    assert!(
        errors[1] < 1e-2 && (rate - 2.0).abs() < 0.3,
        "{errors:?}, rate {rate}"
    );
}

#[test]
fn the_modulus_does_not_depend_on_numbers_place_or_size() {
    let mesh = hopf(30, 30, |t| 0.9 + 0.3 * t.sin());
    let [real, imaginary] = modulus(&mesh);
    let count = mesh.vertex_count() as u32;
    let renamed = |v: u32| (v * 7 + 3) % count;
    let mut positions = mesh.positions().to_vec();
    for (v, p) in mesh.positions().iter().enumerate() {
        let turned = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.4) * p;
        positions[renamed(v as u32) as usize] =
            turned * 1e3 + nalgebra::Vector3::new(5.0, 1.0, 2.0);
    }
    let faces = mesh
        .faces()
        .iter()
        .rev()
        .map(|f| [f[1], f[2], f[0]].map(renamed))
        .collect();
    let other = modulus(&TriangleMesh::build(positions, faces).unwrap());
    assert!(
        (other[0] - real).hypot(other[1] - imaginary) < 1e-9,
        "{real} {imaginary} {other:?}"
    );
}

#[test]
fn lattices_are_reduced_and_their_coordinates_invert() {
    let lattice = Lattice::reduced([[1.0, 0.2], [17.3, 4.9]]).unwrap();
    let [tau_real, tau_imaginary] = lattice.modulus();
    assert!(tau_real.abs() <= 0.5 && tau_imaginary > 0.0);
    assert!(tau_real.hypot(tau_imaginary) >= 1.0);
    let [[a, b], [c, d]] = lattice.combinations;
    assert_eq!((a * d - b * c).abs(), 1);
    for (k, [m, n]) in lattice.combinations.into_iter().enumerate() {
        let again = [0, 1].map(|i| m as f64 * [1.0, 0.2][i] + n as f64 * [17.3, 4.9][i]);
        assert!((0..2).all(|i| (again[i] - lattice.periods[k][i]).abs() < 1e-12));
    }
    let [s, t] = lattice.coordinates([0.3, -0.7]);
    let [p, q] = lattice.periods;
    assert!((0..2).all(|i| (s * p[i] + t * q[i] - [0.3, -0.7][i]).abs() < 1e-14));
    assert!(Lattice::reduced([[1.0, 2.0], [2.0, 4.0]]).is_none());
}
