use std::f64::consts::TAU;

use msplines_common::mesh::{NONE, double_cover, shapes, zoo};
use msplines_common::operators::intrinsic::intrinsic_delaunay;
use msplines_common::progress::unobserved;
use nalgebra::Point3;

use super::*;
use crate::untangle::Stars;

/// Rounding of the solves on some hundred vertices.
const ROUNDING: f64 = 1e-10;

/// Returns a plane annulus between radius 1 and `outer`.
fn annulus(outer: f64, rings: u32) -> TriangleMesh {
    let around = 6 * rings;
    let place = |i: u32| {
        let radius = 1.0 + (outer - 1.0) * f64::from(i / around) / f64::from(rings);
        let angle = TAU * f64::from(i % around) / f64::from(around);
        Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    };
    let positions = (0..around * (rings + 1)).map(place).collect();
    let id = |ring: u32, i: u32| around * ring + i % around;
    let cells = (0..rings).flat_map(|ring| (0..around).map(move |i| (ring, i)));
    let faces = cells.flat_map(|(ring, i)| {
        let [a, b] = [id(ring, i), id(ring, i + 1)];
        let [c, d] = [id(ring + 1, i + 1), id(ring + 1, i)];
        [[a, d, c], [a, c, b]]
    });
    TriangleMesh::build(positions, faces.collect()).expect("an annulus")
}

/// Returns the level of each loop: `inside` for the one that holds vertex 0.
fn levels_from(mesh: &TriangleMesh, inside: f64, others: f64) -> Vec<f64> {
    let topology = mesh.topology();
    let loops = topology.boundary_loops();
    let level = |half_edges: &Vec<u32>| {
        let first = half_edges.iter().any(|&h| topology.origin(h) == 0);
        if first { inside } else { others }
    };
    loops.iter().map(level).collect()
}

/// Returns the index of each inner vertex of the real part of a form: -1 at a saddle.
fn indices(form: &BoundedForm, vertex_count: usize) -> Vec<i64> {
    let stars = Stars::of(&form.triangulation, vertex_count);
    (0..vertex_count as u32)
        .map(|v| {
            let Some(fan) = stars.fan(v) else { return 0 };
            let up = |h: u32| form.form[h as usize][0] > 0.0;
            let next = |i: usize| fan[(i + 1) % fan.len()];
            let changes = (0..fan.len())
                .filter(|&i| up(fan[i]) != up(next(i)))
                .count();
            1 - changes as i64 / 2
        })
        .collect()
}

#[test]
fn an_annulus_has_the_logarithm() {
    const OUTER: f64 = 2.5;
    let errors = [6, 12, 24].map(|rings| {
        let mesh = annulus(OUTER, rings);
        let levels = levels_from(&mesh, 0.0, 1.0);
        let result =
            bounded_form(&mesh, &levels, FlipRule::Any, &mut unobserved()).expect("a form");
        assert_eq!(result.distortion.flips, 0);
        // u + i v = log z / log OUTER: around the outer loop v grows by 2π / log OUTER.
        let period = result.periods[0];
        let flux = TAU / OUTER.ln() * if levels[1] == 1.0 { 1.0 } else { -1.0 };
        let form = result.on_mesh(&mesh);
        let mut worst = (period / flux - 1.0).abs();
        for (h, value) in (0u32..).zip(&form) {
            let ends = [mesh.topology().origin(h), mesh.topology().target(h)];
            let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
            let angle = (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y);
            let exact = [(b.coords.norm() / a.coords.norm()).ln(), angle];
            // Edges have length O(h), so that second order per length is third order here.
            let length = (b - a).norm();
            for i in 0..2 {
                worst = worst.max((value[i] - exact[i] / OUTER.ln()).abs() / length);
            }
        }
        (worst, result.distortion.angle_mean - 1.0)
    });
    for pair in errors.windows(2) {
        assert!(pair[0].0 / pair[1].0 > 1.8, "{errors:?}");
    }
    assert!(errors[2].1 < 0.05, "{errors:?}");
}

