//! Control meshes: quads around boxes and voxels, and around poles of any valence.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::mesh::polygon::PolygonMesh;
use crate::mesh::topology::TopologyError;

/// Returns the surface of a set of unit cubes, each named by its smallest corner.
///
/// # Errors
/// Cubes that touch along an edge or at a corner only: their surface is no manifold.
pub fn voxels(cubes: &BTreeSet<[i32; 3]>) -> Result<PolygonMesh, TopologyError> {
    let mut ids = BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for cube in cubes {
        for axis in 0..3 {
            for up in [false, true] {
                let mut neighbour = *cube;
                neighbour[axis] += if up { 1 } else { -1 };
                if cubes.contains(&neighbour) {
                    continue;
                }
                let mut corner = *cube;
                corner[axis] += i32::from(up);
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut around = [[0, 0], [1, 0], [1, 1], [0, 1]];
                if !up {
                    around.reverse();
                }
                faces.push(around.map(|[a, b]| {
                    let mut place = corner;
                    place[u] += a;
                    place[v] += b;
                    *ids.entry(place).or_insert_with(|| {
                        positions.push(Point3::from(place.map(f64::from)));
                        positions.len() as u32 - 1
                    })
                }));
            }
        }
    }
    PolygonMesh::from_quads(positions, &faces)
}

/// Returns the surface of a box of `size` unit cubes.
///
/// # Panics
/// If a size is zero.
#[must_use]
pub fn box_surface(size: [u32; 3]) -> PolygonMesh {
    assert!(size.iter().all(|&n| n > 0), "a box has cubes");
    voxels(&box_cubes(size)).expect("a box is a manifold")
}

fn box_cubes([x, y, z]: [u32; 3]) -> BTreeSet<[i32; 3]> {
    let cubes = (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k])));
    cubes.map(|cube| cube.map(|n| n as i32)).collect()
}

/// Returns the surface of a slab of `2 handles + 1` by 3 cubes with `handles` holes through it.
///
/// # Panics
/// If there are more than a million handles.
#[must_use]
pub fn slab_with_holes(handles: u32) -> PolygonMesh {
    assert!(handles <= 1_000_000, "at most a million handles");
    let mut cubes = box_cubes([2 * handles + 1, 3, 1]);
    for handle in 0..handles as i32 {
        cubes.remove(&[2 * handle + 1, 1, 0]);
    }
    voxels(&cubes).expect("holes one apart leave a manifold")
}

/// Returns the trapezohedron of `2 n` quads around two poles of valence `n`; all other vertices have
/// valence 3.
///
/// # Panics
/// If `n` is less than 3.
#[must_use]
pub fn trapezohedron(n: u32) -> PolygonMesh {
    assert!(n >= 3, "a pole has at least three quads");
    let mut positions = vec![Point3::new(0.0, 0.0, 1.0), Point3::new(0.0, 0.0, -1.0)];
    for i in 0..2 * n {
        let angle = TAU * f64::from(i) / f64::from(2 * n);
        let height = if i % 2 == 0 { 0.3 } else { -0.3 };
        positions.push(Point3::new(angle.cos(), angle.sin(), height));
    }
    let rim = |i: u32| 2 + i % (2 * n);
    let faces: Vec<[u32; 4]> = (0..n)
        .flat_map(|i| {
            let i = 2 * i;
            [
                [0, rim(i), rim(i + 1), rim(i + 2)],
                [1, rim(i + 3), rim(i + 2), rim(i + 1)],
            ]
        })
        .collect();
    PolygonMesh::from_quads(positions, &faces).expect("a trapezohedron is a manifold")
}

/// Returns an open square of `size` by `size` unit quads, slightly bent.
///
/// # Panics
/// If `size` is zero.
#[must_use]
pub fn quad_patch(size: u32) -> PolygonMesh {
    assert!(size > 0, "a patch has quads");
    let row = size + 1;
    let place = |i: u32| {
        let (x, y) = (f64::from(i % row), f64::from(i / row));
        Point3::new(x, y, 0.3 * (0.9 * x).sin() * (1.1 * y).cos())
    };
    let quad = |f: u32| {
        let corner = f / size * row + f % size;
        [corner, corner + 1, corner + row + 1, corner + row]
    };
    let faces: Vec<[u32; 4]> = (0..size * size).map(quad).collect();
    PolygonMesh::from_quads((0..row * row).map(place).collect(), &faces)
        .expect("a patch is a manifold")
}

/// Returns the mesh with every vertex moved by up to `amount` along each axis.
#[must_use]
pub fn jittered(mesh: &PolygonMesh, amount: f64, seed: u64) -> PolygonMesh {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut shift = || amount * (2.0 * random.random::<f64>() - 1.0);
    let positions = mesh
        .positions()
        .iter()
        .map(|p| p + Vector3::new(shift(), shift(), shift()))
        .collect();
    mesh.with_positions(positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_the_vertices_and_faces_of_their_size() {
        for size in [[1, 2, 3], [2, 2, 8], [10, 10, 15]] {
            let [x, y, z] = size.map(|n| n as usize);
            let half = x * y + y * z + z * x;
            let mesh = box_surface(size);
            assert_eq!(
                (mesh.face_count(), mesh.vertex_count()),
                (2 * half, 2 * half + 2)
            );
            assert!(mesh.check_quads().is_ok());
        }
    }

    #[test]
    fn slabs_have_as_many_handles_as_holes() {
        for handles in 0..4 {
            let chi = slab_with_holes(handles).topology().euler_characteristic();
            assert_eq!(chi, 2 - 2 * i64::from(handles));
        }
    }

    #[test]
    fn cubes_that_share_an_edge_only_are_refused() {
        let cubes = BTreeSet::from([[0, 0, 0], [1, 1, 0]]);
        assert!(voxels(&cubes).is_err());
    }

    #[test]
    fn poles_have_the_valence_asked_for() {
        for n in [3, 5, 12] {
            let mesh = trapezohedron(n);
            assert_eq!(mesh.topology().valence(0), n as usize);
            assert_eq!(mesh.topology().valence(1), n as usize);
            assert_eq!(mesh.topology().euler_characteristic(), 2);
            let volume: f64 = mesh
                .topology()
                .faces()
                .map(|f| {
                    let p = |i: usize| mesh.positions()[f[i] as usize].coords;
                    p(0).dot(&p(1).cross(&p(2))) + p(0).dot(&p(2).cross(&p(3)))
                })
                .sum();
            assert!(volume > 0.0, "normals point outwards");
        }
    }
}
