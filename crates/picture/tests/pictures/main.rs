//! Laws of whole pictures: what must be seen, where, and in which colour.

mod checkers;
mod normals;

use msplines_picture::{
    Camera, ColourMap, ColourScale, Curves, Detail, Drawing, Image, Occlusion, Paint, PictureError,
    Radius, Rect, Rgb, Scene, Shading, Spheres, Surface, View,
};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// A picture without shades of hollows, one sample per pixel.
const PLAIN: Drawing = Drawing {
    width: 200,
    height: 200,
    samples: 1,
    background: Rgb::WHITE,
    occlusion: Occlusion {
        strength: 0.0,
        reach: 0.0,
    },
    bias: 0.006,
    detail: None,
};

/// Returns a camera at distance `z` before the origin.
fn before(z: f64) -> Camera {
    Camera::looking(
        Point3::new(0.0, 0.0, z),
        Point3::origin(),
        Vector3::y(),
        0.8,
    )
}

/// Returns the corners and faces of a sphere of this radius.
fn ball(radius: f64, rings: u32) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let columns = 2 * rings;
    let grid = (0..=rings).flat_map(|ring| (0..columns).map(move |column| (ring, column)));
    let place = |(ring, column): (u32, u32)| {
        let latitude = std::f64::consts::PI * (f64::from(ring) / f64::from(rings) - 0.5);
        let longitude = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
        let cos = latitude.cos();
        Point3::new(cos * longitude.sin(), latitude.sin(), cos * longitude.cos()) * radius
    };
    let faces = (0..rings * columns).flat_map(|i| {
        let [a, b] = [i, i - i % columns + (i + 1) % columns];
        [[a, b, b + columns], [a, b + columns, a + columns]]
    });
    (grid.map(place).collect(), faces.collect())
}

/// Returns how many pixels differ from the background.
fn covered(image: &Image) -> usize {
    let pixels = image.bytes().chunks_exact(3);
    pixels
        .filter(|pixel| *pixel != Rgb::WHITE.channels())
        .count()
}

/// Returns how many pixels are clearly red.
fn red(image: &Image) -> usize {
    let is_red = |p: &&[u8]| p[0] > 150 && p[1] < 80 && p[2] < 80;
    image.bytes().chunks_exact(3).filter(is_red).count()
}

#[test]
fn the_same_scene_gives_the_same_bytes_on_any_number_of_threads() {
    let (positions, faces) = ball(1.0, 24);
    let values: Vec<f64> = positions.iter().map(|p| p.x * p.y).collect();
    let knots: Vec<_> = positions.iter().step_by(37).copied().collect();
    let segments: Vec<[u32; 2]> = (0..500).map(|i| [i, i + 1]).collect();
    let hull: Vec<_> = positions.iter().map(|p| p * 1.2).collect();
    let mut scene = Scene::new(Camera::framing(&hull, &View::default()));
    let scale = ColourScale::linear(ColourMap::ColdWarm, [-0.4, 0.4]);
    let paint = Paint::Scalars {
        values: &values,
        scale,
    };
    scene.add(Surface::new(&positions, &faces).paint(paint));
    scene.add(Curves::new(&positions, &segments).width(3.0));
    scene.add(Spheres::new(&knots));
    scene.add(
        Surface::new(&hull, &faces)
            .opacity(0.3)
            .shading(Shading::Flat),
    );
    let drawing = Drawing {
        width: 150,
        height: 130,
        samples: 2,
        ..Drawing::default()
    };
    let draw = || scene.draw(&drawing).expect("a picture").to_png();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(draw)
    };
    let once = draw();
    assert!(once == draw() && once == with(1) && once == with(2));
}

#[test]
fn a_sphere_covers_what_its_projection_says() {
    let (distance, radius) = (4.0, 1.0_f64);
    // The cone of tangents from the eye meets the plane at depth 1 in a circle of this radius.
    let slope = radius / f64::sqrt(distance * distance - radius * radius);
    let pixels = slope * 100.0 / f64::tan(0.4);
    let area = std::f64::consts::PI * pixels * pixels;
    let rim = std::f64::consts::TAU * pixels;
    let (positions, faces) = ball(radius, 200);
    let mut mesh = Scene::new(before(distance));
    mesh.add(Surface::new(&positions, &faces));
    let centre = [Point3::origin()];
    let mut exact = Scene::new(before(distance));
    exact.add(Spheres::new(&centre).radius(Radius::World(radius)));
    for scene in [mesh, exact] {
        let count = covered(&scene.draw(&PLAIN).expect("a picture")) as f64;
        assert!((count - area).abs() < rim, "{count} for {area}");
    }
}