#[test]
fn periods_converge_to_second_order() {
    let errors = [6, 12, 24].map(|rings| {
        let mesh = annulus(2.5, rings);
        let levels = levels_from(&mesh, 0.0, 1.0);
        let result =
            bounded_form(&mesh, &levels, FlipRule::Any, &mut unobserved()).expect("a form");
        (result.periods[0].abs() * 2.5_f64.ln() / TAU - 1.0).abs()
    });
    assert!(
        errors[0] / errors[1] > 3.5 && errors[1] / errors[2] > 3.5,
        "{errors:?}"
    );
}

#[test]
fn a_cylinder_is_unrolled() {
    let mesh = shapes::cylinder(300);
    let levels = levels_from(&mesh, 0.0, 1.0);
    let result =
        bounded_form(&mesh, &levels, FlipRule::Simplicial, &mut unobserved()).expect("a form");
    let form = result.on_mesh(&mesh);
    // The faceted cylinder is a flat ring: height over 2 is harmonic, exactly.
    let sides = (mesh.topology().boundary_loops()[0].len()) as f64;
    let circumference = 2.0 * sides * (TAU / 2.0 / sides).sin();
    for (h, &[du, dv]) in (0u32..).zip(&form) {
        let ends = [mesh.topology().origin(h), mesh.topology().target(h)];
        let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
        assert!((du - 0.5 * (b.z - a.z)).abs() < ROUNDING);
        let turns = (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y) / TAU;
        // u runs upwards and v to its left: against the sense of rotation.
        assert!(
            (dv + 0.5 * circumference * turns).abs() < ROUNDING,
            "{dv} {turns}"
        );
    }
    assert!(result.distortion.angle_p99 < 1.0 + ROUNDING);
    assert!(result.distortion.scale_spread < 1.0 + ROUNDING);
}

#[test]
fn forms_are_closed_and_have_their_periods() {
    let (mesh, _) = puncture(&shapes::bumpy_sphere(2562), &[5, 900, 1800, 2400]).expect("holes");
    let levels = [0.0, 1.0, 1.0, 1.0];
    let result = bounded_form(&mesh, &levels, FlipRule::Any, &mut unobserved()).expect("a form");
    let on_mesh = result.on_mesh(&mesh);
    for form in [&result.form, &on_mesh] {
        for sides in form.as_chunks::<3>().0 {
            let around = |i: usize| sides.iter().map(|value| value[i]).sum::<f64>();
            assert!(around(0).abs() < 1e-13 && around(1).abs() < 1e-13);
        }
    }
    let loops = mesh.topology().boundary_loops();
    let around = |k: usize| -> f64 { loops[k].iter().map(|&h| on_mesh[h as usize][1]).sum() };
    for k in 1..4 {
        assert!((around(k) - result.periods[k - 1]).abs() < ROUNDING);
    }
    assert!((around(0) + result.periods.iter().sum::<f64>()).abs() < ROUNDING);
    let other = intrinsic_delaunay(&mesh).expect("a triangulation");
    assert_eq!(result.on_triangulation(&other), result.form);
}

#[test]
fn zeros_are_two_fewer_than_loops() {
    let sphere = shapes::bumpy_sphere(2562);
    for (holes, zeros) in [
        (vec![5, 900], 0),
        (vec![5, 900, 1800], 1),
        (vec![5, 900, 1800, 2400, 1300], 3),
    ] {
        let (mesh, _) = puncture(&sphere, &holes).expect("holes");
        let mut levels = vec![1.0; holes.len()];
        levels[0] = 0.0;
        let result =
            bounded_form(&mesh, &levels, FlipRule::Any, &mut unobserved()).expect("a form");
        let indices = indices(&result, mesh.vertex_count());
        assert_eq!(indices.iter().filter(|&&i| i == -1).count(), zeros);
        assert_eq!(indices.iter().filter(|&&i| i != 0).count(), zeros);
    }
}

