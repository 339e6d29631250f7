//! Laws of charts, pursuits and fits.

mod charts;
mod fits;
mod locals;
mod pursuits;
mod sessions;

use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes::{
    box_surface, jittered, quad_patch, slab_with_holes, trapezohedron,
};
use msplines_common::progress::unobserved;

use crate::{Fit, Options, fit};

/// Returns quad meshes of genus 0 to 2, with poles of valence 3 to 10, and with a boundary.
fn meshes() -> Vec<PolygonMesh> {
    let poles = [3, 5, 6, 10].map(trapezohedron);
    let others = [box_surface([1, 2, 3]), slab_with_holes(2), quad_patch(3)];
    let all = poles.into_iter().chain(others).enumerate();
    all.map(|(seed, mesh)| jittered(&mesh, 0.12, seed as u64))
        .collect()
}

/// Returns the box of 24 vertices, its vertices moved a little.
fn box_24() -> PolygonMesh {
    jittered(&box_surface([1, 2, 3]), 0.12, 3)
}

fn smooth(mesh: &PolygonMesh) -> Sharpness {
    Sharpness::smooth(mesh.topology(), Rules::default())
}

/// Returns the sharpness of a mesh with a crease around the end of the box.
pub(crate) fn creased(mesh: &PolygonMesh) -> Sharpness {
    let topology = mesh.topology();
    let mut sharpness = smooth(mesh);
    let plain = box_surface([1, 2, 3]);
    let z = |v: u32| plain.positions()[v as usize].z;
    let whole = |face: u32| topology.face_vertices(face).iter().all(|&v| z(v) == 3.0);
    for edge in 0..topology.edge_count() as u32 {
        let h = topology.edge_half_edge(edge);
        if whole(topology.face(h)) != whole(topology.face(topology.twin(h))) {
            sharpness.set_edge(edge, f64::INFINITY);
        }
    }
    sharpness
}

fn fitted(mesh: &PolygonMesh, sharpness: &Sharpness, options: &Options) -> Fit {
    fit(
        mesh,
        sharpness,
        Rules::default(),
        options,
        &mut unobserved(),
    )
    .expect("a fit")
}
