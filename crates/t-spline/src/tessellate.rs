//! The whole surface as triangles, its poles closed.

use msplines_common::Point3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{Lattice, NONE, SurfacePoint, Topology, TopologyError};
use rayon::prelude::*;

use crate::complex::Point;
use crate::domain::{End, Pole};
use crate::surface::TSplineSurface;

/// Triangles of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// Positions: those of the vertices of the mesh, of the centres of poles, and then others.
    pub positions: Vec<Point3<f64>>,
    /// Faces.
    pub faces: Vec<[u32; 3]>,
}

impl Tessellation {
    /// Leaves out faces, and the points that no other face has.
    fn without(self, is_out: impl Fn(usize) -> bool) -> Self {
        let faces = self.faces.into_iter().enumerate();
        let faces: Vec<[u32; 3]> = faces.filter(|&(f, _)| !is_out(f)).map(|(_, c)| c).collect();
        let mut names = vec![NONE; self.positions.len()];
        faces.iter().flatten().for_each(|&v| names[v as usize] = v);
        let mut positions = Vec::new();
        for name in names.iter_mut().filter(|name| **name != NONE) {
            positions.push(self.positions[*name as usize]);
            *name = positions.len() as u32 - 1;
        }
        Self {
            positions,
            faces: faces.iter().map(|c| c.map(|v| names[v as usize])).collect(),
        }
    }
}

impl TSplineSurface {
    /// Returns the surface over `segments²` triangles per face of the mesh, and as many per edge around a
    /// pole, watertight. Holes that were closed stay open.
    ///
    /// # Errors
    /// A mesh that poles do not close.
    ///
    /// # Panics
    /// If `segments` is zero.
    pub fn tessellate(&self, segments: u32) -> Result<Tessellation, TopologyError> {
        let closed = self.closed()?;
        let lattice = Lattice::new(&closed.topology, segments);
        let vertices = self.vertices();
        let place = |(index, point): (usize, &SurfacePoint)| match vertices.get(index) {
            Some(&vertex) => vertex,
            None => self.place_around(&closed, point),
        };
        let points: Vec<Point> = lattice.points.par_iter().enumerate().map(place).collect();
        let whole = Tessellation {
            positions: self.spline().evaluate(&points, Order::Value).positions,
            faces: lattice.faces(closed.topology.face_count() as u32),
        };
        let outside = self.domain().outside();
        if outside.is_empty() {
            return Ok(whole);
        }
        let per_face = (segments * segments) as usize;
        Ok(whole.without(|face| outside.binary_search(&((face / per_face) as u32)).is_ok()))
    }

    /// Returns the mesh with a fan of faces around every pole: rim, and then the centre.
    fn closed(&self) -> Result<Closed, TopologyError> {
        let domain = self.domain();
        let mesh = domain.mesh();
        let topology = mesh.topology();
        let poles = domain.poles();
        let (mut faces, mut rims) = (mesh.faces().to_vec(), Vec::new());
        for (index, half_edges) in topology.boundary_loops().iter().enumerate() {
            if !matches!(domain.ends()[index], End::Pole(_)) {
                continue;
            }
            let Some(which) = poles.iter().position(|p| p.index as usize == index) else {
                continue;
            };
            let centre = (mesh.vertex_count() + which) as u32;
            for &half_edge in half_edges {
                faces.push([
                    topology.target(half_edge),
                    topology.origin(half_edge),
                    centre,
                ]);
                rims.push((half_edge, poles[which]));
            }
        }
        let vertices = mesh.vertex_count() + poles.len();
        Ok(Closed {
            topology: Topology::build(vertices, faces)?,
            rims,
        })
    }

    /// Returns where a point of the closed mesh lies. Around a pole `w`, whose logarithm `x` and `y` are, is
    /// scaled from the rim to the centre.
    fn place_around(&self, closed: &Closed, point: &SurfacePoint) -> Point {
        let inner = self.domain().mesh().face_count();
        let Some(around) = (point.face as usize).checked_sub(inner) else {
            return self.place(point);
        };
        let (half_edge, pole) = closed.rims[around];
        let [at_target, at_origin, at_centre] = point.at;
        if at_centre >= 1.0 {
            return pole.at;
        }
        let share = at_target / (at_target + at_origin);
        let mut at = [0.0; 3];
        at[half_edge as usize % 3] = 1.0 - share;
        at[Topology::next(half_edge) as usize % 3] = share;
        let rim = self.place(&SurfacePoint {
            face: half_edge / 3,
            at,
        });
        let size = self.domain().complex().cylinders()[rim.cylinder as usize].circumference as f64;
        let further = -(1.0 - at_centre).ln() * size / std::f64::consts::TAU;
        Point {
            y: rim.y + pole.away * further,
            ..rim
        }
    }
}

/// A mesh with closed poles.
struct Closed {
    topology: Topology,
    /// Per face beyond those of the mesh its edge on the rim, and the pole.
    rims: Vec<(u32, Pole)>,
}
