//! From control points to splines and back, and control points moved.

use msplines_common::linalg::Mat;

use super::{ExplicitBasis, ExplicitError, Rule};
use crate::{BiharmonicSpline, Form, combine};

/// Corrections of the coefficients found from values. The first takes the error from 1e-10 to that of
/// a solve with the Laplacian.
const CORRECTIONS: u32 = 2;

impl ExplicitBasis {
    /// Returns the control points (K × d, knot after knot) of a spline.
    ///
    /// # Reference
    /// [Hou2017] Eq. (8), Theorem 1. Deviation: `P λ = f(T)` is solved, with the values at the knots;
    /// Eq. (8) follows from it by `N = S_T P` and `c_j` the mean of `ψ_j`, and has the condition of the
    /// bi-Laplacian. Difference masks solve Eq. (8) itself.
    ///
    /// # Errors
    /// A spline of another space or with other knots, or one that cannot be evaluated.
    pub fn control_points(&self, spline: &BiharmonicSpline) -> Result<Vec<f64>, ExplicitError> {
        self.check_spline(spline)?;
        let (dimension, offset) = (spline.dimension(), spline.offset());
        let found = match &self.rule {
            Rule::Mixture(mixture) => {
                let f = spline.at_vertices()?;
                let values = Mat::from_fn(self.knots.len(), dimension, |k, c| {
                    f[(self.knots[k] as usize, c)]
                });
                let mut found = mixture.unmix(values.as_ref());
                for (c, offset) in offset.iter().enumerate() {
                    (0..found.nrows()).for_each(|k| found[(k, c)] += offset);
                }
                found
            }
            Rule::Masks(masks) => {
                let Form::Implicit { coefficients, .. } = spline.form() else {
                    return Err(ExplicitError::Creases);
                };
                masks.control_points(matrix(coefficients, dimension).as_ref(), &offset)
            }
        };
        let row = |k: usize| (0..dimension).map(move |c| (k, c));
        Ok((0..self.knots.len())
            .flat_map(row)
            .map(|at| found[at])
            .collect())
    }

    /// Returns the spline with these control points (K × d, knot after knot).
    ///
    /// # Reference
    /// [Hou2017] Eq. (4), Eq. (5), §7.2. Deviation: by the values `P λ` at the knots.
    ///
    /// # Errors
    /// Numbers that are too few or too many, or not finite.
    pub fn spline(
        &self,
        control_points: &[f64],
        dimension: usize,
    ) -> Result<BiharmonicSpline, ExplicitError> {
        let expected = self.knots.len() * dimension.max(1);
        check_numbers(control_points, expected)?;
        let mut points = matrix(control_points, dimension);
        match &self.rule {
            Rule::Mixture(mixture) => {
                let means = take_means(&mut points);
                self.of_knot_values(&mixture.mix(points.as_ref()), &means)
            }
            Rule::Masks(masks) => {
                let (coefficients, constant) = masks.implicit(points.as_ref());
                self.implicit(&coefficients, constant)
            }
        }
    }

    /// Returns a spline after some of its control points are moved: pairs of an index and a
    /// displacement of one number per component.
    ///
    /// By linearity nothing is converted: the displacements make a spline of their own, which is
    /// added. One solve.
    ///
    /// # Reference
    /// [Hou2017] §7.2, Figure 8. Deviation: by the values `P λ` at the knots.
    ///
    /// # Errors
    /// A spline of another space or with other knots, a control point that does not exist, or a
    /// displacement that is no vector of the spline's dimension.
    pub fn edit(
        &self,
        spline: &BiharmonicSpline,
        moves: &[(usize, Vec<f64>)],
    ) -> Result<BiharmonicSpline, ExplicitError> {
        self.check_spline(spline)?;
        let dimension = spline.dimension();
        let mut shift = Mat::<f64>::zeros(self.knots.len(), dimension);
        for (index, displacement) in moves {
            self.check_function(*index)?;
            check_numbers(displacement, dimension)?;
            for (c, value) in displacement.iter().enumerate() {
                shift[(*index, c)] += value;
            }
        }
        let change = match &self.rule {
            Rule::Mixture(mixture) => {
                self.of_knot_values(&mixture.mix(shift.as_ref()), &vec![0.0; dimension])?
            }
            Rule::Masks(masks) => {
                let (coefficients, constant) = masks.implicit(shift.as_ref());
                self.implicit(&coefficients, constant)?
            }
        };
        Ok(combine(&[(spline, 1.0), (&change, 1.0)])?)
    }

