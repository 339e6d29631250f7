//! The whole surface as a mesh of triangles.

use msplines_common::Point3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{Lattice, NONE, SurfacePoint};
use rayon::prelude::*;

use super::PowellSabinSurface;
use crate::spline::Tessellation;

impl PowellSabinSurface {
    /// Returns the surface over `segments²` triangles per face of the mesh, watertight: neighbouring
    /// faces share their points, so that only open holes and the boundary of the mesh are bounded.
    ///
    /// The vertices of the mesh come first, without those inside of open holes.
    ///
    /// # Panics
    /// If `segments` is zero.
    #[must_use]
    pub fn tessellate(&self, segments: u32) -> Tessellation {
        assert!(segments > 0, "at least one segment per edge");
        let lattice = Lattice::new(self.mesh.topology(), segments);
        let per_face = (segments * segments) as usize;
        let mut faces = lattice.faces(self.mesh.face_count() as u32);
        let mut points = lattice.points;
        if self.holes.iter().any(|hole| self.is_open(hole.faces[0])) {
            let mut at = 0;
            faces.retain(|_| {
                at += 1;
                !self.is_open(((at - 1) / per_face) as u32)
            });
            // Points of edges between an open face and another are asked for on the other.
            self.compact(&mut points, &mut faces);
        }
        let jets: Vec<_> = points
            .par_iter()
            .map(|point| {
                let jet = self.jet(point, Order::First);
                (Point3::from(jet.value), self.normal(point, &jet))
            })
            .collect();
        let (positions, normals) = jets.into_iter().unzip();
        Tessellation {
            points,
            positions,
            normals,
            faces,
        }
    }

    /// Drops the points that no triangle uses, and moves those on open faces to a neighbour.
    fn compact(&self, points: &mut Vec<SurfacePoint>, faces: &mut [[u32; 3]]) {
        let mut places = vec![NONE; points.len()];
        faces.iter().flatten().for_each(|&p| places[p as usize] = 0);
        let mut kept = Vec::new();
        for (place, point) in places.iter_mut().zip(points.iter()) {
            if *place != NONE {
                *place = kept.len() as u32;
                kept.push(self.beside_hole(*point));
            }
        }
        for corner in faces.iter_mut().flatten() {
            *corner = places[*corner as usize];
        }
        *points = kept;
    }

    /// Returns the same point on a face that is not open, if there is one.
    fn beside_hole(&self, point: SurfacePoint) -> SurfacePoint {
        if !self.is_open(point.face) {
            return point;
        }
        let topology = self.mesh.topology();
        let corners = self.mesh.faces()[point.face as usize];
        let weight = |vertex: u32| {
            let corner = corners.iter().position(|&v| v == vertex);
            corner.map_or(0.0, |i| point.at[i])
        };
        let first = (0..3).find(|&i| point.at[i] > 0.0).unwrap_or(0);
        let holding = topology.outgoing(corners[first]).find(|h| {
            let own = self.mesh.faces()[(h / 3) as usize].map(weight);
            !self.is_open(h / 3) && own.iter().sum::<f64>() > 1.0 - 1e-9
        });
        holding.map_or(point, |h| SurfacePoint {
            face: h / 3,
            at: self.mesh.faces()[(h / 3) as usize].map(weight),
        })
    }
}
