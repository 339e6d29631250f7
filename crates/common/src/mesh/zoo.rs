//! Small surfaces asked for by property, for tests.

use super::shapes;
use super::triangle::TriangleMesh;

/// Returns a closed surface without symmetry: 642 vertices, genus 0.
#[must_use]
pub fn closed() -> TriangleMesh {
    shapes::bumpy_sphere(642)
}

/// Returns a surface with one boundary loop: 441 vertices, a disk.
#[must_use]
pub fn with_boundary() -> TriangleMesh {
    shapes::height_field(441)
}

/// Returns a surface with two boundary loops: an open cylinder of about 300 vertices.
#[must_use]
pub fn with_two_boundaries() -> TriangleMesh {
    shapes::cylinder(300)
}

/// Returns a knotted surface of genus 1 with about 900 vertices.
#[must_use]
pub fn knotted() -> TriangleMesh {
    shapes::torus_knot(2, 3, 900)
}

/// Returns a closed surface with this many handles and 300 vertices for each.
///
/// # Panics
/// If there are no handles or more than 64.
#[must_use]
pub fn genus(handles: u32) -> TriangleMesh {
    shapes::genus(handles, 300 * handles as usize)
}

/// Returns one surface of each kind: closed, with one and two boundary loops, knotted, genus 2.
#[must_use]
pub fn all() -> Vec<TriangleMesh> {
    vec![
        closed(),
        with_boundary(),
        with_two_boundaries(),
        knotted(),
        genus(2),
    ]
}
