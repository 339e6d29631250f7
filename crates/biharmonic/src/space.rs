//! What all splines on one mesh share: operators, their elimination orders, their factors.

use std::sync::{Arc, OnceLock};

use msplines_common::linalg::{Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{SplitMesh, SurfacePoint, TriangleMesh, split_at};
use msplines_common::operators::intrinsic::intrinsic_delaunay;
use msplines_common::operators::{Operators, Poisson, assemble, mesh_operators};

use crate::{Creases, FitError, Laplacian};

/// The space of biharmonic B-splines on one mesh, whatever their knots.
///
/// Everything that depends on the mesh alone is computed once, on first use: the bi-Laplacian and its
/// elimination order (for fitting), the factor of the Laplacian (for evaluation).
#[derive(Debug)]
pub struct Space {
    domain: Arc<TriangleMesh>,
    /// How the mesh lies on the domain, where knots have become vertices.
    split: Option<SplitMesh>,
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
        Self::on(Arc::clone(&mesh), None, mesh, laplacian, creases)
    }

    /// Builds the space of splines whose knots may be these points of a connected mesh, and returns
    /// the vertex of the split mesh that each point has become.
    ///
    /// Faces are split there; the surface stays as it is. Creases are edges of the unsplit mesh.
    ///
    /// # Reference
    /// [Hou2017] §5. Deviation: several points in one face are triangulated by constrained Delaunay.
    ///
    /// # Errors
    /// Points that are not on the mesh, or a mesh of several components or with faces without area.
    pub fn with_points(
        domain: Arc<TriangleMesh>,
        points: &[SurfacePoint],
        laplacian: Laplacian,
        creases: &Creases,
    ) -> Result<(Self, Vec<u32>), FitError> {
        let split = split_at(&domain, points)?;
        let (vertices, pieces) = (split.vertices.clone(), split.edges(creases.edges()));
        Ok((Self::on_split(domain, split, laplacian, &pieces)?, vertices))
    }

    /// Builds the space again that had these [`Self::added_points`] and creases.
    ///
    /// # Errors
    /// As [`Self::with_points`].
    pub fn split_at(
        domain: Arc<TriangleMesh>,
        points: &[SurfacePoint],
        laplacian: Laplacian,
        creases: &[[u32; 2]],
    ) -> Result<Self, FitError> {
        let split = split_at(&domain, points)?;
        Self::on_split(domain, split, laplacian, creases)
    }

    fn on_split(
        domain: Arc<TriangleMesh>,
        split: SplitMesh,
        laplacian: Laplacian,
        creases: &[[u32; 2]],
    ) -> Result<Self, FitError> {
        let mesh = Arc::new(split.mesh.clone());
        let creases = Creases::along(&mesh, creases)?;
        Self::on(domain, Some(split), mesh, laplacian, creases)
    }

    fn on(
        domain: Arc<TriangleMesh>,
        split: Option<SplitMesh>,
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
            domain,
            split,
            mesh,
            laplacian,
            creases,
            operators,
            bilaplacian: OnceLock::new(),
            poisson: OnceLock::new(),
        })
    }

    /// Returns the mesh that data belong to and that addresses points.
    #[must_use]
    pub fn domain(&self) -> &Arc<TriangleMesh> {
        &self.domain
    }

    /// Returns the places on the domain of the vertices that the mesh has beyond it.
    #[must_use]
    pub fn added_points(&self) -> &[SurfacePoint] {
        self.split.as_ref().map_or(&[], |split| &split.places)
    }

    /// Returns the place on the mesh of a point of the domain.
    pub(crate) fn locate(&self, point: SurfacePoint) -> SurfacePoint {
        match &self.split {
            Some(split) => split.locate(point),
            None => point,
        }
    }

    /// Returns the mesh whose vertices can be knots: the domain, with some of its points as further
    /// vertices.
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
        // The order of the bi-Laplacian would do, but a spline from a file, whose space has none, is to
        // have the same bits.
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
