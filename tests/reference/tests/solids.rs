//! Tetrahedra, the Laplacian of solids and crossings of surfaces against CGAL.

use msplines_common::mesh::tet::{
    CELL_EDGES, Orientation, TetMesh, dihedral_angles, orientation, signed_volume,
};
use msplines_common::mesh::{NONE, TriangleMesh, self_crossings, shapes};
use msplines_reference::record::Comparison;
use msplines_reference::solids::{
    Measured, cgal_delaunay, cgal_measured, cgal_orientations, cgal_self_intersections,
};
use msplines_reference::{Library, meshes};
use msplines_trivariate::domain::volume::{VolumeWeights, solid_laplacian};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Rounding of a dozen products against rational numbers.
const ROUNDING: f64 = 1e-14;
/// Sums over a mesh of some thousand tetrahedra, slivers among them.
const SUMS: f64 = 1e-12;

type Tetrahedron = [Point3<f64>; 4];

fn point(random: &mut Pcg64Mcg, size: f64) -> Point3<f64> {
    Point3::from(std::array::from_fn(|_| random.random_range(-size..size)))
}

/// Tetrahedra with their names: of random corners, and ever closer to flat.
fn tetrahedra() -> Vec<(String, Vec<Tetrahedron>)> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut all = vec![("random".to_owned(), of_random_corners(&mut random))];
    for exponent in [-3, -8, -13, -15, -16, -17] {
        let off = 10f64.powi(exponent);
        let name = format!("slivers of height {off:e}");
        all.push((name, slivers(&mut random, off)));
    }
    let far = |corners: &Tetrahedron| corners.map(|p| p + Vector3::new(1e8, -3e7, 5e6));
    let moved = slivers(&mut random, 1e-8).iter().map(far).collect();
    all.push(("slivers far from the origin".to_owned(), moved));
    all.push(("whole numbers".to_owned(), of_whole_numbers(&mut random)));
    all
}

fn of_random_corners(random: &mut Pcg64Mcg) -> Vec<Tetrahedron> {
    (0..2_000)
        .map(|_| std::array::from_fn(|_| point(random, 1.0)))
        .collect()
}

/// Four corners of a parallelogram, the fourth moved by up to `off`: both diagonals cross, so that all
/// six dihedral angles are near 0 or π.
fn slivers(random: &mut Pcg64Mcg, off: f64) -> Vec<Tetrahedron> {
    let sliver = |_| {
        let [a, b, c] = [0; 3].map(|_| point(random, 1.0));
        [a, b, b + (c - a) + point(random, off).coords, c]
    };
    (0..1_000).map(sliver).collect()
}

/// Corners on a small lattice, of which every tenth tetrahedron is flat.
fn of_whole_numbers(random: &mut Pcg64Mcg) -> Vec<Tetrahedron> {
    let corner = |random: &mut Pcg64Mcg| {
        Point3::from([0; 3].map(|_| f64::from(random.random_range(-2..=2_i32))))
    };
    (0..2_000)
        .map(|_| std::array::from_fn(|_| corner(random)))
        .collect()
}

#[test]
fn orientations_are_the_same() {
    let why = "both are exact";
    let mut comparison = Comparison::new("differing orientations", Library::Cgal, 0.0, why);
    let mut counts = [0; 3];
    for (name, tetrahedra) in tetrahedra() {
        // The last two are beyond where products of three coordinates overflow or underflow.
        for scale in [1.0, 1e-80, 1e80, 1e-150, 1e150] {
            let scaled = |corners: &Tetrahedron| corners.map(|p| p * scale);
            let scaled: Vec<Tetrahedron> = tetrahedra.iter().map(scaled).collect();
            let theirs = cgal_orientations(&scaled);
            let pairs = scaled.iter().map(orientation).zip(theirs);
            let differing = pairs.filter(|(ours, theirs)| {
                counts[*ours as usize] += 1;
                ours != theirs
            });
            comparison.add(&name, [differing.count() as f64]);
        }
    }
    comparison.finish();
    for kind in [
        Orientation::Negative,
        Orientation::Flat,
        Orientation::Positive,
    ] {
        assert!(counts[kind as usize] > 500, "{kind:?}: {counts:?}");
    }
}

