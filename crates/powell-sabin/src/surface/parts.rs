//! A surface as plain numbers, as spline files hold them.

use msplines_common::mesh::TriangleMesh;
use msplines_conformal::Zero;
use serde::{Deserialize, Serialize};

use super::PowellSabinSurface;
use super::chart::Reach;
use super::error::SurfaceError;
use super::fit::{pinched, regular_part};
use super::hole::{Cap, Hole};
use super::minimal::{MinimalCap, Rim};
use super::smooth::SmoothCap;
use crate::domain::FlatDomain;
use crate::spline::PowellSabinSpline;

/// The numbers of a surface besides those of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceParts {
    /// The form, by half-edge of the mesh.
    pub edge_vectors: Vec<[f64; 2]>,
    /// Positions at the vertices of the regular part: those of the mesh that faces outside of holes use,
    /// ascending.
    pub values: Vec<[f64; 3]>,
    /// Derivatives there by `u` and `v`.
    pub gradients: Vec<[[f64; 3]; 2]>,
    /// The holes.
    pub holes: Vec<HoleParts>,
}

/// The numbers of a hole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoleParts {
    /// Order of the zero.
    pub order: i32,
    /// Vertices inside, ascending.
    pub vertices: Vec<u32>,
    /// Faces cut out, ascending.
    pub faces: Vec<u32>,
    /// What fills it.
    pub cap: CapParts,
}

/// The numbers of a cap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum CapParts {
    /// Nothing.
    Open,
    /// A spline over the chart of the zero.
    Smooth {
        /// How far the chart goes.
        reach: Reach,
        /// The zero in coordinates of the form that are 0 at the first vertex of the chart's first
        /// usable face.
        zero: [f64; 2],
        /// Places in the chart of the vertices of these faces, ascending.
        chart: Vec<[f64; 2]>,
        /// Positions there.
        values: Vec<[f64; 3]>,
        /// Derivatives there by the coordinates of the chart.
        gradients: Vec<[[f64; 3]; 2]>,
    },
    /// The control points of a minimal surface.
    Minimal {
        /// Control points.
        points: Vec<[f64; 3]>,
    },
}

/// Positions and derivatives as rows.
pub(super) type Rows = (Vec<[f64; 3]>, Vec<[[f64; 3]; 2]>);

pub(super) fn rows(spline: &PowellSabinSpline) -> Rows {
    let values = spline.vertex_values().as_chunks::<3>().0.to_vec();
    let gradients = spline.vertex_gradients().as_chunks::<3>().0;
    (values, gradients.as_chunks::<2>().0.to_vec())
}

impl PowellSabinSurface {
    /// Returns the numbers of the surface; together with [`Self::mesh`] they are all of it.
    #[must_use]
    pub fn parts(&self) -> SurfaceParts {
        let (values, gradients) = rows(self.regular());
        let hole = |hole: &Hole| HoleParts {
            order: hole.order,
            vertices: hole.vertices.clone(),
            faces: hole.faces.clone(),
            cap: match &hole.cap {
                Cap::Open => CapParts::Open,
                Cap::Smooth(cap) => cap.parts(),
                Cap::Minimal(cap) => CapParts::Minimal {
                    points: cap.points().iter().map(|&p| p.into()).collect(),
                },
            },
        };
        SurfaceParts {
            edge_vectors: self.edge_vectors.clone(),
            values,
            gradients,
            holes: self.holes.iter().map(hole).collect(),
        }
    }

    /// Returns the surface of these numbers over the mesh of the whole surface, with the same bits.
    ///
    /// # Errors
    /// Numbers that do not fit the mesh, or are not finite.
    pub fn from_parts(mesh: TriangleMesh, parts: &SurfaceParts) -> Result<Self, SurfaceError> {
        let zeros: Vec<Zero> = parts.holes.iter().map(HoleParts::zero).collect();
        for (hole, zero) in zeros.iter().enumerate() {
            check_hole(&mesh, hole, zero)?;
        }
        let stored = |hole: usize, reason: &str| SurfaceError::Stored {
            hole,
            reason: reason.to_owned(),
        };
        let form = &parts.edge_vectors;
        if form.len() != 3 * mesh.face_count() {
            let error = crate::DomainError::VectorCount {
                found: form.len(),
                half_edges: 3 * mesh.face_count(),
            };
            return Err(SurfaceError::Domain(error));
        }
        let part = regular_part(&mesh, &zeros)?;
        let local = part.mesh(&mesh).map_err(|e| pinched(e, &part))?;
        let domain = FlatDomain::build(local, part.pick_sides(form))
            .map_err(|e| SurfaceError::Domain(e.renamed(&part.vertices, &part.faces)))?;
        let regular = spline(domain, &parts.values, &parts.gradients)?;
        let mut holes = Vec::new();
        for (number, (zero, own)) in zeros.into_iter().zip(&parts.holes).enumerate() {
            let cap = match &own.cap {
                CapParts::Open => Cap::Open,
                CapParts::Smooth {
                    reach,
                    zero: at,
                    chart,
                    values,
                    gradients,
                } => {
                    let in_hole = |face: u32| part.face(face).is_none();
                    let rows = (values.as_slice(), gradients.as_slice());
                    let places = (at, chart.as_slice());
                    let cap = SmoothCap::restore(&mesh, form, in_hole, &zero, *reach, places, rows);
                    Cap::Smooth(Box::new(cap.map_err(|e| stored(number, &e.to_string()))?))
                }
                CapParts::Minimal { points } => {
                    let rim = Rim {
                        mesh: &mesh,
                        regular: &regular,
                        part: &part,
                    };
                    let cap = MinimalCap::restore(&rim, &zero, points);
                    Cap::Minimal(Box::new(cap.ok_or_else(|| {
                        stored(number, "its control points are not those of its faces")
                    })?))
                }
            };
            holes.push(Hole {
                order: zero.order,
                vertices: zero.vertices,
                faces: zero.faces,
                cap,
            });
        }
        Ok(Self::assemble(mesh, form.clone(), regular, part, holes))
    }
}

impl HoleParts {
    fn zero(&self) -> Zero {
        Zero {
            order: self.order,
            vertices: self.vertices.clone(),
            faces: self.faces.clone(),
        }
    }
}

fn check_hole(mesh: &TriangleMesh, hole: usize, zero: &Zero) -> Result<(), SurfaceError> {
    let ascending = |ids: &[u32]| ids.windows(2).all(|pair| pair[0] < pair[1]);
    let below = |ids: &[u32], count: usize| ids.last().is_some_and(|&id| (id as usize) < count);
    let good = ascending(&zero.vertices)
        && ascending(&zero.faces)
        && below(&zero.vertices, mesh.vertex_count())
        && below(&zero.faces, mesh.face_count())
        && (zero.order > 0 || zero.order == -2);
    if good {
        return Ok(());
    }
    let reason = "its order, vertices or faces are none of this mesh".to_owned();
    Err(SurfaceError::Stored { hole, reason })
}

/// Returns a spline of rows.
pub(super) fn spline(
    domain: FlatDomain,
    values: &[[f64; 3]],
    gradients: &[[[f64; 3]; 2]],
) -> Result<PowellSabinSpline, crate::SplineError> {
    let values = values.as_flattened().to_vec();
    let gradients = gradients.as_flattened().as_flattened().to_vec();
    PowellSabinSpline::from_parts(domain, 3, values, gradients)
}
