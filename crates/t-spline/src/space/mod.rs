//! Spline spaces: the functions of a T-mesh and the polynomials of caps.
//!
//! # Notation
//! `B_i` the blending functions, `S` their sum; `phi` the weight of the cap in which a point lies, 0 if in
//! none, and `w_k` the monomials there. A spline is
//! `F = (1 - phi) sum C_i B_i / S + phi sum P_k w_k`: linear in `C` and `P` together, the unknowns.
//!
//! # Reference
//! [He2006] Eq. (1), all weights 1. Deviation: caps at zeros and poles.

mod rows;
#[cfg(test)]
pub(crate) mod tests;

use rayon::prelude::*;

pub use rows::{Row, Rows};

use crate::blend::Blend;
use crate::caps::{CapOptions, Caps, CapsError};
use crate::complex::{Node, UNITS};
use crate::support::Support;
use crate::tmesh::TMesh;

/// A function where it meets a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    function: u32,
    /// Where its anchor would be in the coordinates of the cylinder, in units.
    origin: [f64; 2],
    /// Its support there.
    x: [f64; 2],
    y: [f64; 2],
}

/// The blending functions of a T-mesh, with caps at zeros and poles.
#[derive(Clone, Debug, PartialEq)]
pub struct TSplineSpace {
    mesh: TMesh,
    caps: Caps,
    functions: Vec<Support>,
    /// Along `x` and `y`, in units of the form's 1.
    blends: Vec<[Blend; 2]>,
    /// The functions of leaf `i` are `entries[starts[i]..starts[i + 1]]`, ascending.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl TSplineSpace {
    /// Finds the functions of a T-mesh: one per anchor, by anchor; two on open borders.
    ///
    /// Cost: `O(n log n)` for `n` leaves, in parallel.
    ///
    /// # Errors
    /// Zeros and poles around which no caps fit.
    pub fn build(mesh: TMesh, options: &CapOptions) -> Result<Self, CapsError> {
        let caps = Caps::build(mesh.complex(), options)?;
        Ok(Self::with_caps(mesh, caps))
    }

    /// Finds the functions of a T-mesh, with caps that may have other radii.
    #[must_use]
    pub fn with_caps(mesh: TMesh, caps: Caps) -> Self {
        let anchors = mesh.anchors();
        let functions: Vec<Support> = anchors
            .into_par_iter()
            .flat_map_iter(|node: Node| Support::of_anchor(&mesh, node))
            .collect();
        let blends = functions.iter().map(|f| [blend(&f.x), blend(&f.y)]);
        let blends = blends.collect();
        // Blocks in order, so that every list is ascending.
        let found: Vec<(u32, Entry)> = functions
            .par_iter()
            .enumerate()
            .flat_map_iter(|(function, support)| entries_of(&mesh, function as u32, support))
            .collect();
        let mut starts = vec![0_u32; mesh.leaves().len() + 1];
        for (leaf, _) in &found {
            starts[*leaf as usize + 1] += 1;
        }
        for leaf in 1..starts.len() {
            starts[leaf] += starts[leaf - 1];
        }
        let mut entries = vec![found.first().map_or_else(Entry::none, |f| f.1); found.len()];
        let mut next = starts.clone();
        for (leaf, entry) in found {
            let place = &mut next[leaf as usize];
            entries[*place as usize] = entry;
            *place += 1;
        }
        Self {
            mesh,
            caps,
            functions,
            blends,
            starts,
            entries,
        }
    }

    /// Returns the T-mesh.
    #[must_use]
    pub fn mesh(&self) -> &TMesh {
        &self.mesh
    }

    /// Returns the caps, whose coefficients follow the functions among the unknowns.
    #[must_use]
    pub fn caps(&self) -> &Caps {
        &self.caps
    }

    /// Returns the caps to change their radii: the functions do not depend on them.
    pub fn caps_mut(&mut self) -> &mut Caps {
        &mut self.caps
    }

    /// Returns the functions, the first unknowns.
    #[must_use]
    pub fn functions(&self) -> &[Support] {
        &self.functions
    }

    /// Returns the number of unknowns: functions and coefficients of caps.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.functions.len() + self.caps.coefficients()
    }

    /// Returns for every unknown the one of another space over the same complex that has the same anchor,
    /// or the same place in the cap of the same zero or pole: where control points of a coarser space go.
    ///
    /// Cost: linear in the unknowns of both.
    #[must_use]
    pub fn counterparts(&self, other: &Self) -> Vec<Option<u32>> {
        let key = |f: &[Support], i: usize| (f[i].node, i > 0 && f[i - 1].node == f[i].node);
        let mut place = 0;
        let mut found: Vec<Option<u32>> = (0..self.functions.len())
            .map(|i| {
                let own = key(&self.functions, i);
                while place < other.functions.len() && key(&other.functions, place) < own {
                    place += 1;
                }
                let same = place < other.functions.len() && key(&other.functions, place) == own;
                same.then_some(place as u32)
            })
            .collect();
        for cap in self.caps.caps() {
            let twin = other.caps.caps().iter().find(|c| c.kind == cap.kind);
            found.extend((0..cap.coefficients()).map(|k| {
                let twin = twin.filter(|t| k < t.coefficients())?;
                Some(other.functions.len() as u32 + twin.offset + k as u32)
            }));
        }
        found
    }

    /// Returns the functions that meet a leaf, ascending, one as often as it has images there.
    pub(crate) fn functions_on(&self, leaf: u32) -> impl Iterator<Item = u32> + '_ {
        self.entries(leaf).iter().map(|entry| entry.function)
    }

    /// Returns the functions that meet a leaf, once for every image, and where their anchors would be in the
    /// coordinates of its cylinder, in units.
    pub(crate) fn images_on(&self, leaf: u32) -> impl Iterator<Item = (u32, [f64; 2])> + '_ {
        let entries = self.entries(leaf).iter();
        entries.map(|entry| (entry.function, entry.origin))
    }

    /// Returns the factors of a function along `x` and `y`.
    pub(crate) fn blends(&self, function: u32) -> &[Blend; 2] {
        &self.blends[function as usize]
    }

    fn entries(&self, leaf: u32) -> &[Entry] {
        let leaf = leaf as usize;
        &self.entries[self.starts[leaf] as usize..self.starts[leaf + 1] as usize]
    }
}

impl Entry {
    fn none() -> Self {
        Self {
            function: u32::MAX,
            origin: [0.0; 2],
            x: [0.0; 2],
            y: [0.0; 2],
        }
    }
}

fn blend(knots: &[i64; 5]) -> Blend {
    Blend::new(knots.map(|k| k as f64 / UNITS))
}

/// Returns the leaves that a support meets, once for every image of it.
fn entries_of(mesh: &TMesh, function: u32, support: &Support) -> Vec<(u32, Entry)> {
    let mut found = Vec::with_capacity(24);
    for piece in support.pieces(mesh.complex()) {
        let origin = piece.origin;
        let end = |axis: usize, knot: i64| (origin[axis] + knot) as f64;
        let entry = Entry {
            function,
            origin: origin.map(|o| o as f64),
            x: [end(0, support.x[0]), end(0, support.x[4])],
            y: [end(1, support.y[0]), end(1, support.y[4])],
        };
        mesh.leaves_in(piece.cylinder, piece.x, piece.y, &mut |leaf| {
            found.push((leaf, entry));
        });
    }
    found
}
