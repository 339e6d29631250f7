//! Options of surfaces over curve networks as experiments name them.

use msplines_sparse_manifold::network::{
    C0Atoms, CurveSpeed, CycleOptions, FillEnergy, NetworkOptions, SurfaceMethod,
};
use serde::{Deserialize, Serialize};

use super::manifold::Settings;
use crate::case::CurveNetworkMethod;

/// Options of a surface over a curve network; what is absent is as `settings` has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RowNetwork {
    /// Where options start from.
    pub settings: Settings,
    /// How the surface between the curves is found.
    pub surface: Option<SurfaceMethod>,
    /// How points of a curve are spread along an edge of the domain.
    pub speed: Option<CurveSpeed>,
    /// Which charts have shape functions.
    pub c0_atoms: Option<C0Atoms>,
    /// Degree of the monomials of a chart.
    pub degree: Option<u32>,
    /// The energy that fills patches.
    pub fill: Option<FillEnergy>,
    /// How patches are found.
    pub cycles: Option<CycleOptions>,
}

impl RowNetwork {
    /// Returns the method that these options ask for.
    #[must_use]
    pub fn method(&self) -> CurveNetworkMethod {
        let base = match self.settings {
            Settings::Ours => NetworkOptions::default(),
            Settings::Paper => NetworkOptions::PAPER,
        };
        CurveNetworkMethod {
            options: NetworkOptions {
                method: self.surface.unwrap_or(base.method),
                speed: self.speed.unwrap_or(base.speed),
                c0_atoms: self.c0_atoms.unwrap_or(base.c0_atoms),
                degree: self.degree.unwrap_or(base.degree),
                fill: self.fill.unwrap_or(base.fill),
                cycles: self.cycles.clone().unwrap_or_else(|| base.cycles.clone()),
                ..base
            },
            ..CurveNetworkMethod::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_change_what_they_name_and_nothing_else() {
        let row = |text: &str| toml::from_str::<RowNetwork>(text).expect(text).method();
        assert_eq!(row(""), CurveNetworkMethod::default());
        assert_eq!(row("settings = \"paper\"").options, NetworkOptions::PAPER);
        let without = row("c0_atoms = \"without\"").options;
        let expected = NetworkOptions {
            c0_atoms: C0Atoms::Without,
            ..NetworkOptions::default()
        };
        assert_eq!(without, expected);
        assert!(toml::from_str::<RowNetwork>("kinks = 1").is_err());
    }
}
