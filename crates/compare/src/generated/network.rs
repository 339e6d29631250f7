//! Curve networks made from a short name.

use std::fmt;
use std::str::FromStr;

use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes::{self, Opening};
use serde::{Deserialize, Serialize};

use super::ControlShape;

/// Catmull-Clark steps that make the segments of a curve: eight for each edge.
const LEVELS: u32 = 3;

/// A curve network: a sketch, or the edges of a control mesh on its limit surface.
///
/// `mushroom-8`, `open-mushroom-8`, `dome-4`; `limit-slab-2`, `limit-25%-box-2x3x5+top` with up to that
/// share of the edges left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct NetworkShape {
    name: String,
    base: Base,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Base {
    Mushroom(u32, bool),
    Dome(u32),
    Limit(u32, ControlShape),
}

impl NetworkShape {
    /// Returns the curves; `seed` chooses the edges that are left out.
    #[must_use]
    pub fn network(&self, seed: u64) -> CurveNetwork {
        let known = match &self.base {
            Base::Mushroom(meridians, closed) => {
                let opening = if *closed {
                    Opening::Closed
                } else {
                    Opening::Open
                };
                shapes::mushroom_network(*meridians, opening)
            }
            Base::Dome(size) => shapes::dome_network(*size),
            Base::Limit(percent, _) => {
                let Some((mesh, sharpness)) = self.limit_of() else {
                    unreachable!("this is a limit network")
                };
                let removed = f64::from(*percent) / 100.0;
                shapes::limit_network(&mesh, &sharpness, LEVELS, removed, seed)
            }
        };
        known.network
    }

    /// Returns the control mesh whose limit surface the curves lie on, where there is one.
    #[must_use]
    pub fn limit_of(&self) -> Option<(PolygonMesh, Sharpness)> {
        let Base::Limit(_, shape) = &self.base else {
            return None;
        };
        let (mesh, tags) = shape.mesh();
        let rules = Rules::default();
        let sharpness = Sharpness::build(mesh.topology(), rules, &tags);
        let smooth = |_| Sharpness::smooth(mesh.topology(), rules);
        // Tags of a shape name its own edges.
        let sharpness = sharpness.unwrap_or_else(smooth);
        Some((mesh, sharpness))
    }
}

impl fmt::Display for NetworkShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl From<NetworkShape> for String {
    fn from(shape: NetworkShape) -> Self {
        shape.name
    }
}

impl TryFrom<String> for NetworkShape {
    type Error = UnknownNetwork;

    fn try_from(name: String) -> Result<Self, UnknownNetwork> {
        name.parse()
    }
}

/// No curve network has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no curve network `{name}`; give mushroom-N, open-mushroom-N, dome-N with N even, or limit- and the name of a control mesh such as limit-slab-2, or limit-25%-slab-2 with up to 25 % of the edges left out"
)]
pub struct UnknownNetwork {
    /// The name.
    pub name: String,
}

/// Largest number in the name of a sketch.
const LARGEST: u32 = 200;

impl FromStr for NetworkShape {
    type Err = UnknownNetwork;

    fn from_str(name: &str) -> Result<Self, UnknownNetwork> {
        let unknown = || UnknownNetwork {
            name: name.to_owned(),
        };
        let number = |text: &str, least: u32| {
            let number = text.parse::<u32>().ok();
            number.filter(|n| (least..=LARGEST).contains(n))
        };
        let base = if let Some(n) = name.strip_prefix("mushroom-") {
            number(n, 3).map(|n| Base::Mushroom(n, true))
        } else if let Some(n) = name.strip_prefix("open-mushroom-") {
            number(n, 3).map(|n| Base::Mushroom(n, false))
        } else if let Some(n) = name.strip_prefix("dome-") {
            number(n, 2).filter(|n| n % 2 == 0).map(Base::Dome)
        } else if let Some(rest) = name.strip_prefix("limit-") {
            let (percent, shape) = rest.split_once("%-").unwrap_or(("0", rest));
            let percent = percent.parse().ok().filter(|p| *p <= 100u32);
            percent
                .zip(shape.parse().ok())
                .map(|(percent, shape)| Base::Limit(percent, shape))
        } else {
            None
        };
        Ok(Self {
            name: name.to_owned(),
            base: base.ok_or_else(unknown)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_the_networks_they_say() {
        let network = |name: &str| name.parse::<NetworkShape>().expect(name);
        let whole = network("limit-slab-2");
        assert_eq!(whole.network(1).segment_count() % 8, 0);
        assert!(whole.limit_of().is_some());
        let fewer = network("limit-20%-slab-2");
        assert!(fewer.network(1).segment_count() < whole.network(1).segment_count());
        assert_ne!(fewer.network(1), fewer.network(2));
        for name in ["mushroom-8", "open-mushroom-8", "dome-4"] {
            assert!(network(name).limit_of().is_none());
            assert!(network(name).network(0).segment_count() > 50, "{name}");
        }
    }

    #[test]
    fn other_names_are_refused_with_what_there_is() {
        for name in [
            "dome-3",
            "mushroom-2",
            "limit-ball",
            "limit-200%-slab-1",
            "net",
        ] {
            let error = name.parse::<NetworkShape>().expect_err(name).to_string();
            assert!(error.contains("limit-slab-2"), "{error}");
        }
    }
}
