//! Shells in STEP files against OpenCASCADE.

mod shells;
mod t_splines;

use msplines_common::bspline::{BezierShell, bernstein};
use msplines_io::write_step;
use msplines_reference::Library;
use msplines_reference::draw::{self, Shape};
use msplines_reference::record::Comparison;
use nalgebra::{Point3, Vector3};

use shells::Patch;

type Failure = Box<dyn std::error::Error>;

/// What OpenCASCADE is asked for, of an area or a volume.
const ACCURACY: f64 = 1e-12;
/// Its adaptive quadrature stops early on rational patches: what it says falls short of what it was
/// asked for by powers of ten, and comes closer the more it is asked for.
const QUADRATURE: f64 = 1e-9;
/// OpenCASCADE's least tolerance is 1e-7, and it takes a little more where it has measured; edges
/// that do not lie on their patches get the distance.
const TOLERANCE: f64 = 2e-7;
/// Points of a Gauss rule in each direction: exact for volumes of bicubic patches from 5 on.
const NODES: usize = 24;

/// Returns points and weights of the Gauss rule on `[0, 1]`.
fn gauss() -> Vec<[f64; 2]> {
    let n = NODES as f64;
    let rule = (0..NODES).map(|k| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for j in 2..=NODES {
                let j = j as f64;
                (before, value) = (
                    value,
                    ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j,
                );
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [(1.0 + x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)]
    });
    rule.collect()
}

/// Returns the values of the Bernstein polynomials of a degree at `x`, and their derivatives.
fn polynomials(degree: usize, x: f64) -> [Vec<f64>; 2] {
    let (mut values, mut lower) = (vec![0.0; degree + 1], vec![0.0; degree]);
    bernstein::values(x, &mut values);
    bernstein::values(x, &mut lower);
    let at = |i: usize| lower.get(i).copied().unwrap_or(0.0);
    let slopes = (0..=degree).map(|i| {
        let before = i.checked_sub(1).map_or(0.0, at);
        degree as f64 * (before - at(i))
    });
    [values, slopes.collect()]
}

/// Returns a point of a patch and `du × dv` there.
fn normal(patch: &Patch, [u, v]: [f64; 2]) -> (Point3<f64>, Vector3<f64>) {
    let [a, b] = patch.degree;
    let (first, second) = (polynomials(a, u), polynomials(b, v));
    let sum = |du: usize, dv: usize| {
        let terms = (0..patch.points.len()).map(|at| {
            let share = first[du][at % (a + 1)] * second[dv][at / (a + 1)];
            let weight = patch.weights.as_ref().map_or(1.0, |weights| weights[at]);
            patch.points[at].coords.push(1.0) * (weight * share)
        });
        terms.sum::<nalgebra::Vector4<f64>>()
    };
    let point = sum(0, 0);
    let place = point.xyz() / point.w;
    let [du, dv] = [sum(1, 0), sum(0, 1)].map(|d| (d.xyz() - place * d.w) / point.w);
    (place.into(), du.cross(&dv))
}

/// Returns the area of patches and the volume inside of them if they are closed.
fn measures(patches: &[Patch]) -> [f64; 2] {
    let rule = gauss();
    let (mut area, mut volume) = (0.0, 0.0);
    for patch in patches {
        for [u, first] in &rule {
            for [v, second] in &rule {
                let (place, normal) = normal(patch, [*u, *v]);
                area += first * second * normal.norm();
                volume += first * second * place.coords.dot(&normal) / 3.0;
            }
        }
    }
    [area, volume]
}

fn read(shell: &BezierShell) -> Result<Shape, Failure> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("shell.step");
    write_step(&path, shell)?;
    Ok(draw::read_step(&path, ACCURACY)?)
}

/// A case: its name, patches and what is known of it.
struct Case {
    name: &'static str,
    patches: Vec<Patch>,
    /// Loops of edges that only one face has.
    free_bounds: usize,
    /// Sides that are points: OpenCASCADE gives each of them an edge.
    points: usize,
}

