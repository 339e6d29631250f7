//! Matching pursuit on Gram matrices.
//!
//! All chosen atoms are orthogonalised as they come: with `q_n` the n-th of them, the row
//! `D_n = q_nᵀ A` follows from the Gram matrix and the rows before it, the correlations of all atoms
//! with the residual lose `⟨q_n, t⟩ D_n`, and their squared lengths beyond the chosen ones lose
//! `D_n²`. A step costs one pass over the rows before, `L n` multiplications; a pursuit of δ atoms
//! `L δ² / 2`.
//!
//! # Notation
//! `A` has `K` rows (observations) and `L` columns (atoms), `G = Aᵀ A`, `t` the data, `c` of them
//! components; `alpha = Aᵀ t`.
//!
//! # Reference
//! [Pati1993] for orthogonal matching pursuit, [Wang2016] Eq. (3); order-recursive matching pursuit,
//! also known as orthogonal least squares, takes the atom after which the residual is smallest.

use serde::{Deserialize, Serialize};

/// An atom of which less than this fraction of its squared length is new counts as dependent.
pub(crate) const DEPENDENT: f64 = 1e-9;

/// Which atom comes next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// The one whose direction is closest to the residual: orthogonal matching pursuit.
    Omp,
    /// The one after which the residual is smallest: order-recursive matching pursuit.
    Ormp,
    /// The one of largest correlation with the residual, whatever its length: matching pursuit without
    /// normalised columns, which prefers monomials of low degree.
    #[default]
    Plain,
}

/// What a pursuit found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Chosen atoms in their order.
    pub support: Vec<u16>,
    /// Their coefficients, `[atom][component]`.
    pub coefficients: Vec<f64>,
    /// By how much the squared residual has fallen, summed over components.
    pub explained: f64,
}

/// Rooms of a pursuit, kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    rows: Vec<f64>,
    alpha: Vec<f64>,
    rest: Vec<f64>,
    least: Vec<f64>,
    open: Vec<f64>,
    scores: Vec<f64>,
    pivots: Vec<f64>,
    betas: Vec<f64>,
}

/// What a pursuit is about.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// `L × L`.
    pub gram: &'a [f64],
    /// Components of the data.
    pub components: usize,
    /// Correlations of the atoms with the data, `[component][atom]`.
    pub alpha: &'a [f64],
    /// Whether an atom may be chosen.
    pub allowed: &'a [bool],
}

/// Returns a combination of at most `sparsity` atoms, chosen one by one.
///
/// Components share their atoms. The search ends early where no atom is left that is allowed and
/// independent, or that has any correlation with the residual.
#[must_use]
pub fn pursue(
    problem: Problem<'_>,
    selection: Selection,
    sparsity: usize,
    workspace: &mut Workspace,
) -> Found {
    pulp::Arch::new().dispatch(Pursuit {
        problem,
        selection,
        sparsity,
        workspace,
    })
}

/// Returns the best combination of given atoms; those that depend on others before them are left out.
#[must_use]
pub fn refit(problem: Problem<'_>, support: &[u16], workspace: &mut Workspace) -> Found {
    pulp::Arch::new().dispatch(Refit {
        problem,
        support,
        workspace,
    })
}

/// A pursuit as loops for the vector units of the machine.
struct Pursuit<'a> {
    problem: Problem<'a>,
    selection: Selection,
    sparsity: usize,
    workspace: &'a mut Workspace,
}

impl pulp::NullaryFnOnce for Pursuit<'_> {
    type Output = Found;

    #[inline(always)]
    fn call(self) -> Found {
        let Self {
            problem,
            selection,
            sparsity,
            workspace,
        } = self;
        workspace.start(problem);
        let most = sparsity.min(problem.allowed.len());
        let mut support: Vec<u16> = Vec::with_capacity(most);
        while support.len() < most {
            let Some(best) = workspace.best(problem, selection) else {
                break;
            };
            workspace.take(problem, best, support.len());
            support.push(best as u16);
        }
        workspace.finish(problem, support)
    }
}

/// A refit as loops for the vector units of the machine.
struct Refit<'a> {
    problem: Problem<'a>,
    support: &'a [u16],
    workspace: &'a mut Workspace,
}

impl pulp::NullaryFnOnce for Refit<'_> {
    type Output = Found;

    #[inline(always)]
    fn call(self) -> Found {
        let (problem, workspace) = (self.problem, self.workspace);
        workspace.start(problem);
        let mut kept: Vec<u16> = Vec::with_capacity(self.support.len());
        for &atom in self.support {
            let index = usize::from(atom);
            if workspace.rest[index] > workspace.least[index] {
                workspace.take(problem, index, kept.len());
                kept.push(atom);
            }
        }
        workspace.finish(problem, kept)
    }
}

