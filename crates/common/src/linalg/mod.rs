//! Sparse symmetric linear algebra: factor once, solve many.
//!
//! [`SymmetricMatrix`] holds a matrix, [`Ordering`] a fill-reducing order of its rows, [`Symbolic`]
//! what the pattern alone decides, [`Cholesky`] the numbers. Rows can be left out of a
//! factorisation (constrained unknowns, a grounded vertex) without building another matrix.
//! An ordering by nested dissection is computed once for a mesh and reused for every principal submatrix;
//! one by minimum degree is for a few factorisations.
//!
//! Dense kernels are faer's, always run sequentially; parallelism is over subtrees of the
//! elimination tree, whose results are combined in a fixed order. The bits of a result do not depend
//! on the number of threads.

mod cg;
mod cholesky;
mod dense;
mod etree;
mod kernels;
mod ordering;
mod solve;
mod sparse;
mod symbolic;
#[cfg(test)]
mod tests;
mod tiles;

pub use cg::{CgReport, CgTolerance, conjugate_gradient};
pub use cholesky::{Cholesky, FactorError};
pub use dense::{column, column_mut};
pub use ordering::{Ordering, OrderingError};
pub use sparse::SymmetricMatrix;
pub use symbolic::Symbolic;

pub use faer::{Mat, MatMut, MatRef};
