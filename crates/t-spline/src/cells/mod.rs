//! The surface as a quad mesh, as Bézier cells and as a shell.
//!
//! # Notation
//! On a box that no knot of a function divides, `sum C_i B_i / sum B_i` is one rational bicubic, whose
//! coefficients come from the blossoms of the functions. Under caps, and on the disks that they leave at
//! poles, the surface is none: there it is interpolated by polynomials on boxes that are halved until the
//! deviation, measured between the nodes, is below a tolerance. Around a zero of order `m` the `4 (m + 1)`
//! patches that meet there are laid out in the root `z^(1/(m+1))`, in which the surface is smooth.
//!
//! Splitting halves the axis along which a patch has the larger term of highest degree. Degree 5 needs
//! least patches down to about 1e-4 of the size of a surface, 7 to 9 below.
//!
//! ```
//! use std::sync::Arc;
//!
//! use msplines_common::Vector3;
//! use msplines_common::evaluate::Order;
//! use msplines_t_spline::caps::CapOptions;
//! use msplines_t_spline::cells::CellOptions;
//! use msplines_t_spline::complex::CylinderComplex;
//! use msplines_t_spline::tmesh::{Axis, Grid, TMesh};
//! use msplines_t_spline::{TSpline, TSplineSpace};
//!
//! let one = 1_i64 << 44;
//! let complex = Arc::new(CylinderComplex::torus(one, one, one / 4)?);
//! let mut mesh = TMesh::build(&complex, &[Grid { columns: 8, rows: 4 }])?;
//! mesh.split(9, Axis::X);
//! let space = Arc::new(TSplineSpace::build(mesh, &CapOptions::default())?);
//! let control = space.functions().iter().map(|f| {
//!     let [a, b] = [f.node.x, f.node.y].map(|c| c as f64 / one as f64 * std::f64::consts::TAU);
//!     let r = 2.0 + b.cos();
//!     Vector3::new(r * a.cos(), r * a.sin(), b.sin())
//! });
//! let spline = TSpline::new(Arc::clone(&space), control.collect());
//!
//! // The curves of the T-mesh: the split face is two, and its sides above and below break.
//! let mesh = spline.quad_mesh();
//! assert_eq!((mesh.faces().len(), mesh.t_junctions(), mesh.characteristic()), (33, 2, 0));
//! let curve = spline.evaluate(&mesh.polyline(0, 16), Order::Value).positions;
//! assert_eq!(curve.len(), 17);
//!
//! // Without caps all patches are exact.
//! let work = spline.patchwork(&CellOptions { tolerance: 1e-4, degree: 5 })?;
//! assert_eq!(work.report().approximate, 0);
//! assert!(work.shell()?.components()[0].is_closed);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [He2006] §3.2, Eq. (1). Deviation: the paper gives no cells.

mod error;
mod lines;
mod mesh;
mod patch;
mod shell;
#[cfg(test)]
mod tests;
mod tile;
mod tiling;

use std::sync::Arc;

use msplines_common::bspline::{BezierCells, BezierShell, CellShape};

pub use error::CellError;
pub use mesh::{Edge, Face, QuadMesh, SidePart, Vertex};

use crate::complex::{CylinderComplex, Point};
use crate::spline::TSpline;
use patch::Patch;

/// Degrees that interpolation is stable and worth its points for.
const DEGREES: std::ops::RangeInclusive<u8> = 3..=9;

/// How caps are approximated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellOptions {
    /// The largest distance of approximate cells from the surface, a length; on their sides it is half of
    /// that, so that gaps are no larger.
    pub tolerance: f64,
    /// Their degree in both directions, 3 to 9.
    pub degree: u8,
}

/// What cells are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellReport {
    /// Cells that are the surface.
    pub exact: usize,
    /// Cells that approximate it.
    pub approximate: usize,
    /// The largest distance of approximate cells from the surface that was measured.
    pub deviation: f64,
    /// The largest distance between neighbours at the same points of the edges between them that was
    /// measured.
    pub gap: f64,
}

