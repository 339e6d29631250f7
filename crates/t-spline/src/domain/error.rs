//! Why a surface has no complex of cylinders.

use msplines_conformal::ConformalError;

use crate::complex::ComplexError;

/// Why a surface has no complex of cylinders.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// No holomorphic form, or none that lies flat.
    #[error(transparent)]
    Conformal(#[from] ConformalError),
    /// A form that is not one vector per half-edge, or ends that are not one per boundary loop.
    #[error("{given} {what} are given where the mesh has {needed}; give one for each")]
    Count {
        /// Vectors of half-edges, or ends of boundary loops.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many the mesh has.
        needed: usize,
    },
    /// Trajectories close only where the imaginary part has integer periods.
    #[error(
        "the imaginary part of the form misses whole periods by {defect:e} at vertex {vertex}; trajectories close only for integer periods: take a form choice with integer periods"
    )]
    Periods {
        /// Where an edge begins along which it does.
        vertex: u32,
        /// The largest miss.
        defect: f64,
    },
    /// A form that was not chosen for its integer periods.
    #[error(
        "the choice of the form leaves its periods real; choose `integer` or `integer_periods`"
    )]
    RealPeriods,
    /// A surface with too few loops for a form.
    #[error(
        "a surface of genus {genus} with {loops} boundary loops and poles has no form with closed trajectories here; name vertices as poles until there are two loops, or fill its only one"
    )]
    Kind {
        /// Number of handles.
        genus: u32,
        /// Number of boundary loops and poles.
        loops: usize,
    },
    /// A vertex that is no point.
    #[error("vertex {vertex} has a coordinate that is not finite; repair the mesh")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// A vertex that is named twice as a pole.
    #[error("vertex {vertex} is named twice as a pole; name it once")]
    SamePole {
        /// The vertex.
        vertex: u32,
    },
    /// A mesh without a vertex whose star could be a pole.
    #[error(
        "the surface needs a pole, and none of its {vertices} vertices lies two edges away from the boundary and three from other poles; refine the mesh"
    )]
    NoRoom {
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// The imaginary part is not constant along a boundary loop.
    #[error(
        "the imaginary part of the form changes by {change:e} along boundary loop {boundary}; it must be constant on every loop"
    )]
    LoopNotLevel {
        /// The loop.
        boundary: usize,
        /// How much it changes.
        change: f64,
    },
    /// The imaginary part grows into the surface at one place of a loop, and falls at another.
    #[error(
        "a zero of the form lies on boundary loop {boundary}, at vertex {vertex}; give that loop a larger flux, or fill it"
    )]
    ZeroOnLoop {
        /// The loop.
        boundary: usize,
        /// A vertex of it where the direction changes.
        vertex: u32,
    },
    /// All corners of a face lie on one boundary loop.
    #[error("all corners of face {face} lie on one boundary loop; split it")]
    FlatFace {
        /// The face.
        face: u32,
    },
    /// The imaginary part has a summit or a sink, which no harmonic function has.
    #[error(
        "the imaginary part of the form has an extremum at vertex {vertex}; the mesh is too coarse there, or the form decays below the digits of a number: refine it, choose another form, or put a pole there"
    )]
    Extremum {
        /// The vertex.
        vertex: u32,
    },
    /// Not as many zeros as the topology asks for.
    #[error(
        "the form has {found} zeros, counted by order, where the topology has {expected}; refine the mesh, or choose another form"
    )]
    Zeros {
        /// Zeros counted by order.
        found: i64,
        /// `2g - 2 + b`.
        expected: i64,
    },
    /// A critical trajectory that does not come back, or has no length.
    #[error(
        "the critical trajectory from the zero at vertex {vertex} has length {length:e}; the mesh is too coarse there: refine it, or choose another form"
    )]
    Trajectory {
        /// The vertex.
        vertex: u32,
        /// Its length; NaN if it does not come back.
        length: f64,
    },
    /// Not as many cylinders as simple zeros leave.
    #[error("critical trajectories leave {found} cylinders, not {expected}; choose another form")]
    Cylinders {
        /// How many there are.
        found: usize,
        /// `3g - 3 + 2b`.
        expected: usize,
    },
    /// Trajectories along a border of a cylinder that do not close up.
    #[error(
        "the trajectories along a border of cylinder {cylinder} miss its circumference by {miss:e} of it; the coordinates span too many orders of magnitude: choose another form"
    )]
    Closure {
        /// The cylinder, as numbered before any was collapsed.
        cylinder: u32,
        /// By how much, as a share of the circumference.
        miss: f64,
    },
    /// The areas of cylinders do not sum to that of the form.
    #[error("the cylinders have {share} times the area of the form; choose another form")]
    Area {
        /// Sum of `C H` over the integral of the area form.
        share: f64,
    },
    /// A cylinder or a trajectory below the resolution of whole numbers, which no collapse removes.
    #[error(
        "cylinder {cylinder} is too thin for whole units: height {height}, circumference {circumference}; two zeros lie at one level: choose another form"
    )]
    Thin {
        /// The cylinder, as numbered before any was collapsed.
        cylinder: u32,
        /// Its height in units.
        height: i64,
        /// Its circumference in units.
        circumference: i64,
    },
    /// Tables that are no glued surface: an error of this crate.
    #[error("the cylinders do not fit together: {0}")]
    Complex(#[from] ComplexError),
}
