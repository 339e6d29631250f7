//! Fits of surfaces that are moved, turned, scaled or listed in another order.
//!
//! What may be asked for differs by method: docs/trust.md has the table and the reasons.

use msplines_common::{Point3, Vector3};

use crate::shape::Shape;
use crate::workbench::Workbench;

/// A map of space, and its inverse.
struct Placement {
    name: &'static str,
    map: fn(&Point3<f64>) -> Point3<f64>,
    back: fn(&Point3<f64>) -> Point3<f64>,
}

/// Cosine and sine of the turn: exact in a right triangle, but not in binary.
const TURN: (f64, f64) = (0.6, 0.8);

const PLACEMENTS: [Placement; 4] = [
    Placement {
        name: "scaled by 8",
        map: |p| p * 8.0,
        back: |p| p / 8.0,
    },
    Placement {
        name: "scaled by 1e-6",
        map: |p| p * 1e-6,
        back: |p| p * 1e6,
    },
    Placement {
        name: "moved",
        map: |p| p + Vector3::new(10.0, -20.0, 30.0),
        back: |p| p - Vector3::new(10.0, -20.0, 30.0),
    },
    Placement {
        name: "turned",
        map: |p| about_x(&about_z(p, TURN), TURN),
        back: |p| about_z(&about_x(p, (TURN.0, -TURN.1)), (TURN.0, -TURN.1)),
    },
];

fn about_z(p: &Point3<f64>, (c, s): (f64, f64)) -> Point3<f64> {
    Point3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z)
}

fn about_x(p: &Point3<f64>, (c, s): (f64, f64)) -> Point3<f64> {
    Point3::new(p.x, c * p.y - s * p.z, s * p.y + c * p.z)
}

/// Input coordinates of 40 diagonals are rounded to some 40 units of the last place, which the
/// condition of the systems of these small meshes, up to 1e4, makes larger.
const ROUNDING: f64 = 1e-10;

/// A fit and what it keeps, as fractions of the diagonal; none where it promises nothing.
struct Law {
    arguments: &'static str,
    shape: fn() -> Shape,
    /// For each placement.
    placed: [Option<f64>; 4],
    /// Vertices in another order; then faces, with other first corners.
    listed: [Option<f64>; 2],
}

const EXACT: Option<f64> = Some(0.0);
const ROUNDED: Option<f64> = Some(ROUNDING);

/// Knots are exchanged while that lowers the error: turned coordinates are rounded in other places,
/// and the seeded sample starts from the numbers of vertices. Control vertices of least-squares
/// meshes are chosen by the largest error of a coordinate.
const LAWS: [Law; 5] = [
    Law {
        arguments: "fit biharmonic in.obj --knots 40",
        shape: Shape::ball,
        placed: [EXACT, ROUNDED, ROUNDED, None],
        listed: [None, ROUNDED],
    },
    Law {
        arguments: "fit ls-mesh in.obj --controls 40",
        shape: Shape::ball,
        placed: [EXACT, ROUNDED, ROUNDED, None],
        listed: [ROUNDED, ROUNDED],
    },
    Law {
        arguments: "fit powell-sabin in.obj",
        shape: Shape::ball,
        placed: [EXACT, ROUNDED, ROUNDED, ROUNDED],
        listed: [ROUNDED, ROUNDED],
    },
    Law {
        arguments: "fit sparse-manifold in.obj",
        shape: Shape::quads,
        placed: [EXACT, ROUNDED, ROUNDED, None],
        listed: [None, None],
    },
    Law {
        arguments: "fit t-spline in.obj --control-points 120",
        shape: Shape::ring,
        placed: [EXACT, ROUNDED, ROUNDED, ROUNDED],
        listed: [None, None],
    },
];

fn fitted(workbench: &Workbench, law: &Law, shape: &Shape) -> Vec<Point3<f64>> {
    workbench.write("in.obj", &shape.obj());
    workbench.expect(0, &format!("{} -o o.ply --threads 1", law.arguments));
    workbench.soup("o.ply").positions
}

fn check(law: &Law, name: &str, (found, expected): (&[Point3<f64>], &[Point3<f64>]), bound: f64) {
    assert_eq!(found.len(), expected.len(), "{}, {name}", law.arguments);
    let pairs = found.iter().zip(expected);
    let apart = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart <= bound, "{}, {name}: {apart:e}", law.arguments);
}

#[test]
fn a_placed_surface_has_the_placed_spline() {
    for law in &LAWS {
        let workbench = Workbench::new();
        let shape = (law.shape)();
        let expected = fitted(&workbench, law, &shape);
        for (placement, bound) in PLACEMENTS.iter().zip(law.placed) {
            let Some(bound) = bound else { continue };
            let found = fitted(&workbench, law, &shape.mapped(placement.map));
            let found: Vec<_> = found.iter().map(placement.back).collect();
            let bound = bound * shape.diagonal();
            check(law, placement.name, (&found, &expected), bound);
        }
    }
}

#[test]
fn the_order_of_vertices_and_faces_does_not_matter_where_nothing_is_chosen_by_it() {
    for law in &LAWS {
        let workbench = Workbench::new();
        let shape = (law.shape)();
        let expected = fitted(&workbench, law, &shape);
        let [renumbered, reordered] = law.listed;
        if let Some(bound) = renumbered {
            let (other, places) = shape.renumbered();
            let found = fitted(&workbench, law, &other);
            let found: Vec<_> = places.iter().map(|&place| found[place as usize]).collect();
            let bound = bound * shape.diagonal();
            check(law, "renumbered", (&found, &expected), bound);
        }
        if let Some(bound) = reordered {
            let found = fitted(&workbench, law, &shape.reordered());
            let bound = bound * shape.diagonal();
            check(law, "reordered", (&found, &expected), bound);
        }
    }
}