#[test]
fn volumes_and_dihedral_angles_agree() {
    let why = "relative to the cube of the longest edge: CGAL is exact";
    let mut volumes = Comparison::new("volume of tetrahedra", Library::Cgal, ROUNDING, why);
    let why = "radians, relative to longest edge over least height above an edge";
    let mut angles = Comparison::new("dihedral angle", Library::Cgal, ROUNDING, why);
    for (name, tetrahedra) in tetrahedra() {
        for (corners, theirs) in tetrahedra.iter().zip(cgal_measured(&tetrahedra)) {
            let longest = lengths(corners).into_iter().fold(0.0, f64::max);
            let volume = signed_volume(corners);
            volumes.add(&name, [(volume - theirs.volume).abs() / longest.powi(3)]);
            angles.add(&name, angle_deviations(corners, &theirs));
        }
    }
    volumes.finish();
    angles.finish();
}

fn lengths(corners: &Tetrahedron) -> [f64; 6] {
    CELL_EDGES.map(|[a, b]| (corners[b] - corners[a]).norm())
}

/// Deviations at the edges whose angle is defined: with two corners that are not on its line.
fn angle_deviations(corners: &Tetrahedron, theirs: &Measured) -> Vec<f64> {
    let (ours, lengths) = (dihedral_angles(corners), lengths(corners));
    let longest = lengths.into_iter().fold(0.0, f64::max);
    let deviation = |edge: usize| {
        let [a, b] = CELL_EDGES[edge];
        let axis = corners[b] - corners[a];
        let heights = CELL_EDGES[5 - edge].map(|c| axis.cross(&(corners[c] - corners[a])).norm());
        let least = heights[0].min(heights[1]) / lengths[edge];
        let defined = lengths[edge] > 0.0 && least > 0.0;
        defined.then(|| (ours[edge] - theirs.dihedral_angles[edge]).abs() * least / longest)
    };
    (0..6).filter_map(deviation).collect()
}

/// Point sets with their names: even, in a flat box, dense in the middle, and around a hole.
fn point_sets() -> Vec<(String, Vec<Point3<f64>>)> {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    let mut points = |count: usize| -> Vec<Point3<f64>> {
        (0..count).map(|_| point(&mut random, 1.0)).collect()
    };
    let flat = |p: &Point3<f64>| Point3::new(p.x, 0.3 * p.y, 0.02 * p.z);
    let dense = |p: &Point3<f64>| Point3::from(p.coords * p.coords.norm_squared());
    let shell = |p: &Point3<f64>| Point3::from(p.coords.normalize() * (1.0 + 0.2 * p.x));
    let needle = |p: &Point3<f64>| Point3::new(20.0 * p.x, p.y, p.z) + Vector3::repeat(50.0);
    let bent = |p: &Point3<f64>| Point3::new(p.x, p.y, 0.4 * p.z + p.x * p.x);
    vec![
        ("even points".to_owned(), points(3_000)),
        (
            "flat box".to_owned(),
            points(1_000).iter().map(flat).collect(),
        ),
        (
            "dense middle".to_owned(),
            points(1_000).iter().map(dense).collect(),
        ),
        (
            "bumpy shell".to_owned(),
            points(1_000).iter().map(shell).collect(),
        ),
        (
            "needle far away".to_owned(),
            points(1_000).iter().map(needle).collect(),
        ),
        (
            "bent slab".to_owned(),
            points(1_000).iter().map(bent).collect(),
        ),
    ]
}

/// The Delaunay meshes of the point sets, with their names and the volumes of their hulls.
fn delaunay_meshes() -> Vec<(String, TetMesh, f64)> {
    let mesh = |(name, points): (String, Vec<Point3<f64>>)| {
        let found = cgal_delaunay(&points);
        let mesh = TetMesh::build(points, found.cells).expect("a solid without holes");
        let corners = mesh.topology().boundary_vertices().len();
        assert_eq!(corners, found.hull_vertices, "{name}");
        (name, mesh, found.hull_volume)
    };
    point_sets().into_iter().map(mesh).collect()
}

#[test]
fn delaunay_tetrahedra_fill_the_hull() {
    let mut volumes = Comparison::new("volume of hulls", Library::Cgal, SUMS, "relative");
    for (name, mesh, hull) in delaunay_meshes() {
        assert_eq!(mesh.not_positive(), Vec::<u32>::new(), "{name}");
        let volume: f64 = (0..mesh.cell_count() as u32)
            .map(|c| mesh.signed_volume(c))
            .sum();
        volumes.add(&name, [(volume - hull).abs() / hull]);
    }
    volumes.finish();
}

