//! Points that a surface is fitted to, in the order of the leaves that they lie on.

use msplines_common::Point3;
use rayon::prelude::*;

use crate::complex::Point;
use crate::tmesh::TMesh;

/// A point to be approximated, and where on the cylinders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where it lies on the cylinders.
    pub at: Point,
    /// The point.
    pub position: Point3<f64>,
    /// How much its squared distance counts.
    pub weight: f64,
    /// Whether errors are measured at it: at vertices they are, at points of faces not.
    pub measured: bool,
    /// Whether it may move: not at a zero of the form, where directions part.
    pub movable: bool,
    /// How far it has moved, in units.
    pub shift: [f64; 2],
}

impl Sample {
    /// Returns a vertex to be approximated.
    #[must_use]
    pub fn vertex(at: Point, position: Point3<f64>) -> Self {
        Self {
            at,
            position,
            weight: 1.0,
            measured: true,
            movable: true,
            shift: [0.0; 2],
        }
    }
}

/// Samples by leaf.
pub(super) struct Sorted {
    pub(super) samples: Vec<Sample>,
    pub(super) points: Vec<Point>,
    /// Which one of those given each is.
    pub(super) origins: Vec<u32>,
    /// Where those given began, and how far they had moved then.
    beginnings: Vec<(Point, [f64; 2])>,
    /// Those on leaf `i` are `starts[i]..starts[i + 1]`.
    pub(super) starts: Vec<u32>,
}

impl Sorted {
    pub(super) fn new(samples: &[Sample], mesh: &TMesh) -> Self {
        let mut sorted = Self {
            samples: samples.to_vec(),
            points: Vec::new(),
            origins: (0..samples.len() as u32).collect(),
            beginnings: samples.iter().map(|s| (s.at, s.shift)).collect(),
            starts: Vec::new(),
        };
        sorted.sort(mesh);
        sorted
    }

    /// Sorts samples that have moved, or whose leaves were split. O(n).
    pub(super) fn sort(&mut self, mesh: &TMesh) {
        let leaves: Vec<u32> = self
            .samples
            .par_iter()
            .map(|s| mesh.leaf_of(s.at))
            .collect();
        let mut starts = vec![0_u32; mesh.leaves().len() + 1];
        for &leaf in &leaves {
            starts[leaf as usize + 1] += 1;
        }
        for leaf in 1..starts.len() {
            starts[leaf] += starts[leaf - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0_u32; leaves.len()];
        for (place, &leaf) in leaves.iter().enumerate() {
            order[next[leaf as usize] as usize] = place as u32;
            next[leaf as usize] += 1;
        }
        self.samples = order.iter().map(|&i| self.samples[i as usize]).collect();
        self.origins = order.iter().map(|&i| self.origins[i as usize]).collect();
        self.points = self.samples.iter().map(|s| s.at).collect();
        self.starts = starts;
    }

    /// Returns where a sample began, and how far it has moved from there.
    pub(super) fn beginning(&self, place: usize) -> (Point, [f64; 2]) {
        let (from, before) = self.beginnings[self.origins[place] as usize];
        let shift = self.samples[place].shift;
        (from, [0, 1].map(|k| shift[k] - before[k]))
    }

    /// Returns the sum of all weights.
    pub(super) fn weight(&self) -> f64 {
        self.samples.iter().map(|s| s.weight).sum()
    }

    pub(super) fn on(&self, leaf: usize) -> std::ops::Range<usize> {
        self.starts[leaf] as usize..self.starts[leaf + 1] as usize
    }

    /// Returns the samples in the order in which they were given.
    pub(super) fn restored(&self) -> Vec<Sample> {
        let mut samples = self.samples.clone();
        for (&sample, &origin) in self.samples.iter().zip(&self.origins) {
            samples[origin as usize] = sample;
        }
        samples
    }
}
