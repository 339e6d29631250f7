//! The function of a single chart, from scattered samples.
//!
//! What a fit does on every chart, for itself: a height above the chart is a combination of a few atoms
//! of a dictionary, or of all of them by least squares.
//!
//! # Notation
//! `A` has a row for each sample and a column for each atom, `t` holds the samples.

use faer::Mat;

use crate::dictionary::{Atom, DEGREE, Dictionary, DictionaryKind};
use crate::domain::Star;
use crate::fit::MOST_VALENCE;
use crate::fit::charts::default_degree;
use crate::fit::state::dictionary;
use crate::options::Local;
use crate::pursuit::{Found, Problem, Selection, Workspace, pursue};

/// Singular values below this fraction of the largest count as zero in least squares.
const RANK_TOLERANCE: f64 = 1e-12;

/// A point of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartPoint {
    /// The sector that it lies in.
    pub sector: u32,
    /// Its corner coordinates there, in the unit square.
    pub at: [f64; 2],
}

/// A function of a chart: a combination of atoms.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalFunction {
    star: Star,
    kind: DictionaryKind,
    degree: u32,
    support: Vec<u16>,
    coefficients: Vec<f64>,
}

/// Why there is no function.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocalError {
    /// Not as many values as points.
    #[error("{values} values at {points} points; give one for each, and at least one")]
    WrongLength {
        /// Number of values.
        values: usize,
        /// Number of points.
        points: usize,
    },
    /// A point that is not in the chart, or a number that is none.
    #[error(
        "sample {index} is not finite or outside of the chart; corner coordinates lie in [0, 1], sectors below the valence"
    )]
    Sample {
        /// Which one.
        index: usize,
    },
    /// A degree out of range.
    #[error("polynomials of degree {degree}; ask for 0 to 14")]
    Degree {
        /// What was asked for.
        degree: u32,
    },
    /// A star that no chart has.
    #[error("a chart of {sectors} of {valence} sectors; give 1 to {most}, no more than close it")]
    Star {
        /// Number of its sectors.
        sectors: u32,
        /// How many would close it.
        valence: u32,
        /// How many a chart takes.
        most: u32,
    },
    /// An atom that the dictionary does not have.
    #[error("atom {atom} of a dictionary of {atoms}; it is damaged, fit again")]
    NoSuchAtom {
        /// The atom.
        atom: u16,
        /// How many there are.
        atoms: usize,
    },
    /// Not a finite coefficient for every atom.
    #[error("{atoms} atoms, each of which needs one finite coefficient; it is damaged, fit again")]
    Coefficients {
        /// How many atoms there are.
        atoms: usize,
    },
}

/// Returns the function of a chart that `local` finds for values at points.
///
/// Pursuits choose one atom after the other; least squares take the whole dictionary, and of all best
/// combinations the one of least coefficients. Cost: samples × atoms² at most.
///
/// ```
/// use msplines_sparse_manifold::{ChartPoint, Local, Star, fit_local};
///
/// let star = Star { sectors: 5, valence: 5 };
/// let cells = |sector| (0..64).map(move |i| (sector, [f64::from(i % 8) / 7.0, f64::from(i / 8) / 7.0]));
/// let points: Vec<ChartPoint> =
///     (0..5).flat_map(cells).map(|(sector, at)| ChartPoint { sector, at }).collect();
/// let values: Vec<f64> = points
///     .iter()
///     .map(|p| star.position(p.sector, p.at))
///     .map(|[x, y]| 1.0 + x * y)
///     .collect();
/// let found = fit_local(star, &points, &values, Local::Polynomial { degree: Some(5) })?;
/// assert!((found.value(points[9]) - values[9]).abs() < 1e-12);
/// # Ok::<(), msplines_sparse_manifold::LocalError>(())
/// ```
///
/// # Reference
/// [Wang2016] Eq. (3), §4.2 (Figures 2 and 4).
///
/// # Errors
/// A star that no chart has; samples that are not in the chart or not finite; a degree out of range.
pub fn fit_local(
    star: Star,
    points: &[ChartPoint],
    values: &[f64],
    local: Local,
) -> Result<LocalFunction, LocalError> {
    check_star(star)?;
    check(star, points, values)?;
    let (kind, degree) = dictionary(local);
    let degree = degree.unwrap_or_else(|| default_degree(star));
    if degree > DEGREE {
        return Err(LocalError::Degree { degree });
    }
    let atoms = Dictionary::new(kind, degree, star);
    let columns = atoms.atoms().len();
    let mut matrix = Mat::zeros(points.len(), columns);
    for (row, point) in points.iter().enumerate() {
        for (column, value) in atoms.values(point.sector, point.at).into_iter().enumerate() {
            matrix[(row, column)] = value;
        }
    }
    let data = Mat::from_fn(values.len(), 1, |row, _| values[row]);
    let (support, coefficients) = match local {
        Local::Sparse {
            sparsity,
            selection,
            ..
        } => {
            let found = pursued(&matrix, &data, selection, sparsity as usize);
            (found.support, found.coefficients)
        }
        Local::Polynomial { .. } | Local::Spline => {
            ((0..columns as u16).collect(), least_squares(&matrix, &data))
        }
    };
    Ok(LocalFunction {
        star,
        kind,
        degree,
        support,
        coefficients,
    })
}

