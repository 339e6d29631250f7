//! Uniform cubic B-splines in one variable, Bernstein-Bézier kernels, Bézier cells and shells.
//!
//! Everything works along one axis of an array of any number of axes, which is seen as
//! `values[(outer * count + index) * inner + i]`: `count` coefficients along the axis, `inner` numbers
//! that vary faster and `outer` that vary slower. So a tensor product is a loop over its axes.

mod axis;
pub mod bernstein;
mod cells;
mod shell;
mod uniform;

pub use axis::Axis;
pub use cells::{
    BezierCells, CellRun, CellShape, CellsError, hexahedron_points, vtk_hexahedron_order,
    vtk_quad_order, vtk_triangle_order,
};
pub use shell::{
    BezierCurve, BezierEdge, BezierFace, BezierShell, EdgeUse, ShellComponent, ShellError,
    ShellPart,
};
pub use uniform::{
    curvatures, from_bezier, greville, locate, refine, refine_axis, slopes, span_restriction,
    to_bezier, weights,
};