#[test]
fn a_sphere_of_pixels_is_as_large_at_any_distance() {
    for z in [0.0, -20.0] {
        let centre = [Point3::new(0.0, 0.0, z)];
        let mut scene = Scene::new(before(4.0));
        scene.add(Spheres::new(&centre).radius(Radius::Pixels(20.0)));
        let count = covered(&scene.draw(&PLAIN).expect("a picture")) as f64;
        // Seen from so near the circle of tangents is a little larger than the sphere's own.
        assert!(
            (count / (400.0 * std::f64::consts::PI) - 1.0).abs() < 0.05,
            "{count}"
        );
    }
}

#[test]
fn the_nearer_triangle_hides_the_farther_in_both_orders() {
    let triangle = |z: f64| [[-2.0, -2.0, z], [2.0, -2.0, z], [0.0, 2.0, z]].map(Point3::from);
    let [near, far] = [triangle(0.5), triangle(-0.5)];
    let faces = [[0, 1, 2]];
    let red_one = Surface::new(&near, &faces).paint(Paint::Uniform(Rgb::RED));
    let blue_one = Surface::new(&far, &faces).paint(Paint::Uniform(Rgb::BLUE));
    let draw = |objects: [Surface<'_>; 2]| {
        let mut scene = Scene::new(before(4.0));
        for object in objects {
            scene.add(object);
        }
        scene.draw(&PLAIN).expect("a picture")
    };
    let image = draw([red_one, blue_one]);
    assert_eq!(image, draw([blue_one, red_one]));
    let middle = image.pixel(100, 100).expect("inside");
    assert!(middle.red > 2 * middle.blue);
}

#[test]
fn scalars_are_interpolated_in_perspective() {
    // A floor that runs away from the eye; the scalar is the depth along it.
    let floor = [
        [-9.0, -1.0, 3.0],
        [9.0, -1.0, 3.0],
        [9.0, -1.0, -15.0],
        [-9.0, -1.0, -15.0],
    ];
    let positions = floor.map(Point3::from);
    let values = [0.0, 0.0, 18.0, 18.0];
    let scale = ColourScale::linear(ColourMap::Viridis, [0.0, 18.0]);
    let paint = Paint::Scalars {
        values: &values,
        scale,
    };
    let mut scene = Scene::new(before(4.0));
    scene.add(Surface::new(&positions, &[[0, 1, 2], [0, 2, 3]]).paint(paint));
    let image = scene.draw(&PLAIN).expect("a picture");
    // The light on a plane is nearly even, so hues tell the scalar: shares of the channels.
    let shares = |colour: Rgb| {
        let linear = colour.channels().map(|c| (f64::from(c) / 255.0).powf(2.2));
        let sum: f64 = linear.iter().sum();
        linear.map(|c| c / sum)
    };
    for row in [125, 140, 160, 180] {
        let slope = (f64::from(row) + 0.5 - 100.0) * f64::tan(0.4) / 100.0;
        // The ray meets height -1 at depth 1 / slope; the floor starts at depth 1.
        let expected = shares(scale.colour(1.0 / slope - 1.0));
        let found = shares(image.pixel(101, row as usize).expect("inside"));
        for (a, b) in expected.iter().zip(found) {
            assert!((a - b).abs() < 0.03, "row {row}: {expected:?} {found:?}");
        }
    }
}

#[test]
fn a_curve_is_seen_in_front_and_hidden_behind() {
    let (positions, faces) = ball(1.0, 40);
    let arc = |side: f64| -> Vec<Point3<f64>> {
        let at = |i: i32| {
            let angle = f64::from(i) * 0.03;
            Point3::new(angle.sin(), 0.1, side * angle.cos()) * (1.0 / 1.01_f64.sqrt())
        };
        (-20..=20).map(at).collect()
    };
    let segments: Vec<[u32; 2]> = (0..40).map(|i| [i, i + 1]).collect();
    let draw = |points: &[Point3<f64>]| {
        let mut scene = Scene::new(before(4.0));
        scene.add(Surface::new(&positions, &faces));
        scene.add(Curves::new(points, &segments).width(3.0).colour(Rgb::RED));
        red(&scene.draw(&PLAIN).expect("a picture"))
    };
    // The arc spans 2 sin 0.6 at depths about 3.1; it is three pixels wide.
    let length = 2.0 * f64::sin(0.6) / 3.1 * 100.0 / f64::tan(0.4);
    let front = draw(&arc(1.0)) as f64;
    assert!(
        (0.7..1.3).contains(&(front / (2.0 * length))),
        "{front} for {length}"
    );
    assert_eq!(draw(&arc(-1.0)), 0);
}

