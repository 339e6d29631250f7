//! Domains in the plane.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation as _};

use super::{DomainError, FlatDomain, MAGNITUDES};
use crate::vector::sub;

/// A point that knows its index.
struct Site {
    index: usize,
    position: Point2<f64>,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

impl FlatDomain {
    /// Returns the Delaunay triangulation of points in the plane, vertex `i` at `points[i]`.
    ///
    /// # Errors
    /// Points that are not finite, repeated, or all on one line.
    pub fn planar(points: &[[f64; 2]]) -> Result<Self, DomainError> {
        check_points(points)?;
        // The predicates take no coordinates that are tiny and not zero: triangulate in a unit of
        // the points' own, with these as zero.
        let extent = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        let unit = |c: f64| {
            if c.abs() > 1e-30 * extent {
                c / extent
            } else {
                0.0
            }
        };
        let sites = points.iter().enumerate().map(|(index, p)| Site {
            index,
            position: Point2::new(unit(p[0]), unit(p[1])),
        });
        let triangulation =
            DelaunayTriangulation::<Site>::bulk_load(sites.collect()).map_err(|_| {
                DomainError::NoTriangle {
                    points: points.len(),
                }
            })?;
        if triangulation.num_vertices() < points.len() {
            let mut kept = vec![false; points.len()];
            triangulation
                .vertices()
                .for_each(|v| kept[v.data().index] = true);
            let point = kept.iter().position(|kept| !kept).unwrap_or_default();
            return Err(DomainError::RepeatedPoint { point });
        }
        let mut faces: Vec<[u32; 3]> = triangulation
            .inner_faces()
            .map(|face| face.vertices().map(|v| v.data().index as u32))
            .map(from_smallest)
            .collect();
        if faces.is_empty() {
            return Err(DomainError::NoTriangle {
                points: points.len(),
            });
        }
        faces.sort_unstable();
        Self::planar_with_faces(points, faces)
    }

    /// Returns the domain of given counter-clockwise triangles over points in the plane.
    ///
    /// # Errors
    /// Points that are not finite, faces that are no oriented manifold, or a face that is not
    /// counter-clockwise.
    pub fn planar_with_faces(
        points: &[[f64; 2]],
        faces: Vec<[u32; 3]>,
    ) -> Result<Self, DomainError> {
        check_points(points)?;
        let positions = points.iter().map(|p| Point3::new(p[0], p[1], 0.0));
        let mesh = TriangleMesh::build(positions.collect(), faces)?;
        let sides = mesh
            .faces()
            .iter()
            .flat_map(|face| [0, 1, 2].map(|i| [face[i] as usize, face[(i + 1) % 3] as usize]));
        let vectors = sides.map(|[from, to]| sub(points[to], points[from]));
        let vectors = vectors.collect();
        Self::build(mesh, vectors)
    }
}

fn check_points(points: &[[f64; 2]]) -> Result<(), DomainError> {
    let far = |p: &[f64; 2]| !p.iter().all(|c| c.abs() < MAGNITUDES.end);
    points.iter().position(far).map_or(Ok(()), |vertex| {
        Err(DomainError::PositionNotFinite { vertex })
    })
}

fn from_smallest(face: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = face;
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