/// Patches that tile a surface.
#[derive(Clone, Debug)]
pub struct Patchwork {
    /// Exact ones first.
    patches: Vec<Patch>,
    complex: Arc<CylinderComplex>,
    mesh: QuadMesh,
    report: CellReport,
}

impl TSpline {
    /// Returns the explicit T-mesh: its faces are the leaves.
    #[must_use]
    pub fn quad_mesh(&self) -> QuadMesh {
        QuadMesh::of_leaves(self.space().mesh())
    }

    /// Cuts the surface into Bézier patches: rational bicubics outside of caps, polynomials under them.
    ///
    /// Cost: linear in the patches, in parallel over leaves; the same bits on any number of threads.
    ///
    /// # Errors
    /// A tolerance that is not positive or cannot be reached, a degree out of range.
    pub fn patchwork(&self, options: &CellOptions) -> Result<Patchwork, CellError> {
        let fit = options.tolerance.is_finite() && options.tolerance > 0.0;
        if !fit || !DEGREES.contains(&options.degree) {
            return Err(CellError::Options {
                tolerance: options.tolerance,
                degree: options.degree,
            });
        }
        let mut patches = tiling::patches(self, options)?;
        patches.sort_by_key(|patch| !patch.is_exact());
        let tiles: Vec<tile::Tile> = patches.iter().map(|patch| patch.cell).collect();
        let mesh = QuadMesh::of_tiles(self.space().mesh().complex(), &tiles);
        let exact = patches.iter().filter(|patch| patch.is_exact()).count();
        let report = CellReport {
            exact,
            approximate: patches.len() - exact,
            deviation: patches.iter().map(|p| p.deviation).fold(0.0, f64::max),
            gap: shell::gap(&mesh, &patches),
        };
        Ok(Patchwork {
            patches,
            complex: Arc::clone(self.space().mesh().complex()),
            mesh,
            report,
        })
    }
}

impl Patchwork {
    /// Returns what the patches are.
    #[must_use]
    pub fn report(&self) -> CellReport {
        self.report
    }

    /// Returns where `(s, t)` of the unit square of a patch lies, whose point is that of the surface there, or
    /// within the deviation of it. Patches are in the order of the cells.
    ///
    /// # Panics
    /// If there is no such patch.
    #[must_use]
    pub fn place(&self, patch: usize, at: [f64; 2]) -> Point {
        let Patch { tile, chart, .. } = &self.patches[patch];
        tile.point(&self.complex, *chart, at)
    }

    /// Returns the patches as cells with weights, exact ones first; weights of approximate ones are 1.
    ///
    /// # Errors
    /// None but of faults in the patches themselves.
    pub fn cells(&self) -> Result<BezierCells, CellError> {
        let (exact, rest) = self.patches.split_at(self.report.exact);
        let run = |patches: &[Patch], degree: usize| {
            let points: Vec<_> = patches.iter().flat_map(|p| p.points.clone()).collect();
            let weights = patches.iter().flat_map(|p| match &p.weights {
                Some(weights) => weights.clone(),
                None => vec![1.0; p.points.len()],
            });
            let weights = weights.collect();
            BezierCells::build(CellShape::Quads, [degree, degree, 0], points, Some(weights))
        };
        let cells = run(exact, 3)?;
        let Some(first) = rest.first() else {
            return Ok(cells);
        };
        let more = run(rest, first.degree)?;
        Ok(if exact.is_empty() {
            more
        } else {
            cells.joined(more)?
        })
    }

    /// Returns the patches as a shell whose faces share their edges, in the order of the cells; closed if
    /// the surface is. Its tolerance is twice the largest gap, that between curves and patches.
    ///
    /// # Errors
    /// Edges that are no way around their patches, as where a surface has shrunk to a point.
    pub fn shell(&self) -> Result<BezierShell, CellError> {
        shell::shell(&self.mesh, &self.patches, self.report.gap)
    }
}