#[test]
fn the_double_cover_agrees() {
    // Delaunay as it is, so that the triangulations of the surface and of its cover are equal.
    let mesh = annulus(2.0, 5);
    let levels = levels_from(&mesh, 0.0, 1.0);
    let result = bounded_form(&mesh, &levels, FlipRule::Any, &mut unobserved()).expect("a form");
    let (cover, copies) = double_cover(&mesh).expect("a cover");
    let on_cover = intrinsic_delaunay(&cover).expect("a triangulation");
    assert_eq!(result.triangulation.flips.len() + on_cover.flips.len(), 0);
    // The mirror turns du round and keeps dv; it takes half-edge (a, b) to (b, a)'s reverse.
    let faces = mesh.face_count() as u32;
    let mirrored = |h: u32| match h {
        h if h < 3 * faces => (h, [1.0, 1.0]),
        h => {
            let original = h - 3 * faces;
            let (face, corner) = (original / 3, original % 3);
            // The face (a, b, c) was turned to (a, c, b): sides 0, 1, 2 are c→a, b→c, a→b backwards.
            (3 * face + 2 - corner, [1.0, -1.0])
        }
    };
    let weights = cotangent_weights(&on_cover);
    let mut divergence = vec![[0.0; 2]; cover.vertex_count()];
    for h in 0..6 * faces {
        let (own, signs) = mirrored(h);
        let topology = cover.topology();
        let twin = topology.twin(h);
        assert_ne!(twin, NONE);
        let (over, other_signs) = mirrored(twin);
        for i in 0..2 {
            let value = signs[i] * result.form[own as usize][i];
            // The two sides of the seam have the same value of dv, and du is zero along it.
            let opposite = other_signs[i] * result.form[over as usize][i];
            assert!((value + opposite).abs() < ROUNDING, "half-edge {h}");
            divergence[topology.origin(h) as usize][i] += weights[h as usize] * value;
        }
    }
    assert_eq!(copies.len(), mesh.vertex_count());
    for (v, sums) in divergence.iter().enumerate() {
        assert!(
            sums[0].abs() < ROUNDING && sums[1].abs() < ROUNDING,
            "vertex {v}: {sums:?}"
        );
    }
}

#[test]
fn threads_do_not_matter() {
    let mesh = zoo::with_two_boundaries();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let run = || {
            bounded_form(&mesh, &[0.0, 1.0], FlipRule::Any, &mut unobserved())
                .expect("a form")
                .form
        };
        pool.expect("a pool").install(run)
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn punctures_leave_a_loop_each() {
    let sphere = zoo::closed();
    let (rest, origins) = puncture(&sphere, &[3, 333]).expect("holes");
    assert_eq!(rest.topology().boundary_loops().len(), 2);
    assert_eq!(rest.vertex_count(), sphere.vertex_count() - 2);
    for (v, &origin) in origins.iter().enumerate() {
        assert_eq!(rest.positions()[v], sphere.positions()[origin as usize]);
    }
}

#[test]
fn what_cannot_be_cut_or_solved_is_refused() {
    let sphere = zoo::closed();
    let beside: Vec<u32> = sphere.topology().neighbours(7).collect();
    let cut = |mesh: &TriangleMesh, vertices: &[u32]| {
        puncture(mesh, vertices).expect_err("refused").to_string()
    };
    assert!(cut(&sphere, &[7, beside[0]]).contains("stars of vertices 7"));
    assert!(cut(&sphere, &[7, 7]).contains("share vertex 7"));
    assert!(cut(&sphere, &[900]).contains("vertex 900 does not exist"));
    let open = zoo::with_boundary();
    assert!(cut(&open, &[0]).contains("touches the boundary at vertex 0"));
    let solve = |mesh: &TriangleMesh, levels: &[f64]| {
        let refused = bounded_form(mesh, levels, FlipRule::Any, &mut unobserved());
        refused.expect_err("refused").to_string()
    };
    assert!(solve(&open, &[0.0]).contains("1 boundary loops"));
    let tube = zoo::with_two_boundaries();
    assert!(solve(&tube, &[0.0]).contains("1 levels are given for 2"));
    assert!(solve(&tube, &[0.0, f64::NAN]).contains("loop 1 is NaN"));
    assert!(solve(&tube, &[2.0, 2.0]).contains("level 2"));
    let torus = zoo::genus(1);
    let far = torus.vertex_count() as u32 - 1;
    let (torus, _) = puncture(&torus, &[0, far]).expect("holes");
    assert!(solve(&torus, &[0.0, 1.0]).contains("genus 1"));
}
