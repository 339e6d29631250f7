//! Caps as coordinates: sheets, borders, and what does not fit.

use super::*;
use crate::complex::tests::double_torus;
use crate::complex::{Cylinder, Segment};
use crate::samples::{Sequence, large_double_torus, open_cylinder};

#[test]
fn a_walk_around_a_zero_is_a_circle_in_its_cap() {
    let complex = large_double_torus();
    let caps = Caps::build(&complex, &CapOptions::default()).expect("caps");
    assert_eq!(caps.caps().len(), 2);
    assert_eq!(caps.coefficients(), 30);
    for zero in 0..2 {
        let cap = caps.caps()[zero];
        assert_eq!(
            cap.kind,
            CapKind::Zero {
                index: zero as u32,
                order: 1
            }
        );
        // 250 of 1000 units is the lowest cylinder beside both.
        assert!((cap.radius * UNITS / complex.cylinders()[1].height as f64 - 0.45).abs() < 1e-12);
        let own = &complex.cylinders()[0];
        let (x, y) = if zero == 0 {
            (0.0, own.height as f64)
        } else {
            (0.0, 0.0)
        };
        // Twice around, at a third of the radius, by short straight steps.
        let radius = cap.radius * UNITS / 3.0;
        let steps = 4000;
        let place = |k: i32| {
            let angle = 4.0 * std::f64::consts::PI * (f64::from(k) + 0.25) / f64::from(steps);
            [radius * angle.cos(), radius * angle.sin()]
        };
        let sign = if zero == 0 { -1.0 } else { 1.0 };
        // Begin in the half disk within cylinder 0.
        let [dx, dy] = place(0);
        let mut at = Point {
            cylinder: 0,
            x: (x + sign * dx).rem_euclid(own.circumference as f64),
            y: y + sign * dy,
        };
        let first = caps.at(at).expect("in the cap");
        for k in 1..=steps {
            let ([x0, y0], [x1, y1]) = (place(k - 1), place(k));
            at = complex.walk(at, [sign * (x1 - x0), sign * (y1 - y0)]).0;
            let found = caps.at(at).expect("in the cap");
            assert_eq!(found.cap, zero as u32);
            let turn =
                Complex::from_polar(1.0, std::f64::consts::TAU * f64::from(k) / f64::from(steps));
            assert!((found.w - first.w * turn).norm() < 1e-9, "{k}");
            assert!((found.w.norm() - (1.0_f64 / 3.0).sqrt()).abs() < 1e-9);
        }
    }
}

#[test]
fn caps_are_disjoint() {
    let complex = large_double_torus();
    let caps = Caps::build(&complex, &CapOptions::default()).expect("caps");
    let mut numbers = Sequence(3);
    let mut inside = [0; 2];
    for k in 0..30_000 {
        let cylinder = k % 3;
        let (size, patches) = &caps.patches[cylinder];
        let point = Point {
            cylinder: cylinder as u32,
            x: numbers.unit() * size[0],
            y: numbers.unit() * size[1],
        };
        let hits = patches.iter().filter_map(|patch| {
            let cap = &caps.caps[patch.cap as usize];
            at_zero(patch, cap, 1, *size, point)
        });
        let hits: Vec<CapPoint> = hits.collect();
        assert!(hits.len() <= 1);
        assert_eq!(caps.at(point), hits.first().copied());
        if let Some(hit) = hits.first() {
            inside[hit.cap as usize] += 1;
        }
    }
    assert!(inside.iter().all(|&n| n > 1000), "{inside:?}");
}

