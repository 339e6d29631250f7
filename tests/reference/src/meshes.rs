//! The meshes on which both sides are compared.

use std::collections::BTreeSet;
use std::env;
use std::path::{Path, PathBuf};

use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::{Policy, TriangleMesh, accept, shapes};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Models of the library that are compared when it is there: small, one of them open.
const MODELS: [&str; 4] = [
    "bunny_500.ply",
    "eight_g2.ply",
    "mushroom_open.ply",
    "femur_g2.ply",
];

/// Returns the generated meshes with their names: closed and open, of genus 0 to 3.
#[must_use]
pub fn generated() -> Vec<(String, TriangleMesh)> {
    let named = |name: &str, mesh| (name.to_owned(), mesh);
    vec![
        named("bumpy sphere", shapes::bumpy_sphere(2_000)),
        named("torus", shapes::torus(1.0, 0.35, 1_500)),
        named("torus knot", shapes::torus_knot(2, 3, 3_000)),
        named("cylinder", shapes::cylinder(1_200)),
        named("height field", shapes::height_field(1_000)),
        named("genus 3", shapes::genus(3, 2_000)),
    ]
}

/// Returns the generated meshes, a jittered copy of each, and the models that are there.
#[must_use]
pub fn all() -> Vec<(String, TriangleMesh)> {
    let mut meshes = generated();
    for (seed, (name, mesh)) in generated().into_iter().enumerate() {
        meshes.push((
            format!("{name}, jittered"),
            jittered(&mesh, 0.2, seed as u64),
        ));
    }
    meshes.extend(models());
    meshes
}

/// Returns the models that are there, and says which are not.
#[must_use]
pub fn models() -> Vec<(String, TriangleMesh)> {
    let found = MODELS
        .iter()
        .filter_map(|&name| Some((name.to_owned(), model(name)?)));
    found.collect()
}

/// Returns a model if it is there, and says if it is not.
#[must_use]
pub fn model(name: &str) -> Option<TriangleMesh> {
    let folder = env::var_os("MSPLINES_MODELS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/models"),
        PathBuf::from,
    );
    // A relative folder is meant from the project's root, where the tests are started.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let found = read(&root.join(&folder).join(name));
    if found.is_none() {
        println!("not run: {name}");
    }
    found
}

fn read(path: &Path) -> Option<TriangleMesh> {
    let soup = msplines_io::read_soup(path).ok()?;
    Some(accept(&soup, Policy::Refuse).ok()?.mesh)
}

/// Returns the mesh with every vertex moved by up to `share` of its shortest edge, so that no two
/// angles are equal.
#[must_use]
pub fn jittered(mesh: &TriangleMesh, share: f64, seed: u64) -> TriangleMesh {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let old = mesh.positions();
    let moved = (0..mesh.vertex_count() as u32).map(|vertex| {
        let here = old[vertex as usize];
        let lengths = mesh
            .topology()
            .neighbours(vertex)
            .map(|v| (old[v as usize] - here).norm());
        let step = share * lengths.fold(f64::INFINITY, f64::min);
        let direction = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
        here + step / 3.0_f64.sqrt() * direction
    });
    let moved: Vec<Point3<f64>> = moved.collect();
    mesh.with_positions(moved)
}

/// Returns a surface and a copy of it at another place, as one mesh.
///
/// # Panics
/// Never: both are manifolds.
#[must_use]
pub fn beside(mesh: &TriangleMesh, shift: Vector3<f64>) -> TriangleMesh {
    let count = mesh.vertex_count() as u32;
    let copy = mesh.positions().iter().map(|p| p + shift);
    let positions = mesh.positions().iter().copied().chain(copy).collect();
    let copy = mesh.faces().iter().map(|face| face.map(|v| v + count));
    let faces = mesh.faces().iter().copied().chain(copy).collect();
    TriangleMesh::build(positions, faces).expect("two surfaces")
}