#[test]
fn harmonic_weights_are_lengths_times_cotangents() {
    let why = "relative to l / (6 sin² θ), by which a weight changes with its angle";
    let mut comparison = Comparison::new("harmonic weight", Library::Cgal, SUMS, why);
    for (name, mesh, _) in delaunay_meshes() {
        let cells: Vec<Tetrahedron> = (0..mesh.cell_count() as u32)
            .map(|c| mesh.tetrahedron(c))
            .collect();
        let edges = mesh.topology().edges();
        let (mut theirs, mut scales) = (vec![0.0; edges.len()], vec![0.0; edges.len()]);
        let measured = cgal_measured(&cells);
        for ((corners, found), own) in cells
            .iter()
            .zip(&measured)
            .zip(mesh.topology().cell_edges())
        {
            let lengths = lengths(corners);
            for (edge, &number) in own.iter().enumerate() {
                // The weight of an edge comes from the angle at the opposite one.
                let (length, angle) = (lengths[5 - edge], found.dihedral_angles[5 - edge]);
                theirs[number as usize] += length / angle.tan() / 6.0;
                scales[number as usize] += length / angle.sin().powi(2) / 6.0;
            }
        }
        let laplacian = solid_laplacian(&mesh, VolumeWeights::Linear);
        for ((&[a, b], theirs), scale) in edges.iter().zip(theirs).zip(scales) {
            let entry = laplacian.column(a as usize).find(|e| e.0 == b as usize);
            let ours = -entry.expect("an entry for each edge").1;
            comparison.add(&name, [(ours - theirs).abs() / scale]);
        }
    }
    comparison.finish();
}

#[test]
fn linear_functions_are_harmonic_on_delaunay_tetrahedra() {
    let why = "relative to the absolute sum of a row times the diagonal";
    let mut comparison = Comparison::new("linear precision", Library::Cgal, SUMS, why);
    for (name, mesh, _) in delaunay_meshes() {
        let inside: Vec<usize> = (0..mesh.vertex_count())
            .filter(|&v| mesh.topology().boundary_vertex(v as u32) == NONE)
            .collect();
        assert!(
            inside.len() > 100,
            "{name}: {} vertices inside",
            inside.len()
        );
        let residual = |weights| {
            let laplacian = solid_laplacian(&mesh, weights);
            let row = |&vertex: &usize| {
                let entries = || laplacian.column(vertex);
                let sum: Vector3<f64> = entries()
                    .map(|(v, entry)| mesh.positions()[v].coords * entry)
                    .sum();
                let size: f64 = entries().map(|(_, entry)| entry.abs()).sum();
                sum.norm() / (size * mesh.diagonal())
            };
            inside.iter().map(row).collect::<Vec<f64>>()
        };
        comparison.add(&name, residual(VolumeWeights::Linear));
        // The paper's own weights are far off, so that this test can fail.
        let literal = residual(VolumeWeights::Literal)
            .into_iter()
            .fold(0.0, f64::max);
        assert!(literal > 1e-6, "{name}: {literal:e}");
    }
    comparison.finish();
}

/// Surfaces that do not cross themselves, with their names.
fn clean() -> Vec<(String, TriangleMesh)> {
    let mut surfaces = meshes::generated();
    surfaces.push(("cube".to_owned(), shapes::cube(4)));
    for (seed, (name, mesh)) in meshes::generated().into_iter().enumerate() {
        let mesh = meshes::jittered(&mesh, 0.2, seed as u64);
        surfaces.push((format!("{name}, jittered"), mesh));
    }
    surfaces
}

/// Surfaces that cross themselves, in general position, with their names.
fn crossing() -> Vec<(String, TriangleMesh)> {
    let sphere = meshes::jittered(&shapes::bumpy_sphere(500), 0.2, 3);
    let mut pushed = sphere.positions().to_vec();
    pushed[0] = Point3::from(pushed[0].coords * -1.5);
    let mut random = Pcg64Mcg::seed_from_u64(4);
    let anywhere = |_: &Point3<f64>| point(&mut random, 1.0);
    let ball = shapes::sphere(60);
    let tangle = ball.positions().iter().map(anywhere).collect();
    let spindle = shapes::torus(0.6, 1.0, 900);
    let shift = Vector3::new(0.71, 0.32, -0.13);
    vec![
        (
            "vertex through the other side".to_owned(),
            sphere.with_positions(pushed),
        ),
        ("tangle".to_owned(), ball.with_positions(tangle)),
        (
            "spindle torus".to_owned(),
            meshes::jittered(&spindle, 0.2, 5),
        ),
        (
            "noise".to_owned(),
            meshes::jittered(&shapes::bumpy_sphere(1_000), 3.0, 6),
        ),
        ("two spheres".to_owned(), meshes::beside(&sphere, shift)),
    ]
}

