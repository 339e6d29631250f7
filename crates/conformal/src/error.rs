//! Why a surface has no atlas of the kind asked for.

use msplines_common::mesh::{SplitError, TopologyError};
use msplines_common::operators::PoissonError;
use msplines_common::operators::intrinsic::IntrinsicError;
use msplines_common::progress::Stopped;

use crate::bounded::{BoundedError, PunctureError};
use crate::disk::DiskError;
use crate::poles::PolesError;
use crate::sphere::SphereError;

/// Why no holomorphic 1-form or atlas could be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConformalError {
    /// The surface has a boundary.
    #[error(
        "the surface has {loops} boundary loops, one through vertex {vertex}; forms of a closed surface were asked for: use the forms of bounded surfaces, or fill the holes"
    )]
    Boundary {
        /// Number of loops.
        loops: usize,
        /// A vertex on the first one.
        vertex: u32,
    },
    /// The surface has several components.
    #[error("the surface has {components} components; keep one of them")]
    NotConnected {
        /// Number of components.
        components: u32,
    },
    /// A sphere has no holomorphic 1-form.
    #[error(
        "a closed surface of genus 0 has no holomorphic 1-form; remove the star of a vertex (--puncture), or use the spherical map"
    )]
    NoForm,
    /// Stars that cannot be removed.
    #[error(transparent)]
    Puncture(#[from] PunctureError),
    /// No conformal map of the disk.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// No conformal map to the sphere.
    #[error(transparent)]
    Sphere(#[from] SphereError),
    /// No form of a surface with boundary.
    #[error(transparent)]
    Bounded(#[from] BoundedError),
    /// No form with poles.
    #[error(transparent)]
    Poles(#[from] PolesError),
    /// Edge values that are not differences of a function up to integers.
    #[error(
        "the imaginary part of the form is {defect} away from an integer at vertex {vertex}; ask for a form with integer periods"
    )]
    NotIntegral {
        /// A vertex of the edge.
        vertex: u32,
        /// How far.
        defect: f64,
    },
    /// The observer asked to stop before there was an atlas.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// Faces that cannot be split.
    #[error(transparent)]
    Split(#[from] SplitError),
    /// Boundary loops that cannot be filled, because they touch.
    #[error("the boundary loops cannot be filled by cones: {0}")]
    Filled(#[from] TopologyError),
    /// No intrinsic triangulation.
    #[error(transparent)]
    Intrinsic(#[from] IntrinsicError),
    /// The Laplacian cannot be factored.
    #[error(transparent)]
    Poisson(#[from] PoissonError),
    /// The wedge products of the integer forms are singular to rounding, which they never are.
    #[error(
        "the intersection matrix of {classes} classes has determinant {determinant}, not 1; the coordinates span too many orders of magnitude"
    )]
    Intersections {
        /// Number of classes.
        classes: usize,
        /// The determinant found.
        determinant: f64,
    },
    /// The number of coefficients or periods is not that of the classes.
    #[error(
        "{given} numbers were given for the {needed} classes of a surface of genus {genus}; give as many"
    )]
    ClassCount {
        /// How many were given.
        given: usize,
        /// How many are needed.
        needed: usize,
        /// Number of handles.
        genus: usize,
    },
    /// All coefficients or periods are zero.
    #[error("all coefficients of the form are zero; give at least one that is not")]
    ZeroForm,
    /// Triangles stay folded away from the zeros however often the mesh is refined there.
    #[error(
        "{flips} triangles are folded away from the zeros, one at vertex {vertex}, after {rounds} local refinements; the mesh is too coarse or too thin there: remesh it, or choose another form"
    )]
    Folded {
        /// Number of folded triangles.
        flips: usize,
        /// A vertex of one.
        vertex: u32,
        /// Refinements tried.
        rounds: usize,
    },
    /// The form that was asked for cannot be laid out, and no other one was to be tried.
    #[error(
        "the form asked for folds {flips} of {faces} faces away from its zeros, the first at vertex {vertex}, after {rounds} local refinements, and its lengths spread over a factor of {spread:.1e}: it fades over a part of the surface; let the form be chosen (leave out --form), or ask for one of more even length"
    )]
    Unsuited {
        /// Number of folded faces, and of vertices at which the form is no zero and no regular point.
        flips: usize,
        /// Faces laid out.
        faces: usize,
        /// A vertex of one.
        vertex: u32,
        /// Refinements tried.
        rounds: usize,
        /// 99th over 1st percentile of the lengths of the form, over the area of the surface.
        spread: f64,
    },
    /// Zeros lie too close together, or too close to a boundary, to be cut out one by one.
    #[error(
        "the zero of the form at vertex {vertex} cannot be cut out as a disk after {rounds} local refinements; the mesh is too coarse for its topology there: refine it, or choose another form"
    )]
    TooCoarse {
        /// A vertex of the zero.
        vertex: u32,
        /// Refinements tried.
        rounds: usize,
    },
}

impl ConformalError {
    /// Returns whether the observer asked to stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(
            self,
            Self::Stopped(_)
                | Self::Disk(DiskError::Stopped(_))
                | Self::Sphere(SphereError::Stopped(_))
                | Self::Bounded(BoundedError::Stopped(_))
        )
    }
}