#[test]
fn what_is_translucent_lets_the_background_through() {
    let (positions, faces) = ball(1.0, 20);
    let draw = |opacity| {
        let mut scene = Scene::new(before(4.0));
        let black = Paint::Uniform(Rgb::new(0, 0, 0));
        scene.add(
            Surface::new(&positions, &faces)
                .paint(black)
                .opacity(opacity),
        );
        let image = scene.draw(&PLAIN).expect("a picture");
        f64::from(image.pixel(100, 100).expect("inside").green)
    };
    assert_eq!(draw(0.0), 255.0);
    // Two layers at a half leave a quarter of the light, which is byte 137 in sRGB.
    assert!((draw(0.5) - 137.0).abs() < 6.0, "{}", draw(0.5));
    assert!(draw(1.0) < 70.0);
}

#[test]
fn faint_curves_are_as_faint_where_segments_meet() {
    let points: Vec<_> = (0..=40)
        .map(|i| Point3::new(f64::from(i) / 20.0 - 1.0, 0.01, 0.0))
        .collect();
    let segments: Vec<[u32; 2]> = (0..40).map(|i| [i, i + 1]).collect();
    let mut scene = Scene::new(before(4.0));
    let faint = Curves::new(&points, &segments).width(9.0).opacity(0.5);
    scene.add(faint);
    let image = scene.draw(&PLAIN).expect("a picture");
    let line: Vec<_> = (60..140).map(|x| image.pixel(x, 99)).collect();
    assert!(line.iter().all(|pixel| *pixel == line[0]), "{line:?}");
}

#[test]
fn a_corner_is_darker_than_a_plane() {
    // A floor and a wall that meet in front of the eye.
    let corners = [
        [-2.0, -0.5, 2.0],
        [2.0, -0.5, 2.0],
        [2.0, -0.5, -0.5],
        [-2.0, -0.5, -0.5],
        [-2.0, 2.0, -0.5],
        [2.0, 2.0, -0.5],
    ];
    let positions = corners.map(Point3::from);
    let faces = [[0, 1, 2], [0, 2, 3], [3, 2, 5], [3, 5, 4]];
    let draw = |strength| {
        let mut scene = Scene::new(before(4.0));
        scene.add(Surface::new(&positions, &faces).shading(Shading::Flat));
        let occlusion = Occlusion {
            strength,
            reach: 0.2,
        };
        scene
            .draw(&Drawing { occlusion, ..PLAIN })
            .expect("a picture")
    };
    let [without, with] = [draw(0.0), draw(1.0)];
    let darker = |y: usize| {
        let red = |image: &Image| image.pixel(100, y).map_or(0, |pixel| i32::from(pixel.red));
        red(&without) - red(&with)
    };
    // The floor ends where the wall starts: half a unit down at depth four and a half.
    let seam = 100 + (0.5 / 4.5 / f64::tan(0.4) * 100.0) as usize;
    assert!(darker(seam - 2) > 5, "{}", darker(seam - 2));
    assert_eq!(darker(20), 0);
}

#[test]
fn the_back_of_a_face_is_darker_and_warmer() {
    let positions = [[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [0.0, 2.0, 0.0]].map(Point3::from);
    let draw = |face: [u32; 3]| {
        let mut scene = Scene::new(before(4.0));
        let faces = [face];
        scene.add(Surface::new(&positions, &faces));
        scene
            .draw(&PLAIN)
            .expect("a picture")
            .pixel(100, 100)
            .expect("inside")
    };
    let [front, back] = [draw([0, 1, 2]), draw([0, 2, 1])];
    assert!(back.red < front.red);
    assert!(
        u32::from(back.red) * u32::from(front.blue) > u32::from(front.red) * u32::from(back.blue)
    );
}

#[test]
fn a_detail_is_the_part_of_the_whole() {
    let (positions, faces) = ball(1.0, 60);
    let mut scene = Scene::new(before(4.0));
    scene.add(Surface::new(&positions, &faces));
    let source = Rect {
        x: 40,
        y: 60,
        width: 50,
        height: 40,
    };
    let whole = scene.draw(&PLAIN).expect("a picture");
    let detail = Some(Detail {
        source,
        magnification: 3,
    });
    let part = scene.draw(&Drawing { detail, ..PLAIN }).expect("a picture");
    assert_eq!((part.width(), part.height()), (150, 120));
    for (x, y) in [(10, 10), (25, 20), (45, 35)] {
        let a = whole.pixel(40 + x, 60 + y).expect("inside").channels();
        let b = part.pixel(3 * x + 1, 3 * y + 1).expect("inside").channels();
        assert!(
            a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 3),
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn a_point_appears_where_it_is_said_to() {
    let centre = [Point3::new(0.3, -0.2, 0.4)];
    let mut scene = Scene::new(before(4.0));
    scene.add(Spheres::new(&centre).radius(Radius::Pixels(3.0)));
    let [x, y] = scene.pixel(&centre[0], &PLAIN).expect("before the eye");
    let image = scene.draw(&PLAIN).expect("a picture");
    assert_ne!(image.pixel(x as usize, y as usize), Some(Rgb::WHITE));
    assert_eq!(scene.pixel(&Point3::new(0.0, 0.0, 9.0), &PLAIN), None);
}

/// Returns what is wrong with the picture of one surface.
fn wrong(surface: Surface<'_>, drawing: &Drawing) -> Option<PictureError> {
    let mut scene = Scene::new(before(4.0));
    scene.add(surface);
    scene.draw(drawing).err()
}

#[test]
fn wrong_objects_are_named() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN, 1.0, 0.0]].map(Point3::from);
    let out = PictureError::IndexOutOfRange {
        object: 0,
        element: 0,
        point: 7,
        points: 3,
    };
    let surface = Surface::new(&positions, &[[0, 1, 7]]);
    assert_eq!(wrong(surface, &PLAIN), Some(out));
    let nan = PictureError::NotFinite {
        object: 0,
        point: 2,
    };
    let surface = Surface::new(&positions, &[[0, 1, 2]]);
    assert_eq!(wrong(surface, &PLAIN), Some(nan));
    let few = Surface::new(&positions, &[]).paint(Paint::Colours(&[Rgb::RED]));
    let error = wrong(few, &PLAIN);
    assert!(matches!(
        error,
        Some(PictureError::WrongCount { found: 1, .. })
    ));
    assert_eq!(wrong(Surface::new(&positions, &[]), &PLAIN), None);
    assert_eq!(wrong(Surface::new(&[], &[]), &PLAIN), None);
}

