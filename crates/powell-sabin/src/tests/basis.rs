//! B-spline form and energies.

use super::{Random, interpolant, jittered_grid, points, random_spline, torus};
use crate::element::MacroTriangle;
use crate::energy::{ElementMatrix, energy, membrane, thin_plate};
use crate::triangles::bezier_points;
use crate::{Basis, FlatDomain};

const UNITY: f64 = 1e-12;

fn domains() -> Vec<FlatDomain> {
    let mut domains = vec![torus(5, 0.0).0, torus(6, 0.24).0];
    domains.extend((0..4).map(|seed| jittered_grid(6, 0.16 * seed as f64, seed)));
    domains
}

#[test]
fn basis_functions_are_a_partition_of_unity() {
    for domain in domains() {
        let basis = Basis::new(&domain);
        for face in 0..domain.mesh().face_count() as u32 {
            let ordinates = basis.ordinates(face);
            for k in 0..ordinates[0].len() {
                let column = ordinates.map(|function| function[k]);
                assert!(column.iter().all(|&b| b >= 0.0), "face {face}: {column:?}");
                assert!((column.iter().sum::<f64>() - 1.0).abs() < UNITY);
            }
        }
    }
}

#[test]
fn basis_functions_are_those_of_their_triangle() {
    let domain = jittered_grid(3, 0.3, 2);
    let basis = Basis::new(&domain);
    for point in points(&domain, 3, 1) {
        let values = basis.values(point.face, point.at);
        for (i, vertex) in domain.mesh().faces()[point.face as usize]
            .into_iter()
            .enumerate()
        {
            for j in 0..3 {
                let function = basis.function(vertex, j);
                let found = super::jet(&function, point)[0];
                assert!((found - values[3 * i + j]).abs() < UNITY);
            }
        }
    }
}

#[test]
fn control_points_and_gradients_say_the_same() {
    let domain = torus(5, 0.2).0;
    let spline = random_spline(&domain, 3, 6);
    let basis = Basis::new(&domain);
    let back = basis
        .spline(3, &basis.control_points(&spline))
        .expect("control points");
    let pairs = spline.vertex_values().iter().zip(back.vertex_values());
    let pairs = pairs.chain(
        spline
            .vertex_gradients()
            .iter()
            .zip(back.vertex_gradients()),
    );
    for (a, b) in pairs {
        assert!((a - b).abs() < UNITY, "{a} {b}");
    }
    assert_eq!(
        spline.control_triangles().expect("a surface").len(),
        domain.mesh().vertex_count()
    );
}

#[test]
fn a_surface_is_in_the_hull_of_its_control_points() {
    // Every point is the combination of nine control points with weights that are a partition of unity.
    let domain = jittered_grid(4, 0.3, 3);
    let spline = random_spline(&domain, 3, 6);
    let basis = Basis::new(&domain);
    let control = basis.control_points(&spline);
    for point in points(&domain, 3, 1) {
        let weights = basis.values(point.face, point.at);
        let vertices = domain.mesh().faces()[point.face as usize];
        let found = spline
            .evaluate_flat(&[point], msplines_common::evaluate::Order::Value)
            .expect("a point");
        for c in 0..3 {
            let place = |k: usize| control[9 * vertices[k / 3] as usize + 3 * (k % 3) + c];
            let sum: f64 = (0..9).map(|k| weights[k] * place(k)).sum();
            assert!((found.values[c] - sum).abs() < UNITY);
        }
        assert!(weights.iter().all(|&w| w >= 0.0));
    }
}

#[test]
fn triangles_are_as_small_as_around_a_regular_vertex() {
    // Around the vertex of a hexagonal grid the Bézier points are a regular hexagon and the
    // middles of its sides; the smallest triangle around it has 3/2 of its area.
    let points: Vec<[f64; 2]> = (0..7)
        .map(|k| match k {
            0 => [0.0, 0.0],
            k => {
                let angle = f64::from(k) * std::f64::consts::FRAC_PI_3;
                [angle.cos(), angle.sin()]
            }
        })
        .collect();
    let faces = (1..7).map(|k| [0, k, k % 6 + 1]).collect();
    let domain = FlatDomain::planar_with_faces(&points, faces).expect("a hexagon");
    let triangle = Basis::new(&domain).triangles()[0];
    let radius = 0.5 / 3.0_f64.sqrt();
    let hexagon = 1.5 * 3.0_f64.sqrt() * radius * radius;
    assert!(
        (triangle.area() / hexagon - 1.5).abs() < 1e-7,
        "{}",
        triangle.area() / hexagon
    );
}

#[test]
fn thin_domains_keep_their_bases_non_negative() {
    let mut random = Random::new(11);
    for squeeze in [1e-3, 1e-6] {
        let points: Vec<[f64; 2]> = (0..60)
            .map(|_| [random.next(), squeeze * random.next()])
            .collect();
        let domain = FlatDomain::planar(&points).expect("a domain");
        let basis = Basis::new(&domain);
        for vertex in 0..60 {
            let triangle = basis.triangles()[vertex as usize];
            for point in bezier_points(&domain, vertex) {
                assert!(triangle.barycentric(point).iter().all(|&b| b >= 0.0));
            }
        }
        for face in 0..domain.mesh().face_count() as u32 {
            let mut ordinates = basis.ordinates(face).into_iter().flatten();
            assert!(ordinates.all(|b| b >= 0.0), "face {face}");
        }
    }
}

