//! What all splines on one mesh share: operators, their elimination orders, their factors.

use std::sync::{Arc, OnceLock};

use msplines_common::linalg::{Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::intrinsic_delaunay;
use msplines_common::operators::{Operators, Poisson, assemble, mesh_operators};

use crate::{Creases, FitError, Laplacian};

/// The space of biharmonic B-splines on one mesh, whatever their knots.
///
/// Everything that depends on the mesh alone is computed once, on first use: the bi-Laplacian and its
/// elimination order (for fitting), the factor of the Laplacian (for evaluation).
#[derive(Debug)]
pub struct Space {
    mesh: Arc<TriangleMesh>,
    laplacian: Laplacian,
    creases: Creases,
    operators: Operators,
    bilaplacian: OnceLock<Bilaplacian>,
    poisson: OnceLock<Poisson>,
}

/// What makes two spaces different.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Difference {
    Mesh,
    Laplacian,
    Creases,
}

/// The bi-Laplacian of a mesh, and what the factorisations of all its submatrices share.
#[derive(Debug)]
pub struct Bilaplacian {
    /// `B = L A⁻¹ L`, or the energy of splines with creases.
    pub matrix: SymmetricMatrix,
    /// A fill-reducing elimination order.
    pub ordering: Ordering,
    /// The analysis of the whole matrix.
    pub symbolic: Arc<Symbolic>,
}

impl Space {
    /// Builds the space of smooth splines on a connected mesh.
    ///
    /// # Errors
    /// A mesh of several components, or with faces without area.
    pub fn build(mesh: Arc<TriangleMesh>, laplacian: Laplacian) -> Result<Self, FitError> {
        Self::with_creases(mesh, laplacian, Creases::none())
    }

    /// Builds the space of splines that need not be smooth across some edges of a connected mesh.
    ///
    /// # Errors
    /// A mesh of several components, or with faces without area.
    pub fn with_creases(
        mesh: Arc<TriangleMesh>,
        laplacian: Laplacian,
        creases: Creases,
    ) -> Result<Self, FitError> {
        let components = mesh.topology().components().1;
        if components != 1 {
            return Err(FitError::NotConnected { components });
        }
        let operators = operators(&mesh, laplacian)?;
        Ok(Self {
            mesh,
            laplacian,
            creases,
            operators,
            bilaplacian: OnceLock::new(),
            poisson: OnceLock::new(),
        })
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// Returns the kind of Laplacian.
    #[must_use]
    pub fn laplacian(&self) -> Laplacian {
        self.laplacian
    }

    /// Returns the creases.
    #[must_use]
    pub fn creases(&self) -> &Creases {
        &self.creases
    }

    /// Returns the first way in which the splines of another space differ, none if they are the same.
    pub(crate) fn difference(&self, other: &Self) -> Option<Difference> {
        if std::ptr::eq(self, other) {
            return None;
        }
        let same_mesh = Arc::ptr_eq(&self.mesh, &other.mesh)
            || self.mesh.faces() == other.mesh.faces()
                && self.mesh.positions() == other.mesh.positions();
        if !same_mesh {
            Some(Difference::Mesh)
        } else if self.laplacian != other.laplacian {
            Some(Difference::Laplacian)
        } else if self.creases != other.creases {
            Some(Difference::Creases)
        } else {
            None
        }
    }

    /// Returns the Laplacian and the vertex areas.
    #[must_use]
    pub fn operators(&self) -> &Operators {
        &self.operators
    }

    /// Returns `B = L A⁻¹ L` and what its factorisations share.
    ///
    /// # Errors
    /// A mesh too large to be ordered.
    pub fn bilaplacian(&self) -> Result<&Bilaplacian, FitError> {
        if let Some(ready) = self.bilaplacian.get() {
            return Ok(ready);
        }
        let matrix = energy(&self.mesh, &self.operators, &self.creases);
        let ordering = Ordering::nested_dissection(&matrix)?;
        let symbolic = Arc::new(Symbolic::analyze(&matrix, &ordering));
        Ok(self.bilaplacian.get_or_init(|| Bilaplacian {
            matrix,
            ordering,
            symbolic,
        }))
    }

    /// Returns the factored Laplacian.
    ///
    /// # Errors
    /// A Laplacian that is not positive semidefinite.
    pub fn poisson(&self) -> Result<&Poisson, FitError> {
        if let Some(ready) = self.poisson.get() {
            return Ok(ready);
        }
        let poisson = Poisson::factor(&self.operators)?;
        Ok(self.poisson.get_or_init(|| poisson))
    }

    /// Returns the Green's coefficients `L A⁻¹ L f` of a function, of zero sum, whatever the creases.
    ///
    /// # Reference
    /// [Hou2017] Alg. 3.
    #[must_use]
    pub fn coefficients(&self, f: &Mat<f64>) -> Mat<f64> {
        let mut flux = self.operators.laplacian.multiply(f.as_ref());
        for side in 0..flux.ncols() {
            for (row, area) in self.operators.mass.iter().enumerate() {
                flux[(row, side)] /= area;
            }
        }
        self.operators.laplacian.multiply(flux.as_ref())
    }
}

/// Returns the matrix whose minima with given values are splines.
pub(crate) fn energy(
    mesh: &TriangleMesh,
    operators: &Operators,
    creases: &Creases,
) -> SymmetricMatrix {
    if creases.is_empty() {
        operators.bilaplacian()
    } else {
        creases.energy(mesh, operators)
    }
}

pub(crate) fn operators(mesh: &TriangleMesh, laplacian: Laplacian) -> Result<Operators, FitError> {
    let operators = match laplacian {
        Laplacian::Cotangent => mesh_operators(mesh),
        Laplacian::IntrinsicDelaunay => {
            let intrinsic = intrinsic_delaunay(mesh)?;
            assemble(mesh.vertex_count(), &intrinsic.faces, &intrinsic.lengths)
        }
    };
    for (vertex, &area) in operators.mass.iter().enumerate() {
        let finite = operators
            .laplacian
            .column(vertex)
            .all(|(_, value)| value.is_finite());
        if !(area > 0.0 && area.is_finite() && finite) {
            return Err(FitError::DegenerateGeometry { vertex, area });
        }
    }
    Ok(operators)
}
