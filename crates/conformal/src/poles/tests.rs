use std::collections::BTreeSet;
use std::f64::consts::TAU;

use msplines_common::mesh::{NONE, shapes};
use msplines_common::progress::unobserved;

use super::*;

/// Integrals over loops of some dozen edges, of forms that are solved for by refinement.
const ROUNDING: f64 = 1e-9;

fn poled(mesh: &TriangleMesh, poles: &[u32]) -> PoledAtlas {
    Atlas::with_poles(mesh, poles, &PoleChoice::default(), &mut unobserved()).expect("an atlas")
}

/// What every atlas with poles obeys.
fn check_laws(found: &PoledAtlas, genus: i64, holes: i64) {
    let atlas = &found.atlas;
    let zeros: i64 = atlas.zeros().iter().map(|zero| i64::from(zero.order)).sum();
    assert_eq!((zeros, atlas.folded_faces()), (2 * genus - 2 + holes, 0));
    assert!(atlas.closedness() < 1e-12, "{}", atlas.closedness());
    let topology = atlas.mesh().topology();
    for (half_edges, flux) in found.loops.iter().zip(&found.fluxes) {
        let [around, along] = [0, 1].map(|part| {
            let values = half_edges.iter().map(|&h| atlas.form()[h as usize][part]);
            values.sum::<f64>() / atlas.scale_factor()
        });
        assert!(
            (around - flux).abs() < ROUNDING,
            "{around} instead of {flux}"
        );
        assert!(along.abs() < ROUNDING);
        let levels = half_edges.iter().map(|&h| topology.origin(h) as usize);
        let levels: Vec<f64> = levels.map(|v| found.circle.function[v]).collect();
        let off = levels.iter().map(|l| l - levels[0]);
        assert!(
            off.into_iter()
                .all(|off| (off - off.round()).abs() < ROUNDING)
        );
    }
    let largest = found
        .fluxes
        .iter()
        .fold(0.0_f64, |most, f| most.max(f.abs()));
    assert!(found.fluxes.iter().all(|flux| flux.abs() >= 0.25 * largest));
    for (h, form) in (0u32..).zip(atlas.form()) {
        let along = found.circle.along(topology, h);
        assert!((form[1] / atlas.scale_factor() - along).abs() < ROUNDING);
        let twin = topology.twin(h);
        if twin != NONE {
            assert_eq!(
                found.circle.jumps[h as usize],
                -found.circle.jumps[twin as usize]
            );
        }
    }
    let open = found.circle.jumps.as_chunks::<3>().0;
    assert!(open.iter().all(|[a, b, c]| a + b + c == 0));
}

/// Vertices of a sphere around the corners of a polyhedron.
fn spread(mesh: &TriangleMesh, count: usize) -> Vec<u32> {
    let mut chosen: Vec<u32> = vec![0];
    while chosen.len() < count {
        let at = |v: u32| mesh.positions()[v as usize];
        let near = |v: u32| {
            chosen
                .iter()
                .map(|&c| (at(c) - at(v)).norm())
                .fold(f64::MAX, f64::min)
        };
        let vertices = 0..mesh.vertex_count() as u32;
        let farthest = vertices.max_by(|&a, &b| near(a).total_cmp(&near(b)));
        chosen.extend(farthest);
    }
    chosen
}

#[test]
fn a_sphere_between_two_poles_is_a_cylinder() {
    let mesh = shapes::sphere(2000);
    let found = poled(&mesh, &spread(&mesh, 2));
    check_laws(&found, 0, 2);
    // v = flux / 2π · log of the modulus of the stereographic coordinate, which is tan(θ/2).
    let angle = |v: usize| {
        let origin = found.origins[v].expect("no vertex was added") as usize;
        let [p, pole] =
            [mesh.positions()[origin], mesh.positions()[0]].map(|p| p.coords.normalize());
        (p.dot(&pole).acos() / 2.0).tan().ln()
    };
    let turns = found.fluxes[0].abs() / TAU;
    let function = &found.circle.function;
    let [low, high] = [f64::MAX, f64::MIN];
    let (low, high) = (0..function.len()).fold((low, high), |(low, high), v| {
        let sign = found.fluxes[0].signum();
        let off = function[v] - sign * turns * angle(v);
        (low.min(off), high.max(off))
    });
    // Of a function that varies by ten units the loops around both poles, of six vertices, differ most.
    assert!((high - low) / turns < 0.3, "{}", (high - low) / turns);
}

#[test]
fn spheres_with_up_to_five_poles_have_all_zeros_and_their_fluxes() {
    let mesh = shapes::bumpy_sphere(2562);
    for count in 2..=5 {
        check_laws(&poled(&mesh, &spread(&mesh, count)), 0, count as i64);
    }
}

#[test]
fn handles_and_poles_and_boundaries_go_together() {
    let torus = shapes::genus(1, 1500);
    check_laws(&poled(&torus, &spread(&torus, 2)), 1, 2);
    let double = shapes::genus(2, 2500);
    check_laws(&poled(&double, &spread(&double, 3)), 2, 3);
    let tube = shapes::cylinder(600);
    let inside = (0..tube.vertex_count() as u32)
        .min_by(|&a, &b| {
            let height = |v: u32| (tube.positions()[v as usize].z - middle(&tube)).abs();
            height(a).total_cmp(&height(b))
        })
        .expect("a vertex");
    check_laws(&poled(&tube, &[inside]), 0, 3);
}