    /// Returns the spline with these values at the knots, less `means`.
    ///
    /// Coefficients are second differences of the second differences of values, which costs digits;
    /// what the spline then misses at the knots is made good by another one.
    fn of_knot_values(
        &self,
        values: &Mat<f64>,
        means: &[f64],
    ) -> Result<BiharmonicSpline, ExplicitError> {
        let system = self.system()?;
        let take = |values: &Mat<f64>, means: &[f64]| {
            let f = system.extend(values.as_ref());
            BiharmonicSpline::of_vertex_values(&self.space, self.knots.clone(), &f, means)
        };
        let mut found = take(values, means);
        if !self.space.creases().is_empty() {
            return Ok(found);
        }
        for _ in 0..CORRECTIONS {
            let (f, offset) = (found.at_vertices()?, found.offset());
            let missed = Mat::from_fn(values.nrows(), values.ncols(), |k, c| {
                values[(k, c)] - f[(self.knots[k] as usize, c)] + (means[c] - offset[c])
            });
            let rest = take(&missed, &vec![0.0; means.len()]);
            found = combine(&[(&found, 1.0), (&rest, 1.0)])?;
        }
        Ok(found)
    }

    fn implicit(
        &self,
        coefficients: &Mat<f64>,
        constant: Vec<f64>,
    ) -> Result<BiharmonicSpline, ExplicitError> {
        let dimension = constant.len();
        let row = |k: usize| (0..dimension).map(move |c| (k, c));
        let places = (0..self.knots.len()).flat_map(row);
        let form = Form::Implicit {
            coefficients: places.map(|at| coefficients[at]).collect(),
            constant,
        };
        let knots = self.knots.clone();
        Ok(BiharmonicSpline::from_parts(
            &self.space,
            dimension,
            knots,
            form,
        )?)
    }

    fn check_spline(&self, spline: &BiharmonicSpline) -> Result<(), ExplicitError> {
        if self.space.difference(spline.space()).is_some() {
            return Err(ExplicitError::OtherSpace);
        }
        let (own, other) = (&self.knots, spline.knots());
        if own != other {
            let same = own.iter().zip(other).take_while(|(a, b)| a == b).count();
            return Err(ExplicitError::OtherKnots {
                index: same,
                found: other.len(),
                expected: own.len(),
            });
        }
        Ok(())
    }
}

fn check_numbers(numbers: &[f64], expected: usize) -> Result<(), ExplicitError> {
    let found = numbers.len();
    if found != expected {
        return Err(ExplicitError::Length { found, expected });
    }
    match numbers.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(ExplicitError::NotFinite { index }),
        None => Ok(()),
    }
}

/// Returns numbers given row after row as a matrix.
fn matrix(numbers: &[f64], dimension: usize) -> Mat<f64> {
    Mat::from_fn(numbers.len() / dimension.max(1), dimension, |k, c| {
        numbers[k * dimension + c]
    })
}

/// Subtracts the mean of each column, and returns the means.
fn take_means(values: &mut Mat<f64>) -> Vec<f64> {
    let rows = values.nrows();
    let mut means = Vec::with_capacity(values.ncols());
    for c in 0..values.ncols() {
        let mean = (0..rows).map(|k| values[(k, c)]).sum::<f64>() / rows as f64;
        (0..rows).for_each(|k| values[(k, c)] -= mean);
        means.push(mean);
    }
    means
}
