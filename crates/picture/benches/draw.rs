//! One picture of a surface of 270,000 triangles, and what is written for it.

use std::sync::LazyLock;

use divan::Bencher;
use msplines_picture::{Camera, Curves, Drawing, Image, Scene, Surface, View, edges};
use nalgebra::{Point3, Vector3};

/// Rings and columns of the sphere; together they give 270,000 triangles.
const RINGS: u32 = 270;
const COLUMNS: u32 = 500;

struct Shape {
    positions: Vec<Point3<f64>>,
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
}

static SHAPE: LazyLock<Shape> = LazyLock::new(|| {
    let place = |ring: u32, column: u32| {
        let latitude = std::f64::consts::PI * (f64::from(ring) / f64::from(RINGS) - 0.5);
        let longitude = std::f64::consts::TAU * f64::from(column) / f64::from(COLUMNS);
        let (sin, cos) = latitude.sin_cos();
        let direction = Vector3::new(cos * longitude.sin(), sin, cos * longitude.cos());
        let bump =
            (9.0 * direction.x).sin() * (8.0 * direction.y).cos() + (9.0 * direction.z).sin();
        Point3::from(direction * (1.0 + 0.05 * bump))
    };
    let rings = (0..=RINGS).flat_map(|ring| (0..COLUMNS).map(move |column| (ring, column)));
    let positions = rings.map(|(ring, column)| place(ring, column)).collect();
    let quads = (0..RINGS).flat_map(|ring| (0..COLUMNS).map(move |column| (ring, column)));
    let faces: Vec<_> = quads
        .flat_map(|(ring, column)| {
            let at = |ring: u32, column: u32| ring * COLUMNS + column % COLUMNS;
            let [a, b] = [at(ring, column), at(ring, column + 1)];
            let [c, d] = [at(ring + 1, column), at(ring + 1, column + 1)];
            [[a, b, d], [a, d, c]]
        })
        .collect();
    let edges = edges(&faces);
    Shape {
        positions,
        faces,
        edges,
    }
});

fn scene() -> Scene<'static> {
    let shape = &*SHAPE;
    let mut scene = Scene::new(Camera::framing(&shape.positions, &View::default()));
    scene.add(Surface::new(&shape.positions, &shape.faces));
    scene
}

fn draw(scene: &Scene<'_>) -> Image {
    scene.draw(&Drawing::default()).expect("a picture")
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn picture_and_png(bencher: Bencher<'_, '_>) {
    let scene = scene();
    bencher.bench(|| draw(&scene).to_png());
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn png(bencher: Bencher<'_, '_>) {
    let image = draw(&scene());
    bencher.bench(|| image.to_png());
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn with_all_edges(bencher: Bencher<'_, '_>) {
    let mut scene = scene();
    scene.add(Curves::new(&SHAPE.positions, &SHAPE.edges).width(0.5));
    bencher.bench(|| draw(&scene));
}

fn main() {
    divan::main();
}