fn cases() -> Vec<Case> {
    let case = |name, patches, free_bounds, points| Case {
        name,
        patches,
        free_bounds,
        points,
    };
    vec![
        case("torus", shells::torus(), 0, 0),
        case("torus with T-junctions", shells::split_torus(), 0, 0),
        case("a leaning torus", shells::leaning(shells::torus()), 0, 0),
        case(
            "a leaning torus with T-junctions",
            shells::leaning(shells::split_torus()),
            0,
            0,
        ),
        case("octants of a sphere", shells::octants(), 0, 8),
        case(
            "an octant of a sphere",
            shells::octants()[..1].to_vec(),
            1,
            1,
        ),
        case("one patch beside two", shells::one_beside_two(), 1, 0),
        case("part of a torus", shells::torus()[..6].to_vec(), 2, 0),
    ]
}

#[test]
fn shells_are_valid_and_have_the_area_and_volume_of_their_patches() -> Result<(), Failure> {
    let why = "relative; OpenCASCADE's quadrature stops early on rational patches";
    let mut areas = Comparison::new("STEP area", Library::OpenCascade, QUADRATURE, why);
    let mut volumes = Comparison::new("STEP volume", Library::OpenCascade, QUADRATURE, why);
    for case in cases() {
        let name = case.name;
        let shell = shells::sew(&case.patches)?;
        let shape = read(&shell)?;
        let said = &shape.said;
        assert!(shape.is_valid, "{name}: {said}");
        assert_eq!(shape.free_bounds, case.free_bounds, "{name}: {said}");
        assert!(shape.tolerance <= TOLERANCE, "{name}: {said}");
        let is_closed = case.free_bounds == 0;
        let expected = [
            ("VERTEX", shell.vertices().len()),
            ("EDGE", shell.edges().len() + case.points),
            ("FACE", case.patches.len()),
            ("SHELL", 1),
            ("SOLID", usize::from(is_closed)),
        ];
        for (part, count) in expected {
            assert_eq!(
                shape.counts.get(part),
                Some(&count),
                "{name}: {part}\n{said}"
            );
        }
        let [area, volume] = measures(&case.patches);
        areas.add(name, [(shape.area / area - 1.0).abs()]);
        if is_closed {
            assert!(volume > 0.0, "{name}");
            volumes.add(name, [(shape.volume / volume - 1.0).abs()]);
        }
    }
    areas.finish();
    volumes.finish();
    Ok(())
}

/// The quadrature against what is known.
#[test]
fn octants_have_the_area_and_volume_of_the_sphere() {
    let [area, volume] = measures(&shells::octants());
    let sphere = 4.0 * std::f64::consts::PI;
    assert!((area / sphere - 1.0).abs() < 1e-12, "{area}");
    assert!((volume / (sphere / 3.0) - 1.0).abs() < 1e-12, "{volume}");
    let [whole, split] = [shells::torus(), shells::split_torus()].map(|p| measures(&p));
    assert!((whole[1] / split[1] - 1.0).abs() < 1e-12);
}

/// The checks above can fail.
#[test]
fn a_gap_between_an_edge_and_its_patch_is_seen() -> Result<(), Failure> {
    const GAP: f64 = 1e-3;
    let shell = shells::sew(&shells::torus())?;
    let mut faces = shell.faces().to_vec();
    // Inner points of side 0, whose ends stay where they are.
    for at in [1, 2] {
        faces[0].points[at].z += GAP;
    }
    let (vertices, edges) = (shell.vertices().to_vec(), shell.edges().to_vec());
    let shape = read(&BezierShell::build(
        vertices,
        edges,
        faces,
        shell.tolerance(),
    )?)?;
    assert!(
        !shape.is_valid || shape.tolerance > TOLERANCE,
        "{}",
        shape.said
    );
    Ok(())
}