/// Surfaces that touch themselves or lie on themselves, with their names.
fn touching() -> Vec<(String, TriangleMesh)> {
    let cube = shapes::cube(4);
    let shifted = |x, y, z| meshes::beside(&cube, Vector3::new(x, y, z));
    vec![
        ("cube upon cube".to_owned(), shifted(0.0, 0.0, 1.0)),
        ("cubes at an edge".to_owned(), shifted(1.0, 0.0, 1.0)),
        ("cube half in cube".to_owned(), shifted(0.5, 0.0, 0.0)),
        ("cube in cube askew".to_owned(), shifted(0.5, 0.375, 0.125)),
        ("twice the same cube".to_owned(), shifted(0.0, 0.0, 0.0)),
    ]
}

/// Whether two faces are in general position by CGAL's predicate: no corner in the plane of the other
/// face, no two edges in one plane, but for what they share.
fn general_position(mesh: &TriangleMesh, pair: [u32; 2]) -> bool {
    let [a, b] = pair.map(|face| mesh.faces()[face as usize]);
    let edges = |face: [u32; 3]| [0, 1, 2].map(|side| [face[side], face[(side + 1) % 3]]);
    let mut quadruples = Vec::new();
    for (face, other) in [(a, b), (b, a)] {
        let own = other.iter().filter(|v| !face.contains(v));
        quadruples.extend(own.map(|&v| [face[0], face[1], face[2], v]));
    }
    for first in edges(a) {
        let apart = edges(b)
            .into_iter()
            .filter(|e| !e.iter().any(|v| first.contains(v)));
        quadruples.extend(apart.map(|second| [first[0], first[1], second[0], second[1]]));
    }
    let corners: Vec<Tetrahedron> = quadruples
        .iter()
        .map(|q| q.map(|v| mesh.positions()[v as usize]))
        .collect();
    !cgal_orientations(&corners).contains(&Orientation::Flat)
}

#[test]
fn surfaces_that_do_not_cross_have_no_pairs() {
    let why = "there are none";
    let quantity = "self-intersections of embedded surfaces";
    let mut comparison = Comparison::new(quantity, Library::Cgal, 0.0, why);
    for (name, mesh) in clean() {
        assert_eq!(
            cgal_self_intersections(&mesh),
            Vec::<[u32; 2]>::new(),
            "{name}"
        );
        comparison.add(&name, [self_crossings(&mesh).len() as f64]);
    }
    comparison.finish();
}

#[test]
fn surfaces_that_cross_have_the_same_pairs() {
    let why = "both are exact, and no pair only touches";
    let mut comparison = Comparison::new("differing self-intersections", Library::Cgal, 0.0, why);
    for (name, mesh) in crossing() {
        let (ours, theirs) = (self_crossings(&mesh), cgal_self_intersections(&mesh));
        assert!(ours.len() > 2, "{name}: {}", ours.len());
        let alone = |a: &[[u32; 2]], b: &[[u32; 2]]| {
            a.iter()
                .filter(|pair| b.binary_search(pair).is_err())
                .count() as f64
        };
        comparison.add(&name, [alone(&ours, &theirs), alone(&theirs, &ours)]);
    }
    comparison.finish();
}

/// Touching counts for CGAL only.
#[test]
fn pairs_that_only_cgal_finds_touch() {
    let why = "pairs of ours alone, and of CGAL's alone in general position";
    let quantity = "self-intersections of touching surfaces";
    let mut comparison = Comparison::new(quantity, Library::Cgal, 0.0, why);
    for (name, mesh) in touching() {
        let (ours, theirs) = (self_crossings(&mesh), cgal_self_intersections(&mesh));
        assert!(!theirs.is_empty(), "{name}");
        let missed = ours.iter().filter(|p| theirs.binary_search(p).is_err());
        let extra = theirs.iter().filter(|p| ours.binary_search(p).is_err());
        let extra = extra.filter(|&&pair| general_position(&mesh, pair));
        comparison.add(&name, [missed.count() as f64, extra.count() as f64]);
    }
    comparison.finish();
}
