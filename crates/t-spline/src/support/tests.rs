//! Supports stay clear of zeros, and are laid out completely.

use super::*;
use crate::samples::{
    large_double_torus, large_torus, open_cylinder, random_mesh, surfaces_with_zeros,
};
use crate::tmesh::Grid;

const GRID: Grid = Grid {
    columns: 4,
    rows: 2,
};

fn supports(mesh: &TMesh) -> Vec<Support> {
    let anchors = mesh.anchors();
    anchors
        .iter()
        .flat_map(|&n| Support::of_anchor(mesh, n))
        .collect()
}

#[test]
fn no_support_contains_a_zero_and_all_are_c2() {
    let mut ends_at_zero = 0;
    for seed in 0..40 {
        let complex = surfaces_with_zeros().swap_remove(seed % 4);
        let mesh = random_mesh(&complex, GRID, 3 * seed, seed as u64);
        for support in supports(&mesh) {
            let ends = |k: &[i64; 5]| [k[0], k[4]];
            let laid = complex.develop(support.node, ends(&support.x), ends(&support.y));
            assert!(laid.zeros.is_empty(), "{support:?}");
            for knots in [support.x, support.y] {
                assert_eq!(knots[2], 0);
                assert!(knots.windows(2).all(|w| w[0] < w[1]), "{support:?}");
            }
            let rays = [Direction::Left, Direction::Right].map(|d| mesh.ray(support.node, d));
            ends_at_zero += usize::from(-support.x[0] < rays[0].crossings[1]);
        }
    }
    assert!(ends_at_zero > 50, "{ends_at_zero}");
}

#[test]
fn pieces_tile_the_support() {
    for seed in 0..10 {
        let tori = [large_torus(0.37), large_torus(0.0)];
        for complex in surfaces_with_zeros().into_iter().chain(tori) {
            let mesh = random_mesh(&complex, GRID, 3 * seed, seed as u64);
            for support in supports(&mesh) {
                let pieces = support.pieces(&complex);
                let area =
                    |x: [i64; 2], y: [i64; 2]| i128::from(x[1] - x[0]) * i128::from(y[1] - y[0]);
                let sum: i128 = pieces.iter().map(|p| area(p.x, p.y)).sum();
                let (x, y) = (support.x, support.y);
                assert_eq!(sum, area([x[0], x[4]], [y[0], y[4]]), "{support:?}");
                for piece in &pieces {
                    // What a leaf knows is the origin: the piece must be all that it says.
                    let own = &complex.cylinders()[piece.cylinder as usize];
                    let [ox, oy] = piece.origin;
                    assert_eq!(
                        piece.x,
                        [(ox + x[0]).max(0), (ox + x[4]).min(own.circumference)]
                    );
                    assert_eq!(piece.y, [(oy + y[0]).max(0), (oy + y[4]).min(own.height)]);
                }
            }
        }
    }
}

#[test]
fn knots_are_drawn_back_by_the_rule() {
    let complex = large_double_torus();
    let mesh = random_mesh(&complex, GRID, 0, 0);
    let unit = complex.cylinders()[0].height / 300;
    // Columns of cylinder 0 at 0, 200, 400, 600, 800, rows at 0, 150: the zeros below lie at 0 and 400.
    let anchor = |x| Node {
        cylinder: 0,
        x: x * unit,
        y: 150 * unit,
    };
    let [support] = Support::of_anchor(&mesh, anchor(200))[..] else {
        panic!("one function");
    };
    // Rays: 200 to either side and on; zeros at (+-200, +-150) inside: |dx| / wx = 1/2 of 400, |dy| / wy
    // less than that of the second crossings, which lie beyond other cylinders' rows.
    assert_eq!(support.x.map(|k| k / unit)[2], 0);
    let high = support.y[4].max(-support.y[0]);
    assert!(
        support.x[4] <= 200 * unit || high <= 150 * unit,
        "{support:?}"
    );
    // On the vertical line through two zeros: rays stop at them, and knots are made distinct.
    let [support] = Support::of_anchor(&mesh, anchor(400))[..] else {
        panic!("one function");
    };
    assert_eq!(support.y.map(|k| k / unit), [-150, -75, 0, 75, 150]);
}

#[test]
fn open_borders_have_complete_knot_vectors() {
    for top in [
        crate::complex::Beyond::Boundary { index: 1 },
        crate::complex::Beyond::Pole { index: 0 },
    ] {
        let mesh = random_mesh(&open_cylinder(top), GRID, 0, 0);
        let height = mesh.complex().cylinders()[0].height;
        let half = height / 2;
        let rest = height - half;
        let mut vectors: Vec<[i64; 5]> = supports(&mesh)
            .iter()
            .filter(|s| s.node.x == 0)
            .map(|s| s.y.map(|k| k + s.node.y))
            .collect();
        vectors.sort_unstable();
        let t = [0, half, height];
        assert_eq!(
            vectors,
            [
                [t[0], t[0], t[0], t[0], t[1]],
                [t[0], t[0], t[0], t[1], t[2]],
                [t[0], t[0], t[1], t[2], t[2]],
                [t[0], t[1], t[2], t[2], t[2]],
                [t[1], t[2], t[2], t[2], t[2]],
            ]
        );
        assert!(rest >= half);
    }
}
