//! Tilings, lines and grading of meshes on small complexes.

use std::collections::BTreeSet;

use super::*;
use crate::complex::tests::double_torus;
use crate::complex::{Beyond, Border, Node, Segment};
use crate::samples::{
    Sequence, large_double_torus, large_torus, open_cylinder, random_mesh, surfaces_with_zeros,
};

const GRID: Grid = Grid {
    columns: 4,
    rows: 3,
};

#[test]
fn leaves_tile_cylinders_and_both_sides_of_borders() {
    for seed in 0..12 {
        let complex = surfaces_with_zeros().swap_remove(seed % 4);
        let seed = seed as u64;
        let mesh = random_mesh(&complex, GRID, 100, seed);
        let area = |l: &Leaf| i128::from(l.size()[0]) * i128::from(l.size()[1]);
        assert_eq!(mesh.leaves().iter().map(area).sum::<i128>(), complex.area());
        for (k, cylinder) in complex.cylinders().iter().enumerate() {
            for y in [0, cylinder.height] {
                let beside = mesh.leaves().iter().filter(|l| l.cylinder == k as u32);
                let widths = beside.filter(|l| l.y.contains(&y)).map(|l| l.size()[0]);
                assert_eq!(widths.sum::<i64>(), cylinder.circumference);
            }
        }
        // Every leaf is found at its corners, from the sides on which it lies.
        for (index, leaf) in mesh.leaves().iter().enumerate() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let sides = [i, j].map(|s| [Side::High, Side::Low][s]);
                let at = [leaf.x[i], leaf.y[j]];
                assert_eq!(mesh.locate(leaf.cylinder, at, sides), index as u32);
            }
        }
        let mut again = TMesh::build(&complex, mesh.grids()).expect("a mesh");
        for &(leaf, axis) in mesh.splits() {
            assert!(again.split(leaf, axis));
        }
        assert_eq!(again, mesh);
    }
}

/// All boxes of a torus in the plane, around the origin.
pub(crate) fn unrolled(mesh: &TMesh) -> Vec<[[i64; 2]; 2]> {
    let cylinder = &mesh.complex().cylinders()[0];
    let Beyond::Cylinder { start: twist, .. } = cylinder.top[0].beyond else {
        panic!("a torus");
    };
    let mut boxes = Vec::new();
    for q in -4..=4 {
        for p in -8..=8 {
            let shift = [p * cylinder.circumference - q * twist, q * cylinder.height];
            for leaf in mesh.leaves() {
                let x = leaf.x.map(|x| x + shift[0]);
                boxes.push([x, leaf.y.map(|y| y + shift[1])]);
            }
        }
    }
    boxes
}

/// The first two lines of boxes that a ray meets, by looking at all of them.
pub(crate) fn met(boxes: &[[[i64; 2]; 2]], from: [i64; 2], axis: usize, sign: i64) -> [i64; 2] {
    let beside = boxes.iter().filter(|b| {
        let [low, high] = b[1 - axis];
        low <= from[1 - axis] && from[1 - axis] <= high
    });
    let ahead = beside
        .flat_map(|b| b[axis])
        .map(|c| sign * (c - from[axis]));
    let distances: BTreeSet<i64> = ahead.filter(|&d| d > 0).collect();
    let mut distances = distances.into_iter();
    [0, 1].map(|_| distances.next().expect("a line"))
}

#[test]
fn rays_meet_what_a_walk_over_all_boxes_meets() {
    for (seed, twist) in [0.0, 0.25, 0.3717, 0.93].into_iter().enumerate() {
        let mesh = random_mesh(&large_torus(twist), GRID, 12, seed as u64);
        let boxes = unrolled(&mesh);
        for node in mesh.anchors() {
            for (axis, sign, direction) in [
                (0, -1, Direction::Left),
                (0, 1, Direction::Right),
                (1, -1, Direction::Down),
                (1, 1, Direction::Up),
            ] {
                let ray = mesh.ray(node, direction);
                let expected = met(&boxes, [node.x, node.y], axis, sign);
                assert_eq!((ray.crossings, ray.stop), (expected, None), "{node:?}");
            }
        }
    }
}

