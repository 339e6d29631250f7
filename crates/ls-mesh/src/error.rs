//! Why there is no surface, and the checks that say so.

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::mesh::Topology;

use crate::options::{Constraints, ControlChoice, Options, Selection};

/// Why a fit has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// No control was asked for.
    #[error("no control is asked for; a surface needs at least one per component of the mesh")]
    NoControls,
    /// More controls were asked for than there are vertices.
    #[error("{count} controls are more than the mesh has vertices; ask for at most {vertices}")]
    TooManyControls {
        /// Number asked for.
        count: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// Fewer controls were asked for than the mesh has components.
    #[error(
        "{count} controls cannot hold {components} components; ask for one each, or keep only the largest component"
    )]
    TooFewControls {
        /// Number asked for.
        count: usize,
        /// Components of the mesh.
        components: u32,
    },
    /// A given control is no vertex.
    #[error(
        "control {index} is vertex {vertex}, but the mesh has {vertices} vertices, numbered from 0"
    )]
    NoSuchVertex {
        /// Place in the list of controls.
        index: usize,
        /// The vertex it names.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A vertex is given twice.
    #[error("vertex {vertex} is given as a control twice; give it once")]
    RepeatedControl {
        /// The vertex.
        vertex: u32,
    },
    /// A component has no control, so that nothing says where it is.
    #[error("the component of vertex {vertex} has no control; give it at least one")]
    ComponentWithoutControl {
        /// First vertex of the component.
        vertex: u32,
    },
    /// The data have another shape than the mesh.
    #[error(
        "{values} values are not {vertices} vertices times {dimension} components; give one row per vertex, and at least one component"
    )]
    WrongLength {
        /// Values given.
        values: usize,
        /// Rows due.
        vertices: usize,
        /// Components of a row.
        dimension: usize,
    },
    /// A value is NaN, infinite, or too large to be squared beside the others.
    #[error(
        "component {component} at vertex {vertex} is {value:?}; give finite values of at most 1e150"
    )]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// The component.
        component: usize,
        /// The value.
        value: f64,
    },
    /// A weight that no least-squares row can have.
    #[error(
        "a control weight of {weight:?} is not positive with a finite square; use 1, or hard constraints"
    )]
    Weight {
        /// The weight.
        weight: f64,
    },
    /// A selection without any solve.
    #[error("a combined selection of 0 solves selects nothing; give at least 1")]
    NoSolves,
    /// The matrix could not be ordered.
    #[error("the system cannot be ordered: {0}")]
    Ordering(#[from] OrderingError),
    /// The matrix could not be factored.
    #[error("the system cannot be factored: {0}; ask for more controls or a larger weight")]
    Factor(#[from] FactorError),
}

/// Largest value: the sum of a million squares is finite yet.
const LARGEST: f64 = 1e150;

pub(crate) fn check_options(topology: &Topology, options: &Options) -> Result<(), FitError> {
    match &options.controls {
        ControlChoice::Given(controls) => check_controls(topology, controls)?,
        &ControlChoice::Selected { count } => {
            check_count(topology, count)?;
            let components = topology.components().1;
            if (count as u64) < u64::from(components) {
                return Err(FitError::TooFewControls { count, components });
            }
            if options.selection == (Selection::Combined { solves: 0 }) {
                return Err(FitError::NoSolves);
            }
        }
    }
    check_constraints(options.constraints)
}

pub(crate) fn check_constraints(constraints: Constraints) -> Result<(), FitError> {
    match constraints {
        Constraints::Soft { weight } if !(weight > 0.0 && (weight * weight).is_finite()) => {
            Err(FitError::Weight { weight })
        }
        _ => Ok(()),
    }
}

fn check_count(topology: &Topology, count: usize) -> Result<(), FitError> {
    let vertices = topology.vertex_count();
    match count {
        0 => Err(FitError::NoControls),
        _ if count > vertices => Err(FitError::TooManyControls { count, vertices }),
        _ => Ok(()),
    }
}

pub(crate) fn check_controls(topology: &Topology, controls: &[u32]) -> Result<(), FitError> {
    let vertices = topology.vertex_count();
    let mut seen = vec![false; vertices];
    for (index, &vertex) in controls.iter().enumerate() {
        match seen.get_mut(vertex as usize) {
            None => {
                return Err(FitError::NoSuchVertex {
                    index,
                    vertex,
                    vertices,
                });
            }
            Some(true) => return Err(FitError::RepeatedControl { vertex }),
            Some(unseen) => *unseen = true,
        }
    }
    check_count(topology, controls.len())?;
    let (labels, components) = topology.components();
    let mut held = vec![false; components as usize];
    for &vertex in controls {
        held[labels[vertex as usize] as usize] = true;
    }
    let loose = labels.iter().position(|&label| !held[label as usize]);
    loose.map_or(Ok(()), |v| {
        Err(FitError::ComponentWithoutControl { vertex: v as u32 })
    })
}

pub(crate) fn check_data(rows: usize, data: VertexData<'_>) -> Result<(), FitError> {
    let (values, dimension) = (data.values.len(), data.dimension);
    if dimension == 0 || rows.checked_mul(dimension) != Some(values) {
        return Err(FitError::WrongLength {
            values,
            vertices: rows,
            dimension,
        });
    }
    match data
        .values
        .iter()
        .position(|value| value.is_nan() || value.abs() > LARGEST)
    {
        None => Ok(()),
        Some(at) => Err(FitError::NotFinite {
            vertex: at / dimension,
            component: at % dimension,
            value: data.values[at],
        }),
    }
}
