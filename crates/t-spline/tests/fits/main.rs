//! Laws of T-splines that were fitted to whole surfaces: generated ones, and those of the library of models
//! that are at hand.
#![allow(
    clippy::print_stdout,
    reason = "the figures of every surface are shown"
)]

#[path = "../../../../tests/library.rs"]
mod library;
mod lines;

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_t_spline::complex::{CylinderComplex, Point};
use msplines_t_spline::domain::{Domain, DomainOptions};
use msplines_t_spline::{FitOptions, Sampling, Stop, TSpline, TSplineSurface};

/// Models, their poles and numbers of control points.
const MODELS: [(&str, &[u32], usize); 4] = [
    ("kitten_40k", &[], 765),
    ("fertility_30k", &[], 2000),
    ("bunny_30k", &[29830, 29379, 16387], 1303),
    ("happy_buddha_25k", &[], 4000),
];

/// Random points at which sums of functions are looked at.
const POINTS: usize = 20_000;

/// A surface that was fitted, and what it was fitted to.
struct Whole {
    name: String,
    surface: TSplineSurface,
}

fn whole(name: &str, mesh: &TriangleMesh, poles: &[u32], most: usize) -> Whole {
    let options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    let domain = Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain");
    let options = FitOptions {
        stop: Stop::ControlPoints(most),
        ..FitOptions::default()
    };
    let sampling = Sampling::default();
    let fitted = TSplineSurface::fit(domain, mesh, &sampling, &options, &mut unobserved());
    Whole {
        name: name.to_owned(),
        surface: fitted.expect("a fit").surface,
    }
}

/// The vertices farthest up and down.
fn ends(mesh: &TriangleMesh) -> [u32; 2] {
    let height = |v: &u32| mesh.positions()[*v as usize].z;
    let by = |a: &u32, b: &u32| height(a).total_cmp(&height(b));
    let vertices = || 0..mesh.vertex_count() as u32;
    [vertices().max_by(by), vertices().min_by(by)].map(|v| v.expect("vertices"))
}

/// Returns the fits of generated surfaces, of genus 0 to 3, with poles and boundaries.
fn generated() -> Vec<Whole> {
    let bumpy = shapes::bumpy_sphere(2000);
    vec![
        whole("torus", &shapes::torus(1.0, 0.4, 1500), &[], 150),
        whole("torus knot", &shapes::torus_knot(2, 3, 3000), &[], 300),
        whole("genus 2", &shapes::genus(2, 2500), &[], 500),
        whole("genus 3", &shapes::genus(3, 4000), &[], 900),
        whole("bumpy sphere", &bumpy, &ends(&bumpy), 300),
        whole("open cylinder", &shapes::cylinder(1200), &[], 150),
    ]
}

/// Returns the fit of a model, if it is there.
fn model((name, poles, most): (&str, &[u32], usize)) -> Option<Whole> {
    let mesh = library::model(name)?;
    Some(whole(name, &mesh, poles, most))
}

/// Numbers that are the same in every run, in `[0, 1)`.
struct Sequence(u64);

impl Sequence {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn random_points(complex: &CylinderComplex) -> Vec<Point> {
    let mut numbers = Sequence(1);
    let cylinders = complex.cylinders();
    let point = |i: usize| {
        let own = &cylinders[i % cylinders.len()];
        Point {
            cylinder: (i % cylinders.len()) as u32,
            x: numbers.unit() * own.circumference as f64,
            y: numbers.unit() * own.height as f64,
        }
    };
    (0..POINTS).map(point).collect()
}

/// Sides of faces are told by edges that both neighbours have whole: what one has on one side adds up to
/// what it has on the opposite one, in whole units, however many borders the lines between were carried
/// over.
fn assert_knot_intervals_agree(whole: &Whole) {
    let spline = whole.surface.spline();
    let (mesh, leaves) = (spline.quad_mesh(), spline.space().mesh().leaves());
    let mut uses = vec![Vec::new(); mesh.edges().len()];
    for (face, leaf) in mesh.faces().iter().zip(leaves) {
        let sides = face.sides.each_ref().map(|parts| {
            let lengths = parts
                .iter()
                .map(|part| mesh.edges()[part.edge.edge as usize].length);
            lengths.sum::<i64>()
        });
        assert_eq!(sides[0], sides[2], "{}: {leaf:?}", whole.name);
        assert_eq!(sides[1], sides[3], "{}: {leaf:?}", whole.name);
        assert_eq!([sides[0], sides[1]], leaf.size(), "{}", whole.name);
        for part in face.sides.iter().flatten() {
            uses[part.edge.edge as usize].push((part.edge.reversed, part.range[1] - part.range[0]));
        }
    }
    let mut open = 0;
    for (uses, edge) in uses.iter().zip(mesh.edges()) {
        assert!(
            uses.iter().all(|(_, length)| *length == edge.length),
            "{}",
            whole.name
        );
        match uses[..] {
            [(first, _), (second, _)] => assert_ne!(first, second, "{}", whole.name),
            [_] => open += 1,
            _ => panic!("{}: an edge of {} faces", whole.name, uses.len()),
        }
    }
    // Where cylinders end: at boundaries and around poles.
    let is_closed = whole.surface.domain().ends().is_empty();
    assert_eq!(open == 0, is_closed, "{}", whole.name);
    println!(
        "{}: {} faces, {} edges, opposite sides equal",
        whole.name,
        leaves.len(),
        uses.len()
    );
}

/// Rounding of a sum of some twenty quotients.
const UNITY: f64 = 1e-13;

/// The surface of constant 1 is 1 everywhere: at random points, at anchors and on the edges of faces.
fn assert_unity(whole: &Whole) {
    let space = whole.surface.spline().space();
    let functions = space.functions().len();
    let mut control = vec![Vector3::zeros(); space.unknowns()];
    control[..functions].fill(Vector3::new(1.0, 0.0, 0.0));
    for cap in space.caps().caps() {
        control[functions + cap.offset as usize].x = 1.0;
    }
    let one = TSpline::new(Arc::clone(space), control);
    let mut points = random_points(space.mesh().complex());
    points.extend(space.functions().iter().map(|f| Point::from(f.node)));
    points.extend(whole.surface.vertices());
    let values = one.evaluate(&points, Order::Value).positions;
    let off = values.iter().map(|p| (p.x - 1.0).abs());
    let largest = off.fold(0.0, f64::max);
    println!("{}: sums of functions are 1 within {largest:e}", whole.name);
    assert!(largest <= UNITY, "{}: {largest:e}", whole.name);
}

fn assert_laws(whole: &Whole) {
    assert_knot_intervals_agree(whole);
    assert_unity(whole);
    lines::assert_c2(whole);
}

#[test]
fn fits_of_generated_surfaces_obey_the_laws() {
    generated().iter().for_each(assert_laws);
}

#[test]
fn fits_of_models_obey_the_laws() {
    MODELS
        .into_iter()
        .filter_map(model)
        .for_each(|whole| assert_laws(&whole));
}
