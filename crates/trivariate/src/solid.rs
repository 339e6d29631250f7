//! From a solid to its spline, in one call.

use msplines_common::progress::{Observer, Outcome};

use crate::domain::{Deviation, Domain, DomainError, Solid};
use crate::error::FitError;
use crate::fit::certified::{self, CertifiedFit};
use crate::fit::least_squares::{self, LeastSquaresFit};
use crate::fit::multilevel::{self, MultilevelFit};
pub use crate::options::Fitting;
pub use crate::options::Solid as Options;
use crate::spline::TrivariateSpline;

/// Why a solid has no spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// It has no map to the cube.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// Its samples could not be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// A spline of a solid, and how it came about.
#[derive(Clone, Debug)]
pub struct SolidFit {
    /// The map that it was fitted by.
    pub domain: Domain,
    /// How samples were fitted.
    pub fitted: Fitted,
    /// Distances from points that were not fitted.
    pub deviation: Deviation,
}

/// A fit of either kind.
#[derive(Clone, Debug)]
pub enum Fitted {
    /// By multilevel B-splines.
    Multilevel(MultilevelFit),
    /// By least squares.
    LeastSquares(LeastSquaresFit),
    /// By least squares, proved not to fold.
    Certified(CertifiedFit),
}

impl Fitted {
    /// The spline.
    #[must_use]
    pub fn spline(&self) -> &TrivariateSpline {
        match self {
            Self::Multilevel(fit) => &fit.spline,
            Self::LeastSquares(fit) => &fit.spline,
            Self::Certified(fit) => &fit.spline,
        }
    }

    /// How it ended.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        match self {
            Self::Multilevel(fit) => fit.outcome,
            Self::LeastSquares(fit) => fit.outcome,
            Self::Certified(fit) => fit.report.outcome,
        }
    }
}

/// Returns the spline of a solid.
///
/// ```
/// use msplines_common::mesh::shapes;
/// use msplines_common::progress::unobserved;
/// use msplines_trivariate::domain::{Sampling, Solid};
/// use msplines_trivariate::solid;
///
/// let sphere = shapes::sphere(500);
/// let options = solid::Options {
///     sampling: Sampling::Even { interior: 20_000, surface: 10_000, surface_weight: 1.0 },
///     ..Default::default()
/// };
/// let fit = solid::fit(Solid::Surface(&sphere), &options, &mut unobserved())?;
/// assert_eq!(fit.domain.map().report.quality.flipped, 0);
/// assert!(fit.deviation.surface_rms < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Reference
/// [Kim2014] §3. Deviation: maps without folds, least squares, certificates.
///
/// # Errors
/// A solid that has no map to the cube, or samples that cannot be fitted.
pub fn fit(
    solid: Solid<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<SolidFit, SolidError> {
    let domain = Domain::build(solid, &options.domain, observer)?;
    let samples = domain.samples(&options.sampling)?;
    let fitted = match &options.fitting {
        Fitting::Multilevel(options) => {
            Fitted::Multilevel(multilevel::fit(&samples, options, observer)?)
        }
        Fitting::LeastSquares(options) => {
            Fitted::LeastSquares(least_squares::fit(&samples, options, observer)?)
        }
        Fitting::Certified(options) => {
            Fitted::Certified(certified::fit(&samples, options, observer)?)
        }
    };
    let deviation = domain.deviation(fitted.spline());
    Ok(SolidFit {
        domain,
        fitted,
        deviation,
    })
}
