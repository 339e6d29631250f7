//! The boundary of a solid as triangles, and as places of the cube.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::domain::cube::face_axes;
use rayon::prelude::*;

use crate::error::RunError;
use crate::run::steps::tessellation;

/// The surface of the cube, cut into squares of two triangles each; the six faces share the vertices of
/// their edges.
pub(super) struct CubeSurface {
    /// Squares along an edge of the cube.
    cells: usize,
}

impl CubeSurface {
    pub(super) fn new(cells: usize) -> Self {
        Self { cells }
    }

    /// Places on the lattice, in the order of the vertices.
    fn places(&self) -> impl Iterator<Item = [usize; 3]> {
        let n = self.cells;
        let layer = move |k: usize| {
            let line = move |j: usize| {
                // Inside of the cube there are only the two ends of a line.
                let step = if k.is_multiple_of(n) || j.is_multiple_of(n) {
                    1
                } else {
                    n
                };
                (0..=n).step_by(step).map(move |i| [i, j, k])
            };
            (0..=n).flat_map(line)
        };
        (0..=n).flat_map(layer)
    }

    /// The parameter of every vertex.
    pub(super) fn parameters(&self) -> Vec<[f64; 3]> {
        let n = self.cells as f64;
        self.places().map(|at| at.map(|i| i as f64 / n)).collect()
    }

    /// The vertex at a place of the lattice that is on the surface.
    fn vertex(&self, [i, j, k]: [usize; 3]) -> u32 {
        let n = self.cells;
        let (whole, ring) = ((n + 1) * (n + 1), 4 * n);
        let on_ring = match j {
            0 => i,
            _ if j == n => n + 1 + 2 * (n - 1) + i,
            _ => n + 1 + 2 * (j - 1) + usize::from(i == n),
        };
        let at = match k {
            0 => i + (n + 1) * j,
            _ if k == n => whole + (n - 1) * ring + i + (n + 1) * j,
            _ => whole + (k - 1) * ring + on_ring,
        };
        at as u32
    }

    /// The vertex at a place of a face, in steps along its two axes.
    fn on_face(&self, face: usize, at: [usize; 2]) -> u32 {
        let mut place = [0; 3];
        place[face / 2] = if face % 2 == 1 { self.cells } else { 0 };
        let axes = face_axes(face);
        place[axes[0]] = at[0];
        place[axes[1]] = at[1];
        self.vertex(place)
    }

    /// Triangles, counter-clockwise from outside.
    fn triangles(&self) -> Vec<[u32; 3]> {
        let n = self.cells;
        let mut triangles = Vec::with_capacity(12 * n * n);
        for face in 0..6 {
            for square in 0..n * n {
                let [a, b] = [square % n, square / n];
                let corner = |[p, q]: [usize; 2]| self.on_face(face, [a + p, b + q]);
                let [p, q, r, s] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(corner);
                triangles.extend([[p, q, r], [p, r, s]]);
            }
        }
        triangles
    }

    /// Pieces of the lines along which parameters are multiples of `1 / spans`, and of the edges of the
    /// cube, as pairs of vertices.
    pub(super) fn lines(&self, spans: usize) -> [Vec<[u32; 2]>; 2] {
        let (n, step) = (self.cells, self.cells / spans.max(1));
        let (mut lines, mut edges) = (Vec::new(), Vec::new());
        for face in 0..6 {
            for at in (0..=n).step_by(step.max(1)) {
                for along in 0..n {
                    let pieces = [
                        [[at, along], [at, along + 1]],
                        [[along, at], [along + 1, at]],
                    ];
                    let pieces = pieces.map(|ends| ends.map(|end| self.on_face(face, end)));
                    if at.is_multiple_of(n) {
                        // Two faces share an edge of the cube.
                        edges.extend(pieces.map(|[a, b]| [a.min(b), a.max(b)]));
                    } else {
                        lines.extend(pieces);
                    }
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        [lines, edges]
    }

    /// The surface of a solid.
    pub(super) fn of(&self, spline: &TrivariateSpline) -> Result<TriangleMesh, RunError> {
        let positions = positions(spline, &self.parameters());
        tessellation(positions, self.triangles())
    }
}

/// Returns the points of a solid at parameters.
pub(super) fn positions(spline: &TrivariateSpline, parameters: &[[f64; 3]]) -> Vec<Point3<f64>> {
    parameters
        .par_iter()
        .map(|&at| spline.position(at))
        .collect()
}

/// Returns the face of the cube that a parameter is nearest to, and its two coordinates there.
pub(super) fn nearest_face(parameter: [f64; 3]) -> (usize, [f64; 2]) {
    let distance = |face: usize| {
        let value = parameter[face / 2];
        if face % 2 == 1 { 1.0 - value } else { value }
    };
    let nearest = (0..6).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let face = nearest.unwrap_or(0);
    (face, face_axes(face).map(|axis| parameter[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_of_the_cube_is_closed_and_faces_outward() {
        for cells in [1, 2, 5] {
            let surface = CubeSurface::new(cells);
            for (vertex, place) in surface.places().enumerate() {
                assert_eq!(surface.vertex(place), vertex as u32, "{cells} {place:?}");
            }
            let unit = TrivariateSpline::from_map(1, Point3::from).expect("a spline");
            let mesh = surface.of(&unit).expect("a surface");
            assert_eq!(mesh.vertex_count(), 6 * cells * cells + 2);
            assert_eq!(mesh.topology().euler_characteristic(), 2);
            let volume: f64 = mesh
                .faces()
                .iter()
                .map(|face| {
                    let [a, b, c] = face.map(|v| mesh.positions()[v as usize].coords);
                    a.dot(&b.cross(&c)) / 6.0
                })
                .sum();
            assert!((volume - 1.0).abs() < 1e-12, "{cells}: {volume}");
        }
    }

    #[test]
    fn lines_follow_spans_and_edges_of_the_cube() {
        let surface = CubeSurface::new(6);
        let [lines, edges] = surface.lines(3);
        assert_eq!(edges.len(), 12 * 6);
        // Two lines each way inside of every face.
        assert_eq!(lines.len(), 6 * 2 * 2 * 6);
    }

    #[test]
    fn faces_are_numbered_as_the_cube_has_them() {
        assert_eq!(nearest_face([0.0, 0.3, 0.6]).0, 0);
        assert_eq!(nearest_face([0.4, 0.9, 0.6]), (3, [0.6, 0.4]));
    }
}
