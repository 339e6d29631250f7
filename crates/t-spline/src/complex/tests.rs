//! Gluing, crossing and walking on small complexes.

use super::*;

/// Two handles: cylinder 0 with a figure eight on either border, 1 and 2 on its two loops, glued back on
/// top of each other: zero 0 on the top of 0, zero 1 on its bottom.
pub(crate) fn double_torus() -> CylinderComplex {
    let row = |start, length, cylinder, there, zero| Segment {
        start,
        length,
        beyond: Beyond::Cylinder {
            cylinder,
            start: there,
        },
        zero,
    };
    CylinderComplex::build(vec![
        Cylinder {
            circumference: 1000,
            height: 300,
            top: vec![row(0, 400, 1, 0, Some(0)), row(400, 600, 2, 0, Some(0))],
            bottom: vec![row(0, 400, 1, 0, Some(1)), row(400, 600, 2, 0, Some(1))],
        },
        Cylinder {
            circumference: 400,
            height: 250,
            bottom: vec![row(0, 400, 0, 0, Some(0))],
            top: vec![row(0, 400, 0, 0, Some(1))],
        },
        Cylinder {
            circumference: 600,
            height: 350,
            bottom: vec![row(0, 600, 0, 400, Some(0))],
            top: vec![row(0, 600, 0, 400, Some(1))],
        },
    ])
    .expect("a surface")
}

#[test]
fn walks_come_back_over_borders() {
    for complex in [
        double_torus(),
        CylinderComplex::torus(700, 311, 130).expect("a torus"),
    ] {
        for k in 0..200 {
            let x = f64::from(k) * 3.3;
            let from = Point {
                cylinder: 0,
                x: x % 700.0,
                y: f64::from(k) % 300.0,
            };
            // Steep ways pass no zero between there and back.
            let step = [0.1, f64::from(7 * k) + 0.5];
            let (there, stop) = complex.walk(from, step);
            assert_eq!(stop, None);
            let (back, _) = complex.walk(there, step.map(|d| -d));
            assert_eq!(back.cylinder, from.cylinder, "{from:?}");
            assert!((back.x - from.x).abs() < 1e-9 && (back.y - from.y).abs() < 1e-9);
        }
    }
}

#[test]
fn a_turn_around_a_simple_zero_is_two_turns() {
    let complex = double_torus();
    // Around the zero at (0, 300) of cylinder 0: right, up, left, down comes out on the other sheet.
    let start = Point {
        cylinder: 0,
        x: 10.0,
        y: 290.0,
    };
    let turn = |from: Point| {
        [[0.0, 20.0], [-20.0, 0.0], [0.0, -20.0], [20.0, 0.0]]
            .into_iter()
            .fold(from, |at, step| complex.walk(at, step).0)
    };
    let once = turn(start);
    assert!((once.x - start.x).abs() > 100.0, "{once:?}");
    assert_eq!(turn(once), start);
}

#[test]
fn broken_tables_are_named() {
    let good = double_torus();
    let broken = |change: fn(&mut Vec<Cylinder>)| {
        let mut cylinders = good.cylinders().to_vec();
        change(&mut cylinders);
        CylinderComplex::build(cylinders).expect_err("broken")
    };
    assert_eq!(
        broken(|c| c[1].height = 0),
        ComplexError::Size { cylinder: 1 }
    );
    assert_eq!(
        broken(|c| c[0].top[0].length = 399),
        ComplexError::Tiling {
            cylinder: 0,
            border: Border::Top,
            segment: 1
        }
    );
    assert_eq!(
        broken(|c| c[0].bottom[1].length = 599),
        ComplexError::Tiling {
            cylinder: 0,
            border: Border::Bottom,
            segment: 2
        }
    );
    assert!(matches!(
        broken(|c| c[2].bottom[0].beyond = Beyond::Cylinder {
            cylinder: 0,
            start: 401
        }),
        ComplexError::Gluing { .. }
    ));
    assert!(matches!(
        broken(|c| c[2].bottom[0].zero = None),
        ComplexError::Gluing { .. }
    ));
}

#[test]
fn borders_belong_to_the_cylinder_above() {
    let complex = double_torus();
    assert_eq!(
        complex.node(0, 450, 300),
        Node {
            cylinder: 2,
            x: 50,
            y: 0
        }
    );
    assert_eq!(
        complex.node(2, 650, 350),
        Node {
            cylinder: 0,
            x: 450,
            y: 0
        }
    );
    assert_eq!(
        complex.across(0, Border::Bottom, 450),
        Ok(Node {
            cylinder: 2,
            x: 50,
            y: 350
        })
    );
    assert_eq!(
        (complex.zeros(), complex.area()),
        (2, 300_000 + 100_000 + 210_000)
    );
    let torus = CylinderComplex::torus(700, 311, 130).expect("a torus");
    assert_eq!(
        torus.node(0, 600, 311),
        Node {
            cylinder: 0,
            x: 30,
            y: 0
        }
    );
}