fn pursued(matrix: &Mat<f64>, data: &Mat<f64>, selection: Selection, sparsity: usize) -> Found {
    let atoms = matrix.ncols();
    let product = matrix.transpose() * matrix;
    // Rounding of the two triangles may differ.
    let gram: Vec<f64> = (0..atoms)
        .flat_map(|i| (0..atoms).map(move |j| (i.max(j), i.min(j))))
        .map(|at| product[at])
        .collect();
    let correlations = matrix.transpose() * data;
    let alpha: Vec<f64> = (0..atoms).map(|i| correlations[(i, 0)]).collect();
    let problem = Problem {
        gram: &gram,
        components: 1,
        alpha: &alpha,
        allowed: &vec![true; atoms],
    };
    pursue(problem, selection, sparsity, &mut Workspace::default())
}

fn check(star: Star, points: &[ChartPoint], values: &[f64]) -> Result<(), LocalError> {
    if points.len() != values.len() || points.is_empty() {
        return Err(LocalError::WrongLength {
            values: values.len(),
            points: points.len(),
        });
    }
    let inside = |point: &ChartPoint| {
        point.sector < star.sectors && point.at.iter().all(|c| (0.0..=1.0).contains(c))
    };
    let bad = points
        .iter()
        .zip(values)
        .position(|(point, value)| !inside(point) || !value.is_finite());
    match bad {
        Some(index) => Err(LocalError::Sample { index }),
        None => Ok(()),
    }
}

/// Returns the shortest of all best solutions.
fn least_squares(matrix: &Mat<f64>, data: &Mat<f64>) -> Vec<f64> {
    // The columns differ in length by orders of magnitude; what is shortest is meant in units of them.
    let lengths: Vec<f64> = (0..matrix.ncols())
        .map(|j| matrix.col(j).norm_l2().max(f64::MIN_POSITIVE))
        .collect();
    let scaled = Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        matrix[(i, j)] / lengths[j]
    });
    let Ok(svd) = scaled.thin_svd() else {
        // Only numbers that are not finite bring it to this, and those were refused.
        return vec![0.0; matrix.ncols()];
    };
    let (u, sizes, v) = (svd.U(), svd.S().column_vector(), svd.V());
    let projected = u.transpose() * data;
    let largest = sizes.iter().fold(0.0f64, |a, &b| a.max(b));
    let divided = Mat::from_fn(sizes.nrows(), 1, |i, _| {
        if sizes[i] > RANK_TOLERANCE * largest {
            projected[(i, 0)] / sizes[i]
        } else {
            0.0
        }
    });
    let solution = v * divided;
    lengths
        .iter()
        .enumerate()
        .map(|(j, length)| solution[(j, 0)] / length)
        .collect()
}

fn check_star(Star { sectors, valence }: Star) -> Result<(), LocalError> {
    if (1..=valence).contains(&sectors) && valence <= MOST_VALENCE {
        return Ok(());
    }
    Err(LocalError::Star {
        sectors,
        valence,
        most: MOST_VALENCE,
    })
}

impl LocalFunction {
    /// Returns the function of these atoms of a dictionary.
    ///
    /// # Errors
    /// A star or degree that no chart has; atoms that the dictionary does not have, or not a finite coefficient
    /// for each.
    pub fn from_parts(
        star: Star,
        kind: DictionaryKind,
        degree: u32,
        support: Vec<u16>,
        coefficients: Vec<f64>,
    ) -> Result<Self, LocalError> {
        if degree > DEGREE {
            return Err(LocalError::Degree { degree });
        }
        check_star(star)?;
        let atoms = Dictionary::new(kind, degree, star).atoms().len();
        if let Some(&atom) = support.iter().find(|&&atom| usize::from(atom) >= atoms) {
            return Err(LocalError::NoSuchAtom { atom, atoms });
        }
        let finite = coefficients.iter().all(|c| c.is_finite());
        if support.len() != coefficients.len() || !finite {
            let atoms = support.len();
            return Err(LocalError::Coefficients { atoms });
        }
        Ok(Self {
            star,
            kind,
            degree,
            support,
            coefficients,
        })
    }

    /// Returns the shape of the chart.
    #[must_use]
    pub fn star(&self) -> Star {
        self.star
    }

    /// Returns the dictionary, and the largest degree of its monomials.
    #[must_use]
    pub fn made_of(&self) -> (DictionaryKind, u32) {
        (self.kind, self.degree)
    }

    /// Returns the numbers of its atoms in the dictionary, in the order in which they were chosen.
    #[must_use]
    pub fn support(&self) -> &[u16] {
        &self.support
    }

    /// Returns the coefficient of each atom.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns its atoms, in the order in which they were chosen.
    #[must_use]
    pub fn atoms(&self) -> Vec<Atom> {
        let dictionary = Dictionary::new(self.kind, self.degree, self.star);
        let atoms = dictionary.atoms();
        self.support
            .iter()
            .map(|&atom| atoms[usize::from(atom)])
            .collect()
    }

    /// Returns the value of each of its atoms at a point, without coefficients.
    #[must_use]
    pub fn atom_values(&self, point: ChartPoint) -> Vec<f64> {
        let dictionary = Dictionary::new(self.kind, self.degree, self.star);
        let values = dictionary.values(point.sector, point.at);
        self.support
            .iter()
            .map(|&atom| values[usize::from(atom)])
            .collect()
    }

    /// Returns its value at a point.
    #[must_use]
    pub fn value(&self, point: ChartPoint) -> f64 {
        let values = self.atom_values(point);
        let terms = values.iter().zip(&self.coefficients);
        terms.map(|(value, coefficient)| value * coefficient).sum()
    }
}
