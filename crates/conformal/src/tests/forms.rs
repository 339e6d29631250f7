//! Harmonic and holomorphic forms of closed surfaces.

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;
use nalgebra::{DMatrix, DVector, Point3};

use crate::{
    ClassObjective, ConformalError, FormChoice, HolomorphicBasis, HolomorphicForm, Homology,
    Uniformity,
};

/// Sums around faces are rounding of numbers of size one.
const CLOSED: f64 = 1e-14;

#[test]
fn there_are_2g_integer_forms_closed_and_dual_to_loops() {
    for (mesh, genus) in [(zoo::knotted(), 1), (zoo::genus(2), 2), (zoo::genus(5), 5)] {
        let topology = mesh.topology();
        let homology = Homology::build(topology).unwrap();
        assert_eq!(homology.genus(), genus);
        for cocycle in &homology.cocycles {
            let mut sums = vec![0; mesh.face_count()];
            for &(h, value) in cocycle {
                sums[(h / 3) as usize] += value;
                let twin = topology.twin(h);
                let found = cocycle.binary_search_by_key(&twin, |e| e.0).unwrap();
                assert_eq!(cocycle[found].1, -value);
            }
            assert!(sums.iter().all(|&sum| sum == 0));
        }
        for path in &homology.loops {
            let next = path.iter().cycle().skip(1);
            assert!(
                path.iter()
                    .zip(next)
                    .all(|(&a, &b)| topology.target(a) == topology.origin(b))
            );
        }
        let rows = homology.integer_periods();
        let classes = 2 * genus;
        let matrix = DMatrix::from_fn(classes, classes, |i, j| rows[i][j] as f64);
        assert!((matrix.determinant().abs() - 1.0).abs() < 1e-9);
    }
    let sphere = Homology::build(shapes::sphere(200).topology()).unwrap();
    assert!(sphere.cocycles.is_empty() && sphere.loops.is_empty());
}

#[test]
fn forms_are_closed_and_have_the_periods_of_their_classes() {
    let mesh = zoo::genus(3);
    let basis = HolomorphicBasis::build(&mesh, &mut unobserved()).unwrap();
    assert!(basis.co_closedness < 1e-9, "{}", basis.co_closedness);
    let real = DVector::from_fn(6, |k, _| 0.3 + k as f64);
    let form = basis.form([&real, &basis.conjugate(&real)]);
    for face in form.as_chunks::<3>().0 {
        assert!((0..2).all(|part| (face[0][part] + face[1][part] + face[2][part]).abs() < CLOSED));
    }
    for (h, &twin) in basis.triangulation().twins.iter().enumerate() {
        let sum = [0, 1].map(|part| form[h][part] + form[twin as usize][part]);
        assert!(sum.iter().all(|s| s.abs() < CLOSED));
    }
}

#[test]
fn conjugation_turns_by_a_right_angle_better_on_finer_meshes() {
    let defects = [2400, 9600].map(|n| {
        let basis = HolomorphicBasis::build(&shapes::genus(2, n), &mut unobserved()).unwrap();
        let (gram, c) = (basis.gram(), basis.conjugation());
        assert!((c * c + DMatrix::identity(4, 4)).norm() < 1e-13);
        // The inner product is preserved by conjugation as far as the form is holomorphic.
        let turned = c.transpose() * gram * c;
        assert!((turned - gram).norm() < 10.0 * basis.conjugation_defect * gram.norm());
        basis.conjugation_defect
    });
    // Half the length of edges; meshes of the two sizes are not nested.
    let rate = (defects[0] / defects[1]).log2();
    assert!(defects[1] < 5e-3 && rate > 1.5, "{defects:?}, rate {rate}");
}

#[test]
fn given_coefficients_and_periods_are_kept() {
    let mesh = zoo::genus(2);
    let basis = HolomorphicBasis::build(&mesh, &mut unobserved()).unwrap();
    let given = vec![1.0, -0.5, 0.25, 2.0];
    let [found] = &FormChoice::Coefficients(given.clone())
        .candidates(&basis)
        .unwrap()[..]
    else {
        panic!("one form")
    };
    assert_eq!(found.real.as_slice(), given);
    let rows = basis.homology().integer_periods();
    let periods = |part: &DVector<f64>| -> Vec<f64> {
        let row = |row: &Vec<i64>| {
            row.iter()
                .zip(part.iter())
                .map(|(n, a)| *n as f64 * a)
                .sum()
        };
        rows.iter().map(row).collect()
    };
    let [found] = &FormChoice::Periods(given.clone())
        .candidates(&basis)
        .unwrap()[..]
    else {
        panic!("one form")
    };
    assert!(
        periods(&found.real)
            .iter()
            .zip(&given)
            .all(|(a, b)| (a - b).abs() < 1e-12)
    );
    let [found] = &FormChoice::IntegerPeriods(vec![1, 0, -2, 1])
        .candidates(&basis)
        .unwrap()[..]
    else {
        panic!("one form")
    };
    assert_eq!(periods(&found.imaginary), [1.0, 0.0, -2.0, 1.0]);
}

