//! What can be chosen about a surface over a network.

use serde::{Deserialize, Serialize};

use super::cycles::CycleOptions;
use super::error::NetworkError;
use crate::dictionary::{DEGREE, DictionaryKind};
use crate::options::Components;
use crate::pursuit::Selection;

/// Fewest and most cells along an edge of the domain: charts must overlap in nodes between the
/// curves, and the nodes of a face grow with the square.
const CELLS: std::ops::RangeInclusive<u32> = 4..=32;

/// Options of [`surface_network`](super::surface_network).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NetworkOptions {
    /// How patches are found.
    pub cycles: CycleOptions,
    /// How the surface between the curves is found.
    pub method: SurfaceMethod,
    /// How points of a curve are spread along an edge of the domain.
    pub speed: CurveSpeed,
    /// Which charts have shape functions, which are not smooth.
    pub c0_atoms: C0Atoms,
    /// Degree of the monomials of a chart.
    pub degree: u32,
    /// Cells along an edge of the domain; their corners are the nodes that the fit sees.
    pub cells: u32,
    /// Weight of a node on a curve; one inside of a patch has 1.
    pub curve_weight: f64,
    /// Weight of the bending of the surface.
    pub bending: f64,
    /// The energy whose least value fills the patches in two steps.
    pub fill: FillEnergy,
    /// Most rounds of the cotangent fill.
    pub rounds: u32,
}

/// How the surface between the curves is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceMethod {
    /// In one step if all patches are quads, else in two.
    #[default]
    Automatic,
    /// The charts are those whose blend follows the curves and bends least.
    OneStep,
    /// Patches are filled with nodes that bend least, and the charts follow all nodes and bend little.
    TwoStep,
    /// A few atoms for each chart, from the curves alone. What lies between is left to chance.
    Pursuit {
        /// The dictionary.
        dictionary: DictionaryKind,
        /// Most atoms of a chart.
        sparsity: u32,
        /// Which atom comes next.
        selection: Selection,
        /// Whether the coordinates share their atoms.
        components: Components,
    },
}

/// How points of a curve are spread along an edge of the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveSpeed {
    /// So that the curve has a finite speed, not zero, in the charts at both ends.
    #[default]
    Adapted,
    /// Evenly by arc length.
    Constant,
}

/// Which charts have shape functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum C0Atoms {
    /// Those that a crease touches, and there with kinks along the creases only.
    #[default]
    Gated,
    /// All.
    With,
    /// None; creases become round.
    Without,
}

/// An energy of nodes in patches. Nodes on creases and on the boundary do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FillEnergy {
    /// The squared graph Laplacian: like a subdivision surface, good for even quads.
    Uniform,
    /// The squared cotangent Laplacian of the present shape, from the uniform fill on.
    #[default]
    Cotangent,
}

impl NetworkOptions {
    /// The settings of the paper: curves by arc length, and orthogonal matching pursuit on them alone
    /// with 25 atoms for each coordinate out of monomials and 55 shape functions.
    ///
    /// # Reference
    /// [Wang2016] §4.2, §4.3.
    pub const PAPER: Self = Self::with(
        SurfaceMethod::Pursuit {
            dictionary: DictionaryKind::AllShapes,
            sparsity: 25,
            selection: Selection::Omp,
            components: Components::Each,
        },
        CurveSpeed::Constant,
        C0Atoms::With,
        DEGREE,
    );

    const fn with(
        method: SurfaceMethod,
        speed: CurveSpeed,
        c0_atoms: C0Atoms,
        degree: u32,
    ) -> Self {
        Self {
            cycles: CycleOptions::STANDARD,
            method,
            speed,
            c0_atoms,
            degree,
            cells: 10,
            curve_weight: 300.0,
            bending: 1.0,
            fill: FillEnergy::Cotangent,
            rounds: 10,
        }
    }

    pub(super) fn check(&self) -> Result<(), NetworkError> {
        let (degree, cells) = (self.degree, self.cells);
        if !(1..=DEGREE).contains(&degree) {
            return Err(NetworkError::Degree { degree });
        }
        if !CELLS.contains(&cells) {
            return Err(NetworkError::Cells { cells });
        }
        if let SurfaceMethod::Pursuit {
            sparsity,
            dictionary,
            ..
        } = self.method
        {
            let only_shapes = dictionary == DictionaryKind::Shapes;
            if sparsity == 0 || (only_shapes && self.c0_atoms != C0Atoms::With) {
                return Err(NetworkError::NoAtoms);
            }
        }
        let weights = [
            ("curve_weight", self.curve_weight),
            ("bending", self.bending),
        ];
        for (name, value) in weights {
            if !(value > 0.0 && value.is_finite()) {
                return Err(NetworkError::Weight { name, value });
            }
        }
        Ok(())
    }
}

impl Default for NetworkOptions {
    fn default() -> Self {
        Self::with(
            SurfaceMethod::Automatic,
            CurveSpeed::Adapted,
            C0Atoms::Gated,
            6,
        )
    }
}