/// Returns what is left of a mesh without the faces around random vertices, if that is a manifold.
#[must_use]
pub fn holed(mesh: &TriangleMesh, holes: usize, seed: u64) -> Option<TriangleMesh> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let count = mesh.vertex_count() as u32;
    let gone: BTreeSet<u32> = (0..holes).map(|_| random.random_range(0..count)).collect();
    let left = mesh.faces().iter();
    let left: Vec<[u32; 3]> = left
        .filter(|face| !face.iter().any(|v| gone.contains(v)))
        .copied()
        .collect();
    let (used, faces) = compact(&left);
    let positions = used.iter().map(|&v| mesh.positions()[v as usize]);
    TriangleMesh::build(positions.collect(), faces).ok()
}

/// Returns random triangles on so many vertices, at least three: anything but a mesh.
#[must_use]
pub fn random_triangles(vertices: u32, random: &mut Pcg64Mcg) -> Vec<[u32; 3]> {
    let count = random.random_range(2..=2 * vertices);
    let triangle = |_| {
        let first = random.random_range(0..vertices);
        let second = (first + random.random_range(1..vertices)) % vertices;
        let others: Vec<u32> = (0..vertices)
            .filter(|&v| v != first && v != second)
            .collect();
        [first, second, others[random.random_range(0..others.len())]]
    };
    (0..count).map(triangle).collect()
}

/// Returns the vertices that are used, and the faces with numbers in their order.
#[must_use]
pub fn compact(faces: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let used: BTreeSet<u32> = faces.as_flattened().iter().copied().collect();
    let used: Vec<u32> = used.into_iter().collect();
    let number = |v: u32| used.partition_point(|&other| other < v) as u32;
    let faces = faces.iter().map(|face| face.map(number)).collect();
    (used, faces)
}

/// Returns generated control meshes with their names: of quads, triangles and other polygons, closed
/// and open, no two edges of equal length.
///
/// # Panics
/// Never: the polygons are manifolds.
#[must_use]
pub fn control() -> Vec<(String, PolygonMesh)> {
    let mut meshes = vec![
        ("box".to_owned(), shapes::box_surface([1, 2, 3])),
        ("slab".to_owned(), shapes::slab_with_holes(2)),
        ("patch".to_owned(), shapes::quad_patch(5)),
        ("tetrahedron".to_owned(), tetrahedron()),
    ];
    for valence in [3, 5, 6, 9, 12] {
        let mesh = shapes::trapezohedron(valence);
        meshes.push((format!("trapezohedron of valence {valence}"), mesh));
    }
    for (name, lids) in [("prism", 2), ("open prism", 1)] {
        meshes.push((name.to_owned(), prism(5, lids)));
    }
    let jittered = meshes.into_iter().zip(0..).map(|((name, mesh), seed)| {
        let mesh = shapes::jittered(&mesh, 0.12, seed);
        (name, mesh)
    });
    jittered.collect()
}

fn tetrahedron() -> PolygonMesh {
    let positions = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]].map(|p| p.map(f64::from).into());
    let corners = vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];
    PolygonMesh::build(positions.to_vec(), corners, vec![0, 3, 6, 9, 12]).expect("a manifold")
}

/// Returns a prism over a polygon with so many of its two lids, its sides cut in two: quads and
/// triangles in turn.
fn prism(sides: u32, lids: usize) -> PolygonMesh {
    let place = |v: u32| {
        let angle = std::f64::consts::TAU * f64::from(v % sides) / f64::from(sides);
        Point3::new(angle.cos(), angle.sin(), f64::from(v / sides))
    };
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for i in 0..sides {
        let next = (i + 1) % sides;
        if i % 2 == 0 {
            faces.push(vec![i, next, sides + next, sides + i]);
        } else {
            faces.push(vec![i, next, sides + next]);
            faces.push(vec![i, sides + next, sides + i]);
        }
    }
    let both = [(0..sides).rev().collect(), (sides..2 * sides).collect()];
    faces.extend(both.into_iter().take(lids));
    let mut offsets = vec![0];
    for face in &faces {
        offsets.push(offsets[offsets.len() - 1] + face.len() as u32);
    }
    let positions = (0..2 * sides).map(place).collect();
    PolygonMesh::build(positions, faces.concat(), offsets).expect("a manifold")
}
