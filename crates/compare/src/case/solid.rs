//! Trivariate splines as runs are asked for them.

use serde::{Deserialize, Serialize};

/// A trivariate spline with its options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrivariateMethod {
    /// Options of map, samples and fit.
    pub options: msplines_trivariate::solid::Options,
    /// What the solid is mapped to.
    pub map: SolidMap,
    /// What fills a surface with tetrahedra.
    pub filler: Filler,
    /// Cells in each direction of the samplings by which the spline is judged as finite elements.
    pub validate_at: Vec<usize>,
    /// Cells along the side of a span when the solid or its surface is cut into pieces.
    pub cells: usize,
    /// What pictures cut away.
    pub cut: Cut,
    /// Control points that are moved after the fit; errors are those before it.
    pub moves: Vec<LatticeMove>,
}

/// Control points that are moved together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeMove {
    /// Lowest place in the lattice, as fractions of its sides.
    pub low: [f64; 3],
    /// Highest place, likewise.
    pub high: [f64; 3],
    /// By how much, as fractions of the diagonal of the solid's box.
    pub by: [f64; 3],
}

impl Default for TrivariateMethod {
    fn default() -> Self {
        Self {
            options: Default::default(),
            map: SolidMap::default(),
            filler: Filler::default(),
            validate_at: vec![20, 30, 47],
            cells: 4,
            cut: Cut::default(),
            moves: Vec::new(),
        }
    }
}

/// What a solid is mapped to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolidMap {
    /// The unit cube.
    #[default]
    Cube,
    /// A cylinder around an axis: longitude, latitude and radius, the baseline of the comparison.
    Cylinder,
}

/// What fills a surface with tetrahedra.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Filler {
    /// The mesher of the library.
    #[default]
    Lattice,
    /// The program `tetgen`.
    Tetgen,
}

/// A solid cut open: the part whose parameter along an axis is below a share is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cut {
    /// The axis: 0, 1 or 2.
    pub axis: usize,
    /// The share.
    pub keep: f64,
}

impl Default for Cut {
    fn default() -> Self {
        Self { axis: 0, keep: 0.5 }
    }
}