#[test]
fn a_vertex_of_a_thousand_edges_has_a_small_triangle() {
    let count = 1000;
    let ray = |k: u32| {
        let angle = f64::from(k) * std::f64::consts::TAU / f64::from(count);
        [angle.cos(), angle.sin()]
    };
    let mut points = vec![[0.0, 0.0]];
    points.extend((0..count).map(ray));
    let faces = (1..=count).map(|k| [0, k, k % count + 1]).collect();
    let domain = FlatDomain::planar_with_faces(&points, faces).expect("a disk");
    let triangle = Basis::new(&domain).triangles()[0];
    // Around the disk of radius one half the smallest has 3 √3 / 4; incentres are near the rim.
    assert!(
        triangle.area() < 1.05 * 0.75 * 3.0_f64.sqrt(),
        "{}",
        triangle.area()
    );
    assert!(
        triangle.area() > 0.7 * 0.75 * 3.0_f64.sqrt(),
        "{}",
        triangle.area()
    );
}

/// Integrates by the rule of degree 2 on every micro triangle, from evaluations alone.
fn by_quadrature(triangle: &MacroTriangle, corners: &[f64; 9]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let gradients = triangle.gradients(corners);
    for micro in 0..6 {
        let weight = triangle.micro_area(micro) / 3.0;
        for k in 0..3 {
            let mut at = [1.0 / 6.0; 3];
            at[k] = 2.0 / 3.0;
            let point = crate::element::MicroPoint { micro, at };
            let g = crate::element::gradient(&gradients, &point);
            sums[0] += weight * (g[0] * g[0] + g[1] * g[1]);
            let [uu, uv, vv] = second_by_ordinates(triangle, corners, micro);
            sums[1] += weight * (uu * uu + 2.0 * uv * uv + vv * vv);
        }
    }
    sums
}

/// Second derivatives from the six Bézier ordinates: another route than the gradients'.
fn second_by_ordinates(triangle: &MacroTriangle, corners: &[f64; 9], micro: usize) -> [f64; 3] {
    let ordinates = triangle.ordinates(corners);
    let b = crate::element::micro_ordinates(micro).map(|at| ordinates[at]);
    let g = triangle.micro_gradients(micro);
    let entry = |x: usize, y: usize| {
        let square: f64 = (0..3).map(|k| b[k] * g[k][x] * g[k][y]).sum();
        let mixed: f64 = [(0, 1), (1, 2), (0, 2)]
            .iter()
            .zip(&b[3..])
            .map(|(&(i, j), b)| b * (g[i][x] * g[j][y] + g[j][x] * g[i][y]))
            .sum();
        2.0 * (square + mixed)
    };
    [entry(0, 0), entry(0, 1), entry(1, 1)]
}

#[test]
fn energies_equal_quadrature() {
    let mut random = Random::new(3);
    for domain in [torus(4, 0.2).0, jittered_grid(5, 0.3, 1)] {
        for face in 0..domain.mesh().face_count() as u32 {
            let triangle = domain.macro_triangle(face);
            let corners: [f64; 9] = std::array::from_fn(|_| 2.0 * random.next() - 1.0);
            let expected = by_quadrature(&triangle, &corners);
            let matrices: [ElementMatrix; 2] = [membrane(&triangle), thin_plate(&triangle)];
            for (matrix, expected) in matrices.iter().zip(expected) {
                let found = energy(matrix, &corners);
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}

#[test]
fn energies_of_known_functions() {
    let domain = jittered_grid(6, 0.3, 1);
    let total = |element: fn(&MacroTriangle) -> ElementMatrix, f: super::Function| -> f64 {
        let spline = interpolant(&domain, f);
        let faces = 0..domain.mesh().face_count() as u32;
        faces
            .map(|f| {
                energy(
                    &element(&domain.macro_triangle(f)),
                    &spline.corner_numbers(f, 0),
                )
            })
            .sum()
    };
    // Over the unit square; u² has (2u)² and uu = 2, uv has u² + v² and uv = 1.
    assert!((total(membrane, |[u, _]| [u, 1.0, 0.0]) - 1.0).abs() < 1e-12);
    assert!((total(membrane, |[u, _]| [u * u, 2.0 * u, 0.0]) - 4.0 / 3.0).abs() < 1e-12);
    assert!((total(membrane, |[u, v]| [u * v, v, u]) - 2.0 / 3.0).abs() < 1e-12);
    assert!((total(thin_plate, |[u, _]| [u * u, 2.0 * u, 0.0]) - 4.0).abs() < 1e-10);
    assert!((total(thin_plate, |[u, v]| [u * v, v, u]) - 2.0).abs() < 1e-10);
    assert!(total(membrane, |_| [1.0, 0.0, 0.0]).abs() < 1e-12);
    assert!(total(thin_plate, |[u, v]| [2.0 * u - v, 2.0, -1.0]).abs() < 1e-10);
}