fn middle(mesh: &TriangleMesh) -> f64 {
    let [low, high] = mesh.bounding_box();
    0.5 * (low.z + high.z)
}

#[test]
fn a_class_and_fluxes_that_are_given_are_kept() {
    let mesh = shapes::genus(1, 1500);
    let poles = spread(&mesh, 3);
    let choice = PoleChoice::Given {
        class: vec![1, 2],
        fluxes: vec![4.0, -2.0, -2.0],
    };
    let found = Atlas::with_poles(&mesh, &poles, &choice, &mut unobserved()).expect("an atlas");
    check_laws(&found, 1, 3);
    assert_eq!(
        (found.class, found.fluxes),
        (vec![1, 2], vec![4.0, -2.0, -2.0])
    );
}

/// `∫ |ω|²` of a form with a period of 1.
fn energy(found: &PoledAtlas) -> f64 {
    let sides = found.atlas.form().as_chunks::<3>().0.iter();
    let areas = sides.map(|[a, b, _]| 0.5 * (a[0] * b[1] - a[1] * b[0]).abs());
    areas.sum::<f64>() / found.atlas.scale_factor().powi(2)
}

#[test]
fn forms_with_poles_do_not_wind() {
    let objective = ClassObjective::default();
    let cost = |found: &PoledAtlas| objective.cost(found.log_variance, energy(found));
    let mesh = shapes::genus(2, 1600);
    let poles = spread(&mesh, 2);
    let best = poled(&mesh, &poles);
    check_laws(&best, 2, 2);
    if best.class.iter().all(|&n| n == 0) {
        return;
    }
    for entry in 0..4 {
        for step in [-1, 1] {
            let mut class = best.class.clone();
            class[entry] += step;
            let fluxes = best.fluxes.clone();
            let choice = PoleChoice::Given { class, fluxes };
            // Some of them fold.
            if let Ok(other) = Atlas::with_poles(&mesh, &poles, &choice, &mut unobserved()) {
                assert!(cost(&other) > cost(&best) - 5e-3, "{:?}", other.class);
            }
        }
    }
    let free = PoleChoice::Optimal {
        seed: 0,
        objective: ClassObjective { energy: 0.0 },
    };
    let winding = Atlas::with_poles(&mesh, &poles, &free, &mut unobserved()).expect("an atlas");
    assert!(energy(&best) <= energy(&winding) * (1.0 + 1e-6));
}

#[test]
fn a_finger_that_ends_in_a_pole_is_even() {
    let mesh = crate::tests::with_finger(40);
    let without = Atlas::closed(&mesh, &crate::FormChoice::default(), &mut unobserved());
    let spread_without = without.expect("an atlas").form.log_variance;
    // Vertex 100 is the tip of the finger.
    let found = poled(&mesh, &[100, 400]);
    check_laws(&found, 1, 2);
    assert!(
        found.log_variance < 0.2 * spread_without,
        "{}",
        found.log_variance
    );
}

#[test]
fn forms_have_the_same_bits_on_any_number_of_threads() {
    let mesh = shapes::genus(1, 900);
    let poles = spread(&mesh, 2);
    let bits = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let found = pool.expect("threads").install(|| poled(&mesh, &poles));
        let form = found.atlas.form().as_flattened().iter();
        form.map(|x| x.to_bits()).collect::<Vec<u64>>()
    });
    assert_eq!(bits[0], bits[1]);
}

#[test]
fn what_means_nothing_is_refused() {
    let mesh = shapes::genus(1, 900);
    let poles = spread(&mesh, 2);
    let refused = |poles: &[u32], class: Vec<i64>, fluxes: Vec<f64>| {
        let choice = PoleChoice::Given { class, fluxes };
        let result = Atlas::with_poles(&mesh, poles, &choice, &mut unobserved());
        result.expect_err("refused").to_string()
    };
    let texts = [
        refused(&poles[..1], vec![1, 0], vec![1.0]),
        refused(&poles, vec![1], vec![1.0, -1.0]),
        refused(&poles, vec![1, 0], vec![1.0]),
        refused(&poles, vec![1, 0], vec![1.0, -0.5]),
        refused(&[poles[0], poles[0]], vec![1, 0], vec![1.0, -1.0]),
    ];
    let parts = [
        "has 1 holes",
        "give 2",
        "give one for each",
        "sum to 0.5",
        "share vertex",
    ];
    for (text, part) in texts.iter().zip(parts) {
        assert!(text.contains(part), "{text}");
    }
    assert_eq!(texts.iter().collect::<BTreeSet<_>>().len(), texts.len());
    let three = spread(&mesh, 3);
    let text = refused(&three, vec![1, 0], vec![1.0, -0.9, -0.1]);
    assert!(text.contains("hole 2 has flux -0.1"), "{text}");
}