#[test]
fn rays_say_what_stops_them() {
    let mesh = random_mesh(&large_double_torus(), GRID, 0, 0);
    let top = mesh.complex().cylinders()[0].height;
    let row = mesh.leaves()[0].y[1];
    assert_eq!(mesh.leaves()[0].y[0], 0);
    // Below and above zeros, on their vertical lines.
    let node = |y| Node {
        cylinder: 0,
        x: 0,
        y,
    };
    let down = mesh.ray(node(row), Direction::Down);
    assert_eq!(
        (down.crossings, down.stop),
        ([row, row], Some(RayStop::Zero))
    );
    let rows: BTreeSet<i64> = mesh
        .leaves()
        .iter()
        .filter(|l| l.cylinder == 0)
        .map(|l| l.y[0])
        .collect();
    let last = *rows.last().expect("rows");
    let up = mesh.ray(node(last), Direction::Up);
    assert_eq!(up.crossings, [top - last; 2]);
    assert_eq!(up.stop, Some(RayStop::Zero));
    // On a critical line, between zeros: 400 of cylinder 0, which are all of cylinder 1.
    let on_line = mesh
        .anchors()
        .into_iter()
        .find(|n| (n.cylinder, n.y) == (1, 0));
    let on_line = on_line.expect("columns inside of every connection");
    for direction in [Direction::Left, Direction::Right] {
        let mut way = mesh.ray(on_line, direction);
        if way.stop.is_none() {
            // The second line is at most the zero.
            way.crossings[0] = way.crossings[1];
        }
        let end = match direction {
            Direction::Left => on_line.x - way.crossings[0],
            _ => on_line.x + way.crossings[0],
        };
        assert!((0..=mesh.complex().cylinders()[1].circumference).contains(&end));
    }
    for (beyond, stop) in [
        (Beyond::Boundary { index: 1 }, RayStop::Boundary),
        (Beyond::Pole { index: 0 }, RayStop::Pole),
    ] {
        let mesh = random_mesh(&open_cylinder(beyond), GRID, 0, 0);
        let height = mesh.complex().cylinders()[0].height;
        for node in mesh.anchors() {
            assert_eq!(mesh.open_border(node).is_some(), node.y % height == 0);
            let up = mesh.ray(node, Direction::Up);
            let left = height - node.y;
            assert_eq!(
                up.stop,
                (up.crossings[1] == left && up.crossings[0] == left).then_some(stop)
            );
            assert_eq!(left == 0, up.crossings == [0, 0]);
        }
    }
}

#[test]
fn grading_bounds_neighbours_and_shapes() {
    let grading = Grading {
        levels: Some(1),
        aspect: 8.0,
    };
    let complex = large_double_torus();
    let mut mesh = TMesh::build(&complex, &[GRID; 3]).expect("a mesh");
    let mut numbers = Sequence(5);
    for _ in 0..40 {
        // Again and again near one corner, which needs much around it.
        let near = mesh.leaf_of(Point {
            cylinder: 0,
            x: 3.0e12 * numbers.unit(),
            y: 1.0,
        });
        let axis = [Axis::X, Axis::Y, Axis::Both][(numbers.next() % 3) as usize];
        let before = mesh.leaves().len();
        let more = mesh.refine(&[(near, axis)], &grading);
        assert!(more > 0 && mesh.leaves().len() == before + more);
    }
    assert!(mesh.leaves().iter().any(|l| l.level[0] > 4));
    for (index, leaf) in mesh.leaves().iter().enumerate() {
        for other in mesh.neighbours(index as u32) {
            let level = mesh.leaves()[other as usize].level;
            assert!(level[0].abs_diff(leaf.level[0]) <= 1);
            assert!(level[1].abs_diff(leaf.level[1]) <= 1);
            assert!(mesh.neighbours(other).contains(&(index as u32)));
        }
        let [w, h] = leaf.size();
        assert!(w.max(h) <= 8 * w.min(h) + 64);
    }
}

