//! Surfaces made from formulas, for demonstrations, experiments and tests.
//!
//! Each is asked for by its number of vertices and has nearly as many; the same arguments always
//! give the same mesh. Closed surfaces have their normals outwards.

mod control;
mod cut;
mod grid;
mod implicit;
mod networks;
mod round;
mod sharp;
mod sketches;
mod solids;

pub use control::{box_surface, jittered, quad_patch, slab_with_holes, trapezohedron, voxels};
pub use cut::{bowl, holed_torus, pants};
pub use grid::{cylinder, height_field, torus, torus_knot, vase};
pub use implicit::genus;
pub use networks::{KnownNetwork, limit_network};
pub use round::{bumpy_sphere, sphere};
pub use sharp::{cube, nut};
pub use sketches::{Opening, dome_network, mushroom_network};
pub use solids::box_solid;

use nalgebra::Point3;

use super::triangle::TriangleMesh;

fn build(positions: Vec<Point3<f64>>, faces: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh::build(positions, faces).expect("generated faces form an oriented manifold")
}
