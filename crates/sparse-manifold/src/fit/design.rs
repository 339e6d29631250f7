//! The matrices of charts of one shape.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use super::kernels::{Accumulate, Correlations, Gradient};
use crate::dictionary::{Atom, Dictionary, DictionaryKind};
use crate::domain::Star;
use crate::weight::weight;

/// A point of a chart on the grid of a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    pub sector: u32,
    pub grid: [u32; 2],
}

/// Whether the functions of a chart count by its weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blending {
    /// They do: what the chart adds to the surface.
    Weighted,
    /// They do not: the chart for itself, out to the far edges of its faces.
    Alone,
}

/// Points and atoms of charts of one shape: `A` and `G = Aᵀ A`.
#[derive(Clone, Debug)]
pub(crate) struct Design {
    pub samples: Vec<Sample>,
    pub atoms: usize,
    /// `A`, a row for each sample.
    pub rows: Vec<f64>,
    /// `A`, a column for each atom.
    pub columns: Vec<f64>,
    /// `G`.
    pub gram: Vec<f64>,
    /// Which atoms are smooth.
    pub smooth: Vec<bool>,
    /// Which atoms are smooth but for the centre.
    pub cones: Vec<bool>,
}

/// Returns the points of a star at which its grids have an influence, the centre first.
pub(crate) fn samples(star: Star, side: u32, blending: Blending) -> Vec<Sample> {
    let cells = side - 1;
    let inside = |i: &u32| weight(f64::from(*i) / f64::from(cells))[0] > 0.0;
    let reach = match blending {
        Blending::Alone => cells,
        Blending::Weighted => (0..=cells).filter(inside).max().unwrap_or(0),
    };
    let mut samples = vec![Sample {
        sector: 0,
        grid: [0, 0],
    }];
    for sector in 0..star.sectors {
        let grid = (1..=reach).flat_map(|a| (0..=reach).map(move |b| [a, b]));
        samples.extend(grid.map(|grid| Sample { sector, grid }));
    }
    if !star.is_closed() {
        let sector = star.sectors - 1;
        samples.extend((1..=reach).map(|b| Sample {
            sector,
            grid: [0, b],
        }));
    }
    samples
}

impl Design {
    pub(crate) fn build(
        kind: DictionaryKind,
        degree: u32,
        star: Star,
        side: u32,
        blending: Blending,
    ) -> Self {
        let dictionary = Dictionary::new(kind, degree, star);
        let samples = samples(star, side, blending);
        let row = |sample: &Sample| {
            let at = sample.grid.map(|i| f64::from(i) / f64::from(side - 1));
            let scale = match blending {
                Blending::Alone => 1.0,
                Blending::Weighted => weight(at[0])[0] * weight(at[1])[0],
            };
            let mut values = dictionary.values(sample.sector, at);
            values.iter_mut().for_each(|value| *value *= scale);
            values
        };
        let rows: Vec<f64> = samples.par_iter().map(row).flatten().collect();
        let cones = dictionary.atoms().iter().map(Atom::is_cone);
        let cones: Vec<bool> = cones.collect();
        let atoms = dictionary.atoms().len();
        let count = samples.len();
        let mut columns = vec![0.0; rows.len()];
        for (sample, row) in rows.chunks_exact(atoms).enumerate() {
            for (atom, &value) in row.iter().enumerate() {
                columns[atom * count + sample] = value;
            }
        }
        Self {
            gram: gram(&columns, atoms),
            smooth: dictionary
                .atoms()
                .iter()
                .map(|atom| !(atom.is_shape() || atom.is_cone()))
                .collect(),
            cones,
            samples,
            atoms,
            rows,
            columns,
        }
    }

    /// Returns `Aᵀ t` for data `[component][sample]`, as `[component][atom]`.
    pub(crate) fn correlations(&self, data: &[f64], out: &mut Vec<f64>) {
        let components = data.len() / self.samples.len();
        out.clear();
        out.resize(components * self.atoms, 0.0);
        pulp::Arch::new().dispatch(Correlations {
            rows: &self.rows,
            samples: self.samples.len(),
            data,
            out,
        });
    }

    /// Returns `A_Sᵀ t` for the atoms of a support, as `[atom][component]`.
    pub(crate) fn gradient(&self, support: &[u16], data: &[f64]) -> Vec<f64> {
        let n = self.samples.len();
        let components = data.len() / n;
        let mut out = vec![0.0; components * support.len()];
        pulp::Arch::new().dispatch(Gradient {
            columns: &self.columns,
            samples: n,
            support,
            data,
            out: &mut out,
        });
        out
    }

    /// Adds `A c` to data `[component][sample]`, for coefficients `[atom][component]` of a support.
    pub(crate) fn accumulate(&self, support: &[u16], coefficients: &[f64], data: &mut [f64]) {
        pulp::Arch::new().dispatch(Accumulate {
            columns: &self.columns,
            samples: self.samples.len(),
            support,
            coefficients,
            data,
        });
    }
}

/// Returns `AᵀA` of columns.
fn gram(columns: &[f64], atoms: usize) -> Vec<f64> {
    let samples = columns.len() / atoms;
    let matrix = MatRef::from_column_major_slice(columns, samples, atoms);
    let mut gram = vec![0.0; atoms * atoms];
    let out = MatMut::from_column_major_slice_mut(&mut gram, atoms, atoms);
    // One thread: the bits must not depend on their number.
    matmul(
        out,
        Accum::Replace,
        matrix.transpose(),
        matrix,
        1.0,
        Par::Seq,
    );
    // Rounding of the two triangles may differ.
    for i in 0..atoms {
        for j in 0..i {
            gram[i * atoms + j] = gram[j * atoms + i];
        }
    }
    gram
}
