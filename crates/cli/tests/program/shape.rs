//! Meshes and networks without symmetry, moved and renumbered.

use std::fmt::Write;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::shapes::{self, Opening};

/// A mesh or a network before it is a file.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) points: Vec<Point3<f64>>,
    /// Corners of faces, or points along curves.
    pub(crate) cells: Vec<Vec<u32>>,
    is_network: bool,
}

impl Shape {
    /// Returns a closed surface of genus 0.
    pub(crate) fn ball() -> Self {
        Self::bent(&shapes::sphere(400))
    }

    /// Returns a torus.
    pub(crate) fn ring() -> Self {
        Self::bent(&shapes::torus(1.0, 0.4, 340))
    }

    /// Returns a closed mesh of quads with corners.
    pub(crate) fn quads() -> Self {
        let mesh = shapes::box_surface([1, 2, 2]);
        let faces = mesh.topology().faces();
        Self {
            points: mesh.positions().iter().map(bend).collect(),
            cells: faces.map(|face| face.to_vec()).collect(),
            is_network: false,
        }
    }

    /// Returns a network of curves.
    pub(crate) fn curves() -> Self {
        let network = shapes::mushroom_network(6, Opening::Closed).network;
        let curves = network.curves().iter();
        Self {
            points: network.points().iter().map(bend).collect(),
            cells: curves.map(|curve| curve.points.clone()).collect(),
            is_network: true,
        }
    }

    fn bent(mesh: &TriangleMesh) -> Self {
        Self {
            points: mesh.positions().iter().map(bend).collect(),
            cells: mesh.faces().iter().map(|face| face.to_vec()).collect(),
            is_network: false,
        }
    }

    /// Returns the shape with all points mapped.
    pub(crate) fn mapped(&self, map: impl Fn(&Point3<f64>) -> Point3<f64>) -> Self {
        Self {
            points: self.points.iter().map(map).collect(),
            ..self.clone()
        }
    }

    /// Returns the shape with its points in another order, and which of the new ones each was.
    pub(crate) fn renumbered(&self) -> (Self, Vec<u32>) {
        let places = shuffled(self.points.len());
        let mut points = self.points.clone();
        for (point, &place) in self.points.iter().zip(&places) {
            points[place as usize] = *point;
        }
        let renamed = |cell: &Vec<u32>| cell.iter().map(|&v| places[v as usize]).collect();
        let shape = Self {
            points,
            cells: self.cells.iter().map(renamed).collect(),
            ..self.clone()
        };
        (shape, places)
    }

    /// Returns the shape with its faces in another order and each starting at another corner.
    pub(crate) fn reordered(&self) -> Self {
        let mut cells = self.cells.clone();
        for (index, place) in shuffled(self.cells.len()).into_iter().enumerate() {
            let mut cell = self.cells[index].clone();
            if !self.is_network {
                let first = index % cell.len();
                cell.rotate_left(first);
            }
            cells[place as usize] = cell;
        }
        Self {
            cells,
            ..self.clone()
        }
    }

    /// Returns the text of an OBJ file, with numbers that read back exactly.
    pub(crate) fn obj(&self) -> String {
        let mut text = String::new();
        for p in &self.points {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        let kind = if self.is_network { 'l' } else { 'f' };
        for cell in &self.cells {
            let corners: Vec<String> = cell.iter().map(|v| (v + 1).to_string()).collect();
            let _ = writeln!(text, "{kind} {}", corners.join(" "));
        }
        text
    }

    /// Returns the diagonal of the bounding box.
    pub(crate) fn diagonal(&self) -> f64 {
        let start = (self.points[0], self.points[0]);
        let (low, high) = self
            .points
            .iter()
            .fold(start, |(low, high), p| (low.inf(p), high.sup(p)));
        (high - low).norm()
    }
}

/// Takes every symmetry of a shape, so that nothing is chosen between equals.
fn bend(p: &Point3<f64>) -> Point3<f64> {
    let [x, y, z] = [p.x, p.y, p.z];
    Point3::new(
        x + 0.11 * (1.3 * y + 0.4).sin() + 0.05 * z * z,
        y + 0.09 * (1.7 * z + 1.1).sin() + 0.06 * x * z,
        1.07 * z + 0.08 * (2.1 * x + 0.3).sin() + 0.04 * y,
    )
}

/// Returns the numbers below `count` in an order without a pattern, always the same.
fn shuffled(count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    // Steps of a multiplicative hash spread neighbours over the whole range.
    order.sort_by_key(|&v| v.wrapping_add(1).wrapping_mul(0x9E37_79B1));
    order
}
