//! Why there is no surface.

use msplines_common::mesh::polygon::ControlMeshError;

/// Why a fit has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The control mesh has faces that are not quads.
    #[error(transparent)]
    ControlMesh(#[from] ControlMeshError),
    /// No atoms were asked for.
    #[error("a sparsity of 0 leaves nothing; ask for at least one atom, such as 25")]
    NoAtoms,
    /// A dictionary of shape functions, and charts that must not use them.
    #[error("smooth charts would be empty: the dictionary has shape functions only; open the gate")]
    EmptyCharts,
    /// Too few or too many refinements.
    #[error("{levels} levels of observations; ask for 1 to 6")]
    Levels {
        /// What was asked for.
        levels: u32,
    },
    /// A polynomial degree out of range.
    #[error("polynomials of degree {degree}; ask for 0 to 14")]
    Degree {
        /// What was asked for.
        degree: u32,
    },
    /// A chart of more splines than observations, whose surface between these would be anything.
    #[error(
        "chart {chart} has {found} observations for {needed} splines; give more levels (`--levels`), or choose sparse functions or polynomials (`--local`)"
    )]
    TooFewObservations {
        /// The chart.
        chart: usize,
        /// Observations on it.
        found: usize,
        /// Functions to be determined.
        needed: usize,
    },
    /// A valence beyond what a chart can hold.
    #[error(
        "the chart of vertex {vertex} has {valence} sectors; it takes at most {most}: split the faces around it"
    )]
    Valence {
        /// The vertex.
        vertex: u32,
        /// Its number of sectors, closed where it lies on the boundary.
        valence: u32,
        /// How many a chart takes.
        most: u32,
    },
    /// A chart that does not exist.
    #[error("chart {chart} is to be smooth, but there are {charts} charts, numbered from 0")]
    NoSuchChart {
        /// The chart.
        chart: u32,
        /// How many there are.
        charts: usize,
    },
    /// A number that means nothing.
    #[error("`{name}` is {value}; give a number {range}")]
    Number {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// An observation is NaN or infinite.
    #[error("observation {index} is not finite; check the positions of the control vertices")]
    NotFinite {
        /// The observation.
        index: usize,
    },
    /// Observations of another mesh.
    #[error("{found} observations for {expected} points of the grids; give one for each")]
    WrongLength {
        /// How many were given.
        found: usize,
        /// How many are due.
        expected: usize,
    },
}

/// Why stored charts are no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// The control mesh has faces that are not quads.
    #[error(transparent)]
    ControlMesh(#[from] ControlMeshError),
    /// A polynomial degree out of range.
    #[error("polynomials of degree {degree}, which no chart has; fit again")]
    Degree {
        /// The degree.
        degree: u32,
    },
    /// A valence beyond what a chart can hold.
    #[error(
        "the chart of vertex {vertex} has {valence} sectors, at most {most} are possible; give the mesh \
         that was fitted"
    )]
    Valence {
        /// The vertex.
        vertex: u32,
        /// Its number of sectors, closed where it lies on the boundary.
        valence: u32,
        /// How many a chart takes.
        most: u32,
    },
    /// The number of charts is not that of vertices.
    #[error("{found} charts for {expected} vertices; give the mesh that was fitted")]
    Charts {
        /// How many there are.
        found: usize,
        /// How many are due.
        expected: usize,
    },
    /// A chart names atoms that do not exist, or has not three finite coefficients for each.
    #[error(
        "chart {chart} is damaged: of {atoms} atoms each needs three finite coefficients; fit again"
    )]
    Chart {
        /// The chart.
        chart: usize,
        /// Atoms of its dictionary.
        atoms: usize,
    },
}