#[test]
fn wrong_drawings_are_named() {
    let nothing = Surface::new(&[], &[]);
    let empty = Drawing { width: 0, ..PLAIN };
    let error = wrong(nothing, &empty);
    assert!(matches!(error, Some(PictureError::Empty { width: 0, .. })));
    for side in [100_000, usize::MAX] {
        let large = Drawing {
            width: side,
            height: side,
            ..PLAIN
        };
        let error = wrong(nothing, &large);
        assert!(matches!(error, Some(PictureError::TooLarge { .. })));
    }
    let occlusion = Occlusion {
        strength: -1.0,
        reach: 0.1,
    };
    let detail = Some(Detail {
        source: Rect::default(),
        magnification: 0,
    });
    for drawing in [
        Drawing {
            samples: 0,
            ..PLAIN
        },
        Drawing {
            bias: f64::NAN,
            ..PLAIN
        },
        Drawing { occlusion, ..PLAIN },
        Drawing { detail, ..PLAIN },
    ] {
        let error = wrong(nothing, &drawing);
        assert!(matches!(error, Some(PictureError::BadOption { .. })));
    }
}

#[test]
fn the_eye_inside_of_an_object_sees_its_inside() {
    let (positions, faces) = ball(1.0, 20);
    let mut scene = Scene::new(before(0.5));
    scene.add(Surface::new(&positions, &faces));
    let centre = [Point3::origin()];
    scene.add(Spheres::new(&centre).radius(Radius::World(2.0)));
    let image = scene
        .draw(&Drawing {
            samples: 2,
            ..PLAIN
        })
        .expect("a picture");
    assert_eq!(covered(&image), 200 * 200);
}

proptest! {
    #[test]
    fn no_coordinates_make_it_panic(
        coordinates in prop::collection::vec(
            prop_oneof![
                -3.0..3.0_f64,
                Just(0.0),
                Just(1e308),
                Just(-1e200),
                Just(1e-308),
                Just(4.0),
            ],
            12..30,
        ),
        radius in prop_oneof![Just(0.0), Just(1e300), 0.0..50.0_f64],
    ) {
        let points: Vec<_> =
            coordinates.chunks_exact(3).map(|c| Point3::new(c[0], c[1], c[2])).collect();
        let last = points.len() as u32 - 1;
        let faces = [[0, 1, 2], [0, 0, 1], [1, 2, last], [last, last, last]];
        let segments = [[0, 1], [1, last], [2, 2]];
        let values: Vec<f64> = points.iter().map(|p| p.x / p.y).collect();
        let drawing = Drawing { width: 24, height: 16, samples: 2, ..Drawing::default() };
        for camera in [before(4.0), Camera::framing(&points, &View::default())] {
            let mut scene = Scene::new(camera);
            let scale = ColourScale::linear(ColourMap::Magma, [0.0, 1.0]);
            scene.add(Surface::new(&points, &faces).paint(Paint::Scalars { values: &values, scale }));
            scene.add(Surface::new(&points, &faces).opacity(0.5).shading(Shading::Flat));
            scene.add(Curves::new(&points, &segments).width(4.0));
            scene.add(Spheres::new(&points).radius(Radius::World(radius)));
            scene.add(Spheres::new(&points).radius(Radius::Pixels(radius)));
            prop_assert!(scene.draw(&drawing).is_ok());
        }
    }
}
