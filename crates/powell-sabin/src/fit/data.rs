//! What is given at the vertices, and what is therefore unknown there.

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};

use crate::domain::FlatDomain;
use crate::error::FitError;
use crate::tangent::kept_across;

/// Largest coordinate whose square is still a number with room to spare.
const LARGEST: f64 = 1e140;

/// What the surface does at one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VertexCondition {
    /// It has this position and normal; four numbers are free.
    Interpolate {
        /// The position.
        position: Point3<f64>,
        /// The normal, of any length.
        normal: Vector3<f64>,
    },
    /// It has this position; six numbers are free.
    Position {
        /// The position.
        position: Point3<f64>,
    },
    /// It has this position and these derivatives by the flat `u` and `v`; nothing is free.
    Fixed {
        /// The position.
        position: Point3<f64>,
        /// The derivatives.
        gradient: [Vector3<f64>; 2],
    },
    /// Nothing is given; nine numbers are free.
    Free,
}

impl VertexCondition {
    /// Returns the data of a surface through all vertices of a mesh with these normals.
    ///
    /// # Panics
    /// If there is not one normal per vertex.
    #[must_use]
    pub fn of_mesh(mesh: &TriangleMesh, normals: &[Vector3<f64>]) -> Vec<Self> {
        assert_eq!(mesh.vertex_count(), normals.len(), "one normal per vertex");
        let pairs = mesh.positions().iter().zip(normals);
        pairs
            .map(|(&position, &normal)| Self::Interpolate { position, normal })
            .collect()
    }

    /// Returns the position, where there is one.
    pub(crate) fn position(&self) -> Option<Point3<f64>> {
        match *self {
            Self::Interpolate { position, .. }
            | Self::Position { position }
            | Self::Fixed { position, .. } => Some(position),
            Self::Free => None,
        }
    }

    /// Returns a gradient, rounded such that it keeps the normal, where there is one.
    pub(crate) fn kept(&self, gradient: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
        match self {
            Self::Interpolate { normal, .. } => {
                unit(normal).map_or(gradient, |normal| kept_across(gradient, &normal))
            }
            _ => gradient,
        }
    }

    pub(crate) fn check(&self, vertex: u32) -> Result<(), FitError> {
        let finite = |v: &Vector3<f64>| v.iter().all(|c| c.abs() < LARGEST);
        let good = match self {
            Self::Fixed { gradient, .. } => gradient.iter().all(finite),
            _ => true,
        };
        if !good || !self.position().is_none_or(|p| finite(&p.coords)) {
            return Err(FitError::NotFinite { vertex });
        }
        match self {
            Self::Interpolate { normal, .. } if unit(normal).is_none() => {
                Err(FitError::Normal { vertex })
            }
            _ => Ok(()),
        }
    }
}

/// Returns the direction of a vector that has one.
pub(crate) fn unit(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = vector.amax();
    (largest > 0.0 && vector.iter().all(|c| c.is_finite())).then(|| (vector / largest).normalize())
}

/// Returns two unit vectors that are a right-handed frame with a unit normal.
pub(crate) fn tangents(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let axis = Vector3::ith(normal.iamin(), 1.0);
    let first = normal.cross(&axis).normalize();
    [first, normal.cross(&first)]
}

pub(super) fn check(domain: &FlatDomain, data: &[VertexCondition]) -> Result<(), FitError> {
    let vertices = domain.mesh().vertex_count();
    if data.len() != vertices {
        return Err(FitError::DataCount {
            found: data.len(),
            vertices,
        });
    }
    for (vertex, datum) in data.iter().enumerate() {
        datum.check(vertex as u32)?;
    }
    let (labels, components) = domain.topology().components();
    let mut held = vec![false; components as usize];
    for (label, datum) in labels.iter().zip(data) {
        held[*label as usize] |= datum.position().is_some();
    }
    let loose = labels.iter().position(|&label| !held[label as usize]);
    loose.map_or(Ok(()), |v| {
        Err(FitError::ComponentWithoutPosition { vertex: v as u32 })
    })
}

/// Value and derivatives of three components: `[value, u, v][component]`.
pub(super) type Numbers = [[f64; 3]; 3];

/// The numbers at all vertices as an affine function of the unknowns.
pub(super) struct Unknowns {
    /// First unknown of every vertex, and their number.
    pub(super) starts: Vec<u32>,
    /// What each unknown does at its vertex.
    pub(super) columns: Vec<Numbers>,
    /// Numbers at every vertex when all unknowns are zero.
    pub(super) base: Vec<Numbers>,
    /// By which lengths gradients are multiplied, so that all unknowns are lengths.
    pub(super) lengths: Vec<f64>,
}

impl Unknowns {
    pub(super) fn new(domain: &FlatDomain, data: &[VertexCondition]) -> Self {
        let mut unknowns = Self {
            starts: vec![0],
            columns: Vec::new(),
            base: Vec::new(),
            lengths: Vec::new(),
        };
        for (vertex, datum) in data.iter().enumerate() {
            let length = domain.mean_edge_length(vertex as u32);
            let position = domain.mesh().positions()[vertex];
            let position = datum.position().unwrap_or(position).into();
            let gradient = match datum {
                VertexCondition::Fixed { gradient, .. } => gradient.map(Into::into),
                _ => [[0.0; 3]; 2],
            };
            unknowns.add_columns(datum, length);
            unknowns.starts.push(unknowns.columns.len() as u32);
            unknowns.base.push([position, gradient[0], gradient[1]]);
            unknowns.lengths.push(length);
        }
        unknowns
    }

    /// Adds what is free at a vertex: along `t` in direction `p` for tangents, else by component.
    fn add_columns(&mut self, datum: &VertexCondition, length: f64) {
        let mut push = |kind: usize, vector: Vector3<f64>| {
            let mut column = [[0.0; 3]; 3];
            let scale = if kind == 0 { 1.0 } else { 1.0 / length };
            column[kind] = (scale * vector).into();
            self.columns.push(column);
        };
        let kinds = match datum {
            VertexCondition::Interpolate { normal, .. } => {
                let normal = unit(normal).unwrap_or_default();
                for tangent in tangents(&normal) {
                    (1..3).for_each(|kind| push(kind, tangent));
                }
                0..0
            }
            VertexCondition::Position { .. } => 1..3,
            VertexCondition::Fixed { .. } => 0..0,
            VertexCondition::Free => 0..3,
        };
        for kind in kinds {
            (0..3).for_each(|component| push(kind, Vector3::ith(component, 1.0)));
        }
    }

    pub(super) fn count(&self) -> usize {
        self.columns.len()
    }

    /// Returns the unknowns of a vertex.
    pub(super) fn range(&self, vertex: u32) -> std::ops::Range<usize> {
        self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize
    }

    /// Returns the numbers at a vertex.
    pub(super) fn numbers(&self, vertex: u32, x: &[f64]) -> Numbers {
        let mut numbers = self.base[vertex as usize];
        for k in self.range(vertex) {
            for (row, column) in numbers.iter_mut().zip(&self.columns[k]) {
                row.iter_mut()
                    .zip(column)
                    .for_each(|(sum, value)| *sum += x[k] * value);
            }
        }
        numbers
    }
}