impl Workspace {
    #[inline(always)]
    fn start(&mut self, problem: Problem<'_>) {
        let atoms = problem.allowed.len();
        self.rows.clear();
        self.pivots.clear();
        self.betas.clear();
        self.alpha.clear();
        self.alpha.extend_from_slice(problem.alpha);
        self.rest.clear();
        self.rest
            .extend((0..atoms).map(|atom| problem.gram[atom * (atoms + 1)]));
        self.least.clear();
        self.least.extend(self.rest.iter().map(|g| DEPENDENT * g));
        self.open.clear();
        let open = problem
            .allowed
            .iter()
            .map(|&allowed| f64::from(u8::from(allowed)));
        self.open.extend(open);
    }

    /// Returns the atom of highest score.
    #[inline(always)]
    fn best(&mut self, problem: Problem<'_>, selection: Selection) -> Option<usize> {
        let atoms = problem.allowed.len();
        self.scores.clear();
        self.scores.resize(atoms, 0.0);
        for alpha in self.alpha.chunks_exact(atoms) {
            for (score, a) in self.scores.iter_mut().zip(alpha) {
                *score += a * a;
            }
        }
        match selection {
            Selection::Plain => {}
            Selection::Omp => {
                // Squared lengths are those below which atoms depend, but for a factor.
                self.scores
                    .iter_mut()
                    .zip(&self.least)
                    .for_each(|(s, l)| *s /= l);
            }
            Selection::Ormp => {
                self.scores
                    .iter_mut()
                    .zip(&self.rest)
                    .for_each(|(s, r)| *s /= r);
            }
        }
        // Passes without branches, and one that finds the place.
        let rooms = self.open.iter().zip(&self.rest).zip(&self.least);
        for (score, ((&open, &rest), &least)) in self.scores.iter_mut().zip(rooms) {
            *score *= if rest > least { open } else { 0.0 };
        }
        let highest = largest(&self.scores);
        let place = self.scores.iter().position(|&s| s == highest);
        place.filter(|_| highest > 0.0)
    }

    /// Orthogonalises an atom against those before it and takes its part off the residual.
    #[inline(always)]
    fn take(&mut self, problem: Problem<'_>, atom: usize, before: usize) {
        let atoms = problem.allowed.len();
        let pivot = self.rest[atom].sqrt();
        let start = self.rows.len();
        self.rows
            .extend_from_slice(&problem.gram[atom * atoms..(atom + 1) * atoms]);
        let (old, row) = self.rows.split_at_mut(start);
        debug_assert_eq!(old.len(), before * atoms);
        subtract_rows(old, atom, row);
        let scale = 1.0 / pivot;
        for (x, rest) in row.iter_mut().zip(&mut self.rest) {
            *x *= scale;
            *rest -= *x * *x;
        }
        for alpha in self.alpha.chunks_exact_mut(atoms) {
            let beta = alpha[atom] * scale;
            self.betas.push(beta);
            for (a, x) in alpha.iter_mut().zip(&*row) {
                *a -= beta * x;
            }
        }
        self.pivots.push(pivot);
        self.open[atom] = 0.0;
    }

    /// Solves the triangular system of the orthogonalisation for the coefficients.
    fn finish(&mut self, problem: Problem<'_>, support: Vec<u16>) -> Found {
        let (atoms, n, c) = (problem.allowed.len(), support.len(), problem.components);
        let mut coefficients = vec![0.0; n * c];
        for i in (0..n).rev() {
            for component in 0..c {
                let mut rest = self.betas[i * c + component];
                for j in i + 1..n {
                    let entry = self.rows[i * atoms + usize::from(support[j])];
                    rest -= entry * coefficients[j * c + component];
                }
                coefficients[i * c + component] = rest / self.pivots[i];
            }
        }
        Found {
            support,
            coefficients,
            explained: self.betas.iter().map(|b| b * b).sum(),
        }
    }
}

/// Returns the largest number, none of which is negative.
#[inline(always)]
fn largest(numbers: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut lanes = [0.0f64; LANES];
    let mut chunks = numbers.chunks_exact(LANES);
    for chunk in &mut chunks {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane = if x > *lane { x } else { *lane };
        }
    }
    let rest = chunks.remainder().iter();
    lanes
        .iter()
        .chain(rest)
        .fold(0.0, |a, &b| if b > a { b } else { a })
}

/// Subtracts from `row` the rows in `old`, each times its entry at `atom`, four at a time.
#[inline(always)]
fn subtract_rows(old: &[f64], atom: usize, row: &mut [f64]) {
    let atoms = row.len();
    let mut fours = old.chunks_exact(4 * atoms);
    for four in &mut fours {
        let (a, rest) = four.split_at(atoms);
        let (b, rest) = rest.split_at(atoms);
        let (c, d) = rest.split_at(atoms);
        let factors = [a[atom], b[atom], c[atom], d[atom]];
        for i in 0..atoms {
            row[i] -=
                (factors[0] * a[i] + factors[1] * b[i]) + (factors[2] * c[i] + factors[3] * d[i]);
        }
    }
    for other in fours.remainder().chunks_exact(atoms) {
        let factor = other[atom];
        for (x, y) in row.iter_mut().zip(other) {
            *x -= factor * y;
        }
    }
}