#[test]
fn derivatives_of_coordinates_and_weights_are_those_of_differences() {
    let tall = open_cylinder(Beyond::Pole { index: 0 });
    for (complex, cylinder) in [(&*large_double_torus(), 1), (&*tall, 0)] {
        let caps = Caps::build(complex, &CapOptions::default()).expect("caps");
        let height = complex.cylinders()[cylinder as usize].height as f64;
        let radius = caps.caps()[0].radius;
        for k in 0..60 {
            let angle = -std::f64::consts::PI * (f64::from(k) + 0.5) / 60.0;
            let length = radius * UNITS * (0.45 + 0.5 * f64::from(k % 7) / 7.0);
            let (border, y) = match caps.caps()[0].kind {
                CapKind::Zero { .. } => (0.0, -length * angle.sin()),
                CapKind::Pole { .. } => (height, height - length),
            };
            let point = |dx: f64, dy: f64| {
                let x = 3.0e12 * f64::from(u8::from(border > 0.0)) + length * angle.cos();
                let size = complex.cylinders()[cylinder as usize].circumference as f64;
                let x = (x + dx * UNITS).rem_euclid(size);
                caps.at(Point {
                    cylinder,
                    x,
                    y: y + dy * UNITS,
                })
                .expect("in the cap")
            };
            let h = 1e-6;
            let here = point(0.0, 0.0);
            let [e, w, n, s] = [point(h, 0.0), point(-h, 0.0), point(0.0, h), point(0.0, -h)];
            let slope = (e.w - w.w) / (2.0 * h);
            let turned = (n.w - s.w) / Complex::new(0.0, 2.0 * h);
            let size = here.dw[0].norm();
            assert!(
                (slope - here.dw[0]).norm() < 1e-6 * size,
                "{slope} {}",
                here.dw[0]
            );
            // Holomorphic: one derivative in all directions.
            assert!((turned - here.dw[0]).norm() < 1e-6 * size);
            let curve = (e.dw[0] - w.dw[0]) / (2.0 * h);
            assert!((curve - here.dw[1]).norm() < 1e-6 * here.dw[1].norm());
            for (of, by_x, by_y) in [(0, 1, 2), (1, 3, 4), (2, 4, 5)] {
                let x = (e.phi.0[of] - w.phi.0[of]) / (2.0 * h);
                let y = (n.phi.0[of] - s.phi.0[of]) / (2.0 * h);
                let scale = [1.0, radius.recip(), radius.recip().powi(2)]
                    [usize::from(of > 0) + usize::from(of > 2)];
                assert!((x - here.phi.0[by_x]).abs() < 1e-4 * scale / radius);
                assert!((y - here.phi.0[by_y]).abs() < 1e-4 * scale / radius);
            }
        }
    }
}

#[test]
fn poles_close_cylinders() {
    let complex = open_cylinder(Beyond::Pole { index: 4 });
    let mut caps = Caps::build(&complex, &CapOptions::default()).expect("caps");
    let (cap, own) = (caps.caps()[0], &complex.cylinders()[0]);
    let kind = CapKind::Pole {
        index: 4,
        cylinder: 0,
        border: Border::Top,
    };
    assert_eq!((cap.kind, cap.coefficients()), (kind, 28));
    let at = |caps: &Caps, x: f64, y: f64| caps.at(Point { cylinder: 0, x, y });
    let level = own.height as f64 - cap.radius * UNITS;
    assert_eq!(at(&caps, 5.0, level), None);
    let rim = at(&caps, 0.0, level + 1e4).expect("inside");
    assert!((rim.w - Complex::new(1.0, 0.0)).norm() < 1e-6 && rim.phi.0[0] < 1e-9);
    // The end of the cylinder, and all beyond, are in the core.
    for y in [own.height as f64, 2.0 * own.height as f64, f64::INFINITY] {
        assert_eq!(at(&caps, 9.0, y).expect("inside").phi.0[0], 1.0);
    }
    assert_eq!(at(&caps, 9.0, f64::INFINITY).expect("inside").w.norm(), 0.0);
    assert_eq!(caps.set_radius(0, 1e9), cap.limit);
}

#[test]
fn zeros_and_poles_that_no_cap_fits_are_named() {
    let row = |start, length, beyond, zero| Segment {
        start,
        length,
        beyond,
        zero,
    };
    let end = vec![row(0, 100, Beyond::Boundary { index: 0 }, None)];
    let cylinder = |bottom: Vec<Segment>| Cylinder {
        circumference: 100,
        height: 50,
        bottom,
        top: end.clone(),
    };
    let mixed = vec![
        row(0, 40, Beyond::Pole { index: 0 }, None),
        row(40, 60, Beyond::Boundary { index: 1 }, None),
    ];
    let on_boundary = vec![row(0, 100, Beyond::Boundary { index: 1 }, Some(0))];
    let build = |bottom| {
        let complex = CylinderComplex::build(vec![cylinder(bottom)]).expect("tiled");
        Caps::build(&complex, &CapOptions::default()).expect_err("no cap")
    };
    let pole = CapsError::Pole {
        cylinder: 0,
        border: Border::Bottom,
    };
    assert_eq!(build(mixed), pole);
    assert_eq!(
        pole.to_string(),
        "the Bottom of cylinder 0 is a pole only in part; a pole takes a whole border without zeros"
    );
    assert_eq!(build(on_boundary), CapsError::Zero { zero: 0 });
    // Two zeros under one name.
    let mut merged = double_torus().cylinders().to_vec();
    for own in &mut merged {
        for s in own.bottom.iter_mut().chain(&mut own.top) {
            s.zero = Some(0);
        }
    }
    let merged = CylinderComplex::build(merged).expect("tiled");
    let error = Caps::build(&merged, &CapOptions::default()).expect_err("two disks");
    assert_eq!(error, CapsError::Zero { zero: 0 });
}
