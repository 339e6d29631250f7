//! Where the degenerate elements of a cylindrical solid lie.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::measure::{Places, is_degenerate};
use crate::spline::TrivariateSpline;

/// Degenerate elements by the place of their cells in the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DegeneratePlaces {
    /// Next to latitude 0 or 1.
    pub poles: usize,
    /// Next to the axis, but not to a pole.
    pub axis: usize,
    /// All others.
    pub elsewhere: usize,
}

impl DegeneratePlaces {
    /// Returns how many there are.
    #[must_use]
    pub fn total(self) -> usize {
        self.poles + self.axis + self.elsewhere
    }
}

/// Returns how many of the elements that [`measure`](crate::measure::measure) counts as degenerate
/// lie in the `layers` layers of cells next to the poles, in those next to the axis, and
/// elsewhere.
///
/// # Reference
/// [Kim2014] Table 1, §6.
#[must_use]
pub fn degenerate_places(
    spline: &TrivariateSpline,
    cells: usize,
    layers: usize,
) -> DegeneratePlaces {
    let grid: Vec<[f64; 3]> = spline
        .grid(2 * cells)
        .iter()
        .map(|p| p.coords.into())
        .collect();
    let places = Places::build(cells);
    let degenerate = |cell: usize| {
        let elements = places.of_cell(cells, cell);
        elements
            .filter(|at| is_degenerate(&at.map(|index| grid[index])))
            .count()
    };
    let layer = |k: usize| {
        let mut found = DegeneratePlaces::default();
        for cell in k * cells * cells..(k + 1) * cells * cells {
            let latitude = cell / cells % cells;
            let place = if latitude < layers || latitude + layers >= cells {
                &mut found.poles
            } else if k < layers {
                &mut found.axis
            } else {
                &mut found.elsewhere
            };
            *place += degenerate(cell);
        }
        found
    };
    let layers: Vec<DegeneratePlaces> = (0..cells).into_par_iter().map(layer).collect();
    let mut sum = DegeneratePlaces::default();
    for layer in layers {
        sum.poles += layer.poles;
        sum.axis += layer.axis;
        sum.elsewhere += layer.elsewhere;
    }
    sum
}
