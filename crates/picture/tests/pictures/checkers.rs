//! Laws of checkerboards on surfaces.

use msplines_picture::{Drawing, Paint, Rgb, Scene, Surface};
use nalgebra::Point3;

use crate::{PLAIN, before};

/// Returns a checkerboard of eight by eight squares on a tilted plane, from two faces of which the second
/// is numbered as if moved by one square along the texture.
fn board() -> ([Point3<f64>; 4], [[[f64; 2]; 3]; 2]) {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = square.map(|[x, y]| Point3::new(x, y, TILT * x));
    let at = |corner: usize, moved: f64| {
        let [x, y] = square[corner];
        [0.5 * (x + 1.0) + moved, 0.5 * (y + 1.0)]
    };
    let texture = [
        [at(0, 0.0), at(1, 0.0), at(2, 0.0)],
        [
            at(0, 1.0 / SQUARES),
            at(2, 1.0 / SQUARES),
            at(3, 1.0 / SQUARES),
        ],
    ];
    (positions, texture)
}

/// Rise of the board to the right.
const TILT: f64 = 0.5;
/// Squares along its sides.
const SQUARES: f64 = 8.0;

#[test]
fn checkers_follow_the_corners_of_faces_in_perspective() {
    let (positions, texture) = board();
    let paint = Paint::Checkers {
        corners: &texture,
        squares: SQUARES,
        colours: [Rgb::RED, Rgb::BLUE],
    };
    let mut scene = Scene::new(before(3.0));
    let surface = Surface::new(&positions, &[[0, 1, 2], [0, 2, 3]]);
    scene.add(surface.paint(paint));
    let image = scene.draw(&PLAIN).expect("a picture");
    let mut seen = [0; 2];
    for (row, column) in (0..200).flat_map(|row| (0..200).map(move |column| (row, column))) {
        let slope = |i: usize| (i as f64 + 0.5 - 100.0) * f64::tan(0.4) / 100.0;
        // The ray from depth 3 meets the tilted plane at this depth.
        let depth = 3.0 / (1.0 + TILT * slope(column));
        let [x, y] = [slope(column) * depth, -slope(row) * depth];
        let squares = [x, y].map(|c| 0.5 * (c + 1.0) * SQUARES);
        let is_near_edge = squares.iter().any(|c| (c - c.round()).abs() < 0.02);
        if x.abs().max(y.abs()) > 0.99 || is_near_edge || (x - y).abs() < 0.01 {
            continue;
        }
        let moved = if y > x { 1.0 } else { 0.0 };
        let is_odd = (squares[0].floor() + squares[1].floor() + moved) % 2.0 == 1.0;
        let [red, _, blue] = image.pixel(column, row).expect("inside").channels();
        assert_eq!(blue > red, is_odd, "row {row}, column {column}");
        seen[usize::from(is_odd)] += 1;
    }
    assert!(seen.iter().all(|&count| count > 3000), "{seen:?}");
}

#[test]
fn edges_of_checkers_inside_of_faces_are_smooth_over_one_pixel() {
    // The edge between two squares runs through the middle of column 100 of 201.
    let positions = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]].map(Point3::from);
    let corners = [positions.map(|p| [p.x / 18.0, 0.5])];
    let paint = Paint::Checkers {
        corners: &corners,
        squares: 1.0,
        colours: [Rgb::WHITE, Rgb::new(0, 0, 0)],
    };
    let mut scene = Scene::new(before(3.0));
    scene.add(Surface::new(&positions, &[[0, 1, 2]]).paint(paint));
    for samples in [1, 2, 4] {
        let drawing = Drawing {
            width: 201,
            samples,
            ..PLAIN
        };
        let image = scene.draw(&drawing).expect("a picture");
        let light = |column: usize| {
            let [value, ..] = image.pixel(column, 100).expect("inside").channels();
            let value = f64::from(value) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        let [left, middle, right] = [99, 100, 101].map(light);
        // Black has a faint gloss.
        assert!(left < 0.01 && right > 0.5, "{left} {right}");
        let share = (middle - left) / (right - left);
        if samples == 1 {
            assert!(!(0.01..=0.99).contains(&share), "{share}");
        } else {
            // Bytes have steps of about 1 % of the light here.
            assert!((share - 0.5).abs() < 0.02, "{share}");
        }
    }
}
