//! Each stencil alone, over all that can become of a lattice tetrahedron.

use msplines_common::mesh::tet::{dihedral_angles, signed_volume};
use proptest::prelude::*;

use super::super::grid::{DIRECTIONS, direction};
use super::super::stencils::{Corner, Pieces, pieces};
use super::super::warp::alpha;
use super::*;

const CORNERS: [[i32; 3]; 4] = [[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]];

/// Bounds of dihedral angles when moves of corners are not asked whether they can happen together;
/// they contain what 4·10^5 samples found, 9.3 and 161.7 degrees.
const WIDE_BOUNDS: [f64; 2] = [9.2, 162.0];

/// A lattice tetrahedron after corners have moved, and its pieces.
struct Stencil {
    points: Vec<Point3<f64>>,
    pieces: Pieces,
}

fn position(at: [i32; 3]) -> Point3<f64> {
    Point3::from(at.map(f64::from))
}

/// `moves` are directions of corners on the boundary and how far each goes, `cuts` where edges are
/// cut, both as fractions of what is allowed; `order` gives the numbers of the points.
fn stencil(values: [i8; 4], moves: [(usize, f64); 4], cuts: [f64; 6], order: [u32; 4]) -> Stencil {
    let mut points: Vec<Point3<f64>> = CORNERS.map(position).to_vec();
    for i in (0..4).filter(|&i| values[i] == 0) {
        let (way, fraction) = moves[i];
        let sign = if way < DIRECTIONS { 1.0 } else { -1.0 };
        let step = STEPS[way % DIRECTIONS].map(f64::from);
        let reach = alpha((way % DIRECTIONS) as u8);
        points[i] += Vector3::from(step) * (sign * fraction * reach);
    }
    let mut numbers = [[0; 4]; 4];
    let edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    for ([i, j], cut) in edges.into_iter().zip(cuts) {
        let (from, to) = if values[i] > 0 { (i, j) } else { (j, i) };
        let alpha = alpha(direction(CORNERS[from], CORNERS[to]).0);
        let t = alpha + cut * (1.0 - 2.0 * alpha);
        numbers[from][to] = points.len() as u32;
        let (a, b) = (position(CORNERS[from]), position(CORNERS[to]));
        points.push(a + (b - a) * t);
    }
    let corners: [Corner; 4] = std::array::from_fn(|i| Corner {
        point: order[i],
        odd: i >= 2,
        value: values[i],
        vertex: i as u32,
    });
    let place = |corner: &Corner| corner.vertex as usize;
    let worst = |pieces: &Pieces| {
        let cells = pieces.cells().iter();
        let angles = cells.flat_map(|cell| dihedral_angles(&cell.map(|v| points[v as usize])));
        angles.fold(0.0, |w: f64, a| {
            w.max((a - std::f64::consts::FRAC_PI_2).abs())
        })
    };
    let pieces = pieces(
        &corners,
        |a, b| numbers[place(a)][place(b)],
        |one, two| worst(one) <= worst(two),
    );
    Stencil { points, pieces }
}

fn corners_of(stencil: &Stencil) -> Vec<[Point3<f64>; 4]> {
    let cells = stencil.pieces.cells().iter();
    cells
        .map(|cell| cell.map(|v| stencil.points[v as usize]))
        .collect()
}

/// Ends and inner points of an interval: angles are extreme at ends, nearly always.
fn fraction() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1.0), 0.0..1.0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn no_stencil_has_a_bad_angle(
        values in prop::array::uniform4(-1i8..2).prop_filter("something inside", |v| v.contains(&1)),
        moves in prop::array::uniform4((0..2 * DIRECTIONS, fraction())),
        cuts in prop::array::uniform6(fraction()),
        order in Just([0u32, 1, 2, 3]).prop_shuffle(),
    ) {
        let stencil = stencil(values, moves, cuts, order);
        prop_assert!(!stencil.pieces.cells().is_empty());
        for corners in corners_of(&stencil) {
            for angle in dihedral_angles(&corners).map(f64::to_degrees) {
                prop_assert!(angle > WIDE_BOUNDS[0] && angle < WIDE_BOUNDS[1], "{angle}");
            }
        }
    }

    #[test]
    fn both_sides_of_a_plane_cut_fill_the_tetrahedron(
        values in prop::array::uniform4(prop::sample::select(vec![-1i8, 1]))
            .prop_filter("cut", |v| v.contains(&1) && v.contains(&-1)),
        order in Just([0u32, 1, 2, 3]).prop_shuffle(),
    ) {
        let volume = |values: [i8; 4]| -> f64 {
            let stencil = stencil(values, [(0, 0.0); 4], [0.5; 6], order);
            corners_of(&stencil).iter().map(|corners| signed_volume(corners).abs()).sum()
        };
        let whole = signed_volume(&CORNERS.map(position)).abs();
        let both = volume(values) + volume(values.map(|value| -value));
        prop_assert!((both - whole).abs() < 1e-12, "{both} {whole}");
    }
}

#[test]
fn directions_name_their_steps() {
    for (number, step) in STEPS.into_iter().enumerate() {
        assert_eq!(
            direction([4, 4, 4], step.map(|x| 4 + x)),
            (number as u8, true)
        );
        assert_eq!(
            direction([4, 4, 4], step.map(|x| 4 - x)),
            (number as u8, false)
        );
    }
}