#[test]
fn the_optimal_form_is_more_even_than_others_and_integer_ones_come_near() {
    let basis = HolomorphicBasis::build(&shapes::genus(3, 2400), &mut unobserved()).unwrap();
    let best = FormChoice::default().candidates(&basis).unwrap().remove(0);
    let mut single = vec![0.0; 6];
    single[0] = 1.0;
    let other = FormChoice::Coefficients(single)
        .candidates(&basis)
        .unwrap()
        .remove(0);
    let variances = [best.log_variance, other.log_variance];
    assert!(
        variances[0] < 0.3 && variances[1] > 2.0 * variances[0],
        "{variances:?}"
    );
    let integer = FormChoice::integer(0).candidates(&basis).unwrap().remove(0);
    assert!(integer.imaginary.iter().all(|n| n.fract() == 0.0));
    assert!(integer.log_variance < 1.5 * best.log_variance + 0.02);
}

#[test]
fn no_class_of_small_entries_costs_less_than_the_one_found() {
    let basis = HolomorphicBasis::build(&shapes::genus(2, 1600), &mut unobserved()).unwrap();
    let measure = Uniformity::sample(&basis);
    for energy in [0.0, 0.06, 1.0] {
        let objective = ClassObjective { energy };
        let choice = FormChoice::Integer { seed: 0, objective };
        let found = choice.candidates(&basis).unwrap();
        let cost = |form: &HolomorphicForm| objective.cost(form.log_variance, form.energy);
        assert!(
            found
                .windows(2)
                .all(|pair| cost(&pair[0]) <= cost(&pair[1]) + 1e-3)
        );
        // Zero, one and two of either sign, in all four places.
        for code in 1..625 {
            let digit = |k: u32| f64::from(code / 5_i32.pow(k) % 5 - 2);
            let class = DVector::from_fn(4, |k, _| digit(k as u32));
            let own = class.dot(&(basis.gram() * &class));
            if own == 0.0 {
                continue;
            }
            let variance = measure.variance(&-basis.conjugate(&class));
            // Classes are ranked by another floor of lengths, which shows in the third digit.
            let least = cost(&found[0]) - 5e-3;
            assert!(objective.cost(variance, own) > least, "{class} {energy}");
        }
    }
}

#[test]
fn the_class_of_a_torus_is_its_shortest() {
    let basis = HolomorphicBasis::build(&zoo::knotted(), &mut unobserved()).unwrap();
    let [found, ..] = &FormChoice::integer(0).candidates(&basis).unwrap()[..] else {
        panic!("a form")
    };
    for (a, b) in (-4..=4).flat_map(|a| (-4..=4).map(move |b| (a, b))) {
        let class = DVector::from_vec(vec![f64::from(a), f64::from(b)]);
        let energy = class.dot(&(basis.gram() * &class));
        assert!((a, b) == (0, 0) || energy >= found.energy * (1.0 - 1e-12));
    }
}

#[test]
fn forms_have_the_same_bits_on_any_number_of_threads() {
    let mesh = zoo::genus(2);
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let basis = HolomorphicBasis::build(&mesh, &mut unobserved()).unwrap();
            let form = FormChoice::default().candidates(&basis).unwrap().remove(0);
            let integer = FormChoice::integer(0).candidates(&basis).unwrap().remove(0);
            let forms = [form, integer];
            forms.map(|form| basis.form([&form.real, &form.imaginary]))
        })
    };
    assert_eq!(bits(1), bits(3));
}

#[test]
fn what_has_no_form_is_refused_by_name() {
    let error = HolomorphicBasis::build(&shapes::sphere(200), &mut unobserved()).unwrap_err();
    assert_eq!(error, ConformalError::NoForm);
    assert!(error.to_string().contains("--puncture"));
    let error = HolomorphicBasis::build(&shapes::cylinder(200), &mut unobserved()).unwrap_err();
    assert!(matches!(error, ConformalError::Boundary { loops: 2, .. }));
    let torus = shapes::torus(2.0, 0.7, 400);
    let count = torus.vertex_count() as u32;
    let positions = [torus.positions(), torus.positions()].concat();
    let moved = torus.faces().iter().map(|f| f.map(|v| v + count));
    let faces = torus.faces().iter().copied().chain(moved).collect();
    let double = TriangleMesh::build(positions, faces).unwrap();
    let error = HolomorphicBasis::build(&double, &mut unobserved()).unwrap_err();
    assert_eq!(error, ConformalError::NotConnected { components: 2 });
    let basis = HolomorphicBasis::build(&torus, &mut unobserved()).unwrap();
    let count = FormChoice::Coefficients(vec![1.0])
        .candidates(&basis)
        .unwrap_err();
    assert!(matches!(
        count,
        ConformalError::ClassCount {
            given: 1,
            needed: 2,
            genus: 1
        }
    ));
    let zero = FormChoice::Periods(vec![0.0, 0.0])
        .candidates(&basis)
        .unwrap_err();
    assert_eq!(zero, ConformalError::ZeroForm);
    let mut positions = torus.positions().to_vec();
    positions[7] = Point3::new(f64::NAN, 0.0, 0.0);
    assert!(HolomorphicBasis::build(&torus.with_positions(positions), &mut unobserved()).is_err());
}
