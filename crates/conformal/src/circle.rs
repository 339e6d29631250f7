//! The imaginary part of a form with integer periods, as a map to the circle.

use msplines_common::mesh::{NONE, Topology};

use crate::atlas::Atlas;
use crate::error::ConformalError;

/// Farthest of an edge value from what the function and an integer make of it: rounding of a few
/// hundred terms.
const ROUNDING: f64 = 1e-9;

/// A function of the vertices and integers of the half-edges, which together are a closed form modulo 1.
///
/// The form along half-edge `h` from `a` to `b` is `function[b] - function[a] + jumps[h]`. The integers
/// sum to exactly 0 around every face, and are opposite on the two halves of an edge: so the fractional
/// parts of `function` are the map to the circle, and level lines of it are told by comparisons alone.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleMap {
    /// A number for each vertex, of which the fractional part is the place on the circle.
    pub function: Vec<f64>,
    /// An integer for each half-edge of the mesh of the atlas.
    pub jumps: Vec<i64>,
}

impl CircleMap {
    /// Returns the imaginary part of an atlas' form, before that was scaled, given its function.
    pub(crate) fn of(atlas: &Atlas, function: Vec<f64>) -> Result<Self, ConformalError> {
        let topology = atlas.mesh().topology();
        let mut jumps = vec![0; atlas.form().len()];
        for (h, form) in (0u32..).zip(atlas.form()) {
            let [a, b] = [topology.origin(h), topology.target(h)].map(|v| function[v as usize]);
            let jump = form[1] / atlas.scale_factor() - (b - a);
            jumps[h as usize] = jump.round() as i64;
            if (jump - jump.round()).abs() > ROUNDING {
                return Err(ConformalError::NotIntegral {
                    vertex: topology.origin(h),
                    defect: (jump - jump.round()).abs(),
                });
            }
        }
        let map = Self { function, jumps };
        match map.open(topology) {
            Some(h) => Err(ConformalError::NotIntegral {
                vertex: topology.origin(h),
                defect: 1.0,
            }),
            None => Ok(map),
        }
    }

    /// Returns the form along a half-edge of the mesh of the atlas.
    ///
    /// # Panics
    /// If the topology is not that of the atlas.
    #[must_use]
    pub fn along(&self, topology: &Topology, half_edge: u32) -> f64 {
        let ends = [topology.origin(half_edge), topology.target(half_edge)];
        let [a, b] = ends.map(|v| self.function[v as usize]);
        b - a + self.jumps[half_edge as usize] as f64
    }

    /// A half-edge at which the integers are not those of a closed form.
    fn open(&self, topology: &Topology) -> Option<u32> {
        (0..self.jumps.len() as u32).find(|&h| {
            let face = 3 * (h as usize / 3);
            let twin = topology.twin(h);
            let halves = (twin != NONE).then(|| self.jumps[twin as usize] + self.jumps[h as usize]);
            self.jumps[face..face + 3].iter().sum::<i64>() != 0
                || halves.is_some_and(|sum| sum != 0)
        })
    }
}