#[test]
fn grids_that_fit_nothing_are_named() {
    let complex = large_double_torus();
    let wrong = TMesh::build(&complex, &[GRID; 2]).expect_err("two grids for three");
    assert_eq!(
        wrong.to_string(),
        "2 base grids for 3 cylinders; give one for each"
    );
    let none = Grid {
        columns: 0,
        rows: 1,
    };
    let wrong = TMesh::build(&complex, &[GRID, none, GRID]).expect_err("no columns");
    assert_eq!(wrong, TMeshError::Grid { cylinder: 1 });
    let endless = Grid {
        columns: u32::MAX as usize,
        rows: 2,
    };
    let wrong = TMesh::build(&complex, &[GRID, GRID, endless]).expect_err("too many columns");
    assert_eq!(wrong, TMeshError::Grid { cylinder: 2 });
    let mut tiny = TMesh::build(&Arc::new(double_torus()), &[GRID; 3]).expect("a mesh");
    while tiny.split(0, Axis::Both) {}
    assert!(tiny.leaves()[0].size()[0] < 16);
    assert_eq!(complex.border(0, Border::Top).len(), 2);
}

#[test]
fn grids_have_lines_through_zeros_and_between_them() {
    for complex in surfaces_with_zeros() {
        for columns in 1..12 {
            let grid = Grid { columns, rows: 1 };
            for own in complex.cylinders() {
                let (xs, ys) = grid.lines(own);
                let zeros = |border: &[Segment]| -> Vec<i64> {
                    let marked = border.iter().filter(|s| s.zero.is_some());
                    marked.map(|s| s.start).collect()
                };
                let (bottom, top) = (zeros(&own.bottom), zeros(&own.top));
                assert!(xs.windows(2).all(|w| w[0] < w[1]));
                assert_eq!((xs[0], xs[xs.len() - 1]), (0, own.circumference));
                assert!(bottom.iter().chain(&top).all(|x| xs.contains(x)));
                for (k, &zero) in bottom.iter().enumerate() {
                    let next = bottom.get(k + 1).copied();
                    let next = next.unwrap_or(bottom[0] + own.circumference);
                    let turned = xs.iter().flat_map(|&x| [x, x + own.circumference]);
                    assert!(turned.into_iter().any(|x| zero < x && x < next));
                }
                let facing = bottom.iter().any(|x| top.contains(x));
                assert!(ys.len() == 3 || ys.len() == 2 && !facing);
                // Filling is even: no more than the lines asked for between those that must be.
                let must = 2 + 2 * (bottom.len() + top.len());
                assert!(xs.len() <= columns + 1 + must, "{} of {columns}", xs.len());
            }
        }
    }
}

#[test]
fn grids_have_about_the_cells_asked_for() {
    let complex = large_torus(0.3);
    let grid = Grid::of_cells(&complex.cylinders()[0], 60.0, 1.0);
    // C = 2 H.
    assert_eq!((grid.columns, grid.rows), (11, 5));
    let wide = Grid::of_cells(&complex.cylinders()[0], 32.0, 4.0);
    assert_eq!((wide.columns, wide.rows), (4, 8));
}

/// Columns of one cylinder that are halved thirds of a border meet halved quarters of the next one: two lines
/// a unit apart would be a double knot.
#[test]
fn lines_of_two_cylinders_that_are_one_have_no_interval_between_them() {
    const LEAST: i64 = 1 << 20;
    // Zeros of the double torus lie at 0 and 400 of 1000 below cylinder 0, at the ends of 1 and 2.
    let columns = [[8, 4, 5], [5, 4, 9], [15, 2, 7], [7, 12, 3]];
    for (rounds, columns) in [1, 2, 3].into_iter().flat_map(|n| columns.map(|c| (n, c))) {
        let grids = columns.map(|columns| Grid { columns, rows: 2 });
        let mut mesh = TMesh::build(&large_double_torus(), &grids).expect("a mesh");
        for _ in 0..rounds {
            for leaf in 0..mesh.leaves().len() as u32 {
                assert!(mesh.split(leaf, Axis::X));
            }
        }
        for node in mesh.anchors() {
            for direction in [Direction::Left, Direction::Right] {
                let [first, second] = mesh.ray(node, direction).crossings;
                let rest = second - first;
                assert!(
                    first >= LEAST && (rest == 0 || rest >= LEAST),
                    "{columns:?}: {node:?}"
                );
            }
        }
    }
}
