//! Functions of single charts against what they were sampled from.

use crate::pursuit::Selection;
use crate::{
    Atom, ChartPoint, Components, DictionaryKind, Local, LocalError, LocalFunction, Star, fit_local,
};

const STAR: Star = Star {
    sectors: 5,
    valence: 5,
};

fn grid(side: u32) -> Vec<ChartPoint> {
    let sectors = 0..STAR.sectors;
    let of_sector = |sector| {
        let cells = move |i: u32| [i % side, i / side].map(|c| f64::from(c) / f64::from(side - 1));
        (0..side * side).map(move |i| ChartPoint {
            sector,
            at: cells(i),
        })
    };
    sectors.flat_map(of_sector).collect()
}

fn sparse(dictionary: DictionaryKind, selection: Selection, sparsity: u32) -> Local {
    Local::Sparse {
        dictionary,
        sparsity,
        selection,
        components: Components::Joint,
    }
}

/// The function that a dictionary holds as a whole is found by every way that has it.
#[test]
fn what_the_atoms_hold_is_found() {
    let points = grid(9);
    let kink = |p: &ChartPoint| {
        if p.sector == 2 {
            p.at[0] * p.at[1]
        } else {
            0.0
        }
    };
    let wavy = |p: &ChartPoint| {
        let [x, y] = STAR.position(p.sector, p.at);
        0.3 * x - y + kink(p)
    };
    let values: Vec<f64> = points.iter().map(wavy).collect();
    for selection in [Selection::Omp, Selection::Ormp, Selection::Plain] {
        let local = sparse(DictionaryKind::Own, selection, 25);
        let found = fit_local(STAR, &points, &values, local).expect("good samples");
        let worst = points.iter().zip(&values);
        let worst = worst.map(|(p, v)| (found.value(*p) - v).abs());
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 1e-6, "{selection:?}: {worst}");
        assert!(found.atoms().iter().any(Atom::is_shape));
    }
    // Polynomials have no kinks.
    let smooth = fit_local(
        STAR,
        &points,
        &values,
        Local::Polynomial { degree: Some(6) },
    );
    let smooth = smooth.expect("good samples");
    let far = ChartPoint {
        sector: 2,
        at: [1.0, 1.0],
    };
    assert!((smooth.value(far) - wavy(&far)).abs() > 1e-2);
}

/// Fewer samples than atoms leave many best solutions; the shortest neither explodes nor misses one.
#[test]
fn least_squares_of_too_few_samples_meet_them_all() {
    let inside = |p: &ChartPoint| p.at.iter().all(|c| (0.1..0.9).contains(c));
    let points: Vec<ChartPoint> = grid(9).into_iter().filter(inside).step_by(3).collect();
    let values: Vec<f64> = points.iter().map(|p| (7.0 * p.at[0]).sin()).collect();
    assert!(points.len() < 120);
    let local = Local::Polynomial { degree: Some(14) };
    let found = fit_local(STAR, &points, &values, local).expect("good samples");
    for (point, value) in points.iter().zip(&values) {
        assert!((found.value(*point) - value).abs() < 1e-6);
    }
    assert!(found.coefficients().iter().all(|c| c.abs() < 1e6));
}

#[test]
fn parts_make_the_same_function_again() {
    let points = grid(7);
    let values: Vec<f64> = points.iter().map(|p| p.at[0] - p.at[1]).collect();
    let local = sparse(DictionaryKind::Rich, Selection::Omp, 10);
    let found = fit_local(STAR, &points, &values, local).expect("good samples");
    let (kind, degree) = found.made_of();
    let parts = (found.support().to_vec(), found.coefficients().to_vec());
    let again = LocalFunction::from_parts(found.star(), kind, degree, parts.0, parts.1);
    assert_eq!(again.as_ref(), Ok(&found));
}

#[test]
fn bad_samples_are_refused_with_their_number() {
    let mut points = grid(3);
    let values = vec![0.0; points.len()];
    let local = Local::Spline;
    let fit = |points: &[ChartPoint], values: &[f64]| fit_local(STAR, points, values, local);
    assert!(matches!(
        fit(&points, &values[1..]),
        Err(LocalError::WrongLength {
            values: 44,
            points: 45
        })
    ));
    points[7].at[1] = 1.5;
    assert_eq!(fit(&points, &values), Err(LocalError::Sample { index: 7 }));
    points[7] = ChartPoint {
        sector: 5,
        at: [0.0; 2],
    };
    assert_eq!(fit(&points, &values), Err(LocalError::Sample { index: 7 }));
    let steep = Local::Polynomial { degree: Some(15) };
    let refused = fit_local(STAR, &grid(3), &values, steep);
    assert_eq!(refused, Err(LocalError::Degree { degree: 15 }));
    let parts = |support, coefficients| {
        LocalFunction::from_parts(STAR, DictionaryKind::Own, 14, support, coefficients)
    };
    for (sectors, valence) in [(0, 0), (0, 5), (6, 5), (121, 121), (1, u32::MAX)] {
        let star = Star { sectors, valence };
        let odd = LocalFunction::from_parts(star, DictionaryKind::Own, 14, vec![], vec![]);
        let text = odd.expect_err("no such star").to_string();
        assert!(text.contains(&format!("{sectors} of {valence}")), "{text}");
    }
    assert_eq!(
        parts(vec![200], vec![1.0]),
        Err(LocalError::NoSuchAtom {
            atom: 200,
            atoms: 131
        })
    );
    assert_eq!(
        parts(vec![2], vec![f64::NAN]),
        Err(LocalError::Coefficients { atoms: 1 })
    );
}
