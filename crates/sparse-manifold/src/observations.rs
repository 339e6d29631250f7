//! Points that a surface is fitted to.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{
    PolygonMesh, Refined, Rules, Sharpness, Stencils, face_grids, limit_stencils,
};

/// Points on a grid over every face; faces share those on their edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Observations {
    /// Catmull-Clark steps: grids have `2^levels + 1` points a side.
    pub levels: u32,
    /// Points of all grids, face after face: along the first edge first, then up.
    pub grids: Vec<u32>,
    /// Position of every point.
    pub points: Vec<Point3<f64>>,
}

/// Where the points of a Catmull-Clark surface are, for any positions of its control vertices.
#[derive(Clone, Debug)]
pub struct LimitGrid {
    /// Catmull-Clark steps.
    pub levels: u32,
    /// As in [`Observations`].
    pub grids: Vec<u32>,
    /// Limit of every point over the control vertices.
    pub stencils: Stencils,
}

impl LimitGrid {
    /// Returns the grid after `levels` steps.
    ///
    /// # Panics
    /// If a face is no quad.
    #[must_use]
    pub fn build(mesh: &PolygonMesh, sharpness: &Sharpness, rules: Rules, levels: u32) -> Self {
        let start = Refined::none(mesh.topology(), sharpness);
        let refined = (0..levels).fold(start, |refined, _| refined.again(rules));
        Self {
            levels,
            grids: face_grids(mesh.topology(), &refined.topology, levels).concat(),
            stencils: limit_stencils(&refined, rules),
        }
    }

    /// Returns the points over control vertices at these positions.
    #[must_use]
    pub fn observations(&self, positions: &[Point3<f64>]) -> Observations {
        Observations {
            levels: self.levels,
            grids: self.grids.clone(),
            points: self.stencils.apply(positions),
        }
    }
}

impl Observations {
    /// Returns the number of points along the side of a grid.
    #[must_use]
    pub fn side(&self) -> usize {
        (1 << self.levels) + 1
    }

    /// Returns the first point that is not finite.
    pub(crate) fn first_infinite(&self) -> Option<usize> {
        let infinite = |p: &Point3<f64>| p.iter().any(|x| !x.is_finite());
        self.points.iter().position(infinite)
    }

    /// Returns the points of a face.
    #[must_use]
    pub fn grid(&self, face: u32) -> &[u32] {
        let size = self.side() * self.side();
        &self.grids[face as usize * size..(face as usize + 1) * size]
    }
}
