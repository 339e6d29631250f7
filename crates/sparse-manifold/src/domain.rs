//! The manifold under a surface: one chart for every vertex of a quad mesh.
//!
//! # Notation
//! The faces around a vertex of valence `k` are its sectors `j = 0, 1, ..`, counter-clockwise. In
//! sector `j` a point has the corner coordinates `(u, v)` in the unit square, `u` towards the
//! neighbour along the sector's first edge and `v` towards that along its last one, and in the chart
//! it lies at `z = (u + i v)^(4/k) exp(2πi j / k)`. A boundary vertex of `m` sectors fills half of a
//! star of valence `2 m`, and a corner with a single sector a quarter of one of valence 4.
//!
//! Going from one chart to another is a power, an affine map of the square onto itself and a power:
//! holomorphic, hence smooth.
//!
//! # Reference
//! [YingZorin2004]; [Wang2016] §3.1, §4.1; [TosunZorin2011] for boundaries.

use std::f64::consts::{PI, TAU};

use msplines_common::mesh::polygon::{PolygonTopology, Sharpness};

use crate::jet::Jet;

/// Corner coordinates this close to zero count as zero: rounding must not turn a point on the first
/// edge of a sector into one at the end of the sector before.
const ON_EDGE: f64 = 1e-12;

/// The shape of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Star {
    /// Number of faces around the vertex.
    pub sectors: u32,
    /// Number of faces that would close the star: as many, or twice as many on the boundary.
    pub valence: u32,
}

impl Star {
    /// Returns the shape of the chart of a vertex.
    #[must_use]
    pub fn of(topology: &PolygonTopology, vertex: u32) -> Self {
        let sectors = topology.outgoing(vertex).count() as u32;
        let valence = match (topology.is_boundary_vertex(vertex), sectors) {
            (false, _) => sectors,
            (true, 1) => 4,
            (true, _) => 2 * sectors,
        };
        Self { sectors, valence }
    }

    /// Returns whether the sectors go all around.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.sectors == self.valence
    }

    /// Returns the distance of the farthest points from the centre.
    #[must_use]
    pub fn radius(&self) -> f64 {
        (2.0 / f64::from(self.valence)).exp2()
    }

    /// Returns the position in the chart of a point given by its sector and corner coordinates.
    #[must_use]
    pub fn position(&self, sector: u32, [u, v]: [f64; 2]) -> [f64; 2] {
        let k = f64::from(self.valence);
        let (length, angle) = (u.hypot(v), v.atan2(u));
        let length = length.powf(4.0 / k);
        let angle = angle * 4.0 / k + TAU * f64::from(sector) / k;
        [length * angle.cos(), length * angle.sin()]
    }

    /// Returns the sector and corner coordinates of a position in the chart.
    ///
    /// On an open star, a position beyond its sectors belongs to the nearest of them.
    #[must_use]
    pub fn locate(&self, [x, y]: [f64; 2]) -> (u32, [f64; 2]) {
        let k = f64::from(self.valence);
        let turn = TAU / k;
        let mut angle = y.atan2(x);
        if angle < -ON_EDGE {
            angle += TAU;
        }
        let angle = angle.max(0.0);
        let middle = 0.5 * (f64::from(self.sectors) * turn + TAU);
        let last = self.sectors - 1;
        let sector = match (self.is_closed(), (angle / turn + ON_EDGE) as u32) {
            (true, sector) if sector > last => 0,
            (false, sector) if sector > last && angle > middle => 0,
            (_, sector) => sector.min(last),
        };
        let mut local = angle - turn * f64::from(sector);
        if local > PI {
            local -= TAU;
        }
        let (sin, cos) = (local * k / 4.0).sin_cos();
        let length = x.hypot(y).powf(k / 4.0);
        let snap = |c: f64| if c.abs() < ON_EDGE { 0.0 } else { c };
        (sector, [snap(length * cos), snap(length * sin)])
    }

    /// Returns the chart position with its derivatives by the corner coordinates.
    ///
    /// At the centre of a star of another valence than four they are zero or infinite.
    pub(crate) fn jets(&self, sector: u32, at: [f64; 2]) -> [Jet; 2] {
        let k = f64::from(self.valence);
        power_jets(4.0 / k, TAU * f64::from(sector) / k, at)
    }
}

/// Returns real and imaginary part of `exp(i turn) (u + i v)^power` with their derivatives.
pub(crate) fn power_jets(power: f64, turn: f64, [u, v]: [f64; 2]) -> [Jet; 2] {
    let (length, angle) = (u.hypot(v), v.atan2(u));
    // The n-th derivative of the power is falling(n) w^(power - n).
    let derivative = |factor: f64, order: f64| {
        if factor == 0.0 {
            return [0.0, 0.0];
        }
        let size = factor * length.powf(power - order);
        let (sin, cos) = (angle * (power - order) + turn).sin_cos();
        [size * cos, size * sin]
    };
    let z = derivative(1.0, 0.0);
    let first = derivative(power, 1.0);
    let second = derivative(power * (power - 1.0), 2.0);
    // By v is i times by u.
    let x = Jet {
        value: z[0],
        first: [first[0], -first[1]],
        second: [second[0], -second[1], -second[0]],
    };
    let y = Jet {
        value: z[1],
        first: [first[1], first[0]],
        second: [second[1], second[0], -second[1]],
    };
    [x, y]
}

/// The corner coordinates at each corner of a face, as functions of its `(s, t)`: rows of a rotation.
pub(crate) const TURNS: [[[f64; 2]; 2]; 4] = [
    [[1.0, 0.0], [0.0, 1.0]],
    [[0.0, 1.0], [-1.0, 0.0]],
    [[-1.0, 0.0], [0.0, -1.0]],
    [[0.0, -1.0], [1.0, 0.0]],
];

/// Returns the coordinates of a point of a face at one of its corners.
#[must_use]
pub fn corner_coordinates(corner: u32, [s, t]: [f64; 2]) -> [f64; 2] {
    match corner {
        0 => [s, t],
        1 => [t, 1.0 - s],
        2 => [1.0 - s, 1.0 - t],
        _ => [1.0 - t, s],
    }
}

/// Returns the point of a face with these coordinates at one of its corners.
#[must_use]
pub fn face_coordinates(corner: u32, [u, v]: [f64; 2]) -> [f64; 2] {
    match corner {
        0 => [u, v],
        1 => [1.0 - v, u],
        2 => [1.0 - u, 1.0 - v],
        _ => [v, 1.0 - u],
    }
}

/// The charts of a quad mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    stars: Vec<Star>,
    corner_sectors: Vec<u32>,
    colours: Vec<Vec<u32>>,
}

impl Domain {
    /// Builds the charts of a mesh of quads, in O(n).
    ///
    /// # Panics
    /// If a face is no quad.
    #[must_use]
    pub fn build(topology: &PolygonTopology) -> Self {
        assert!(topology.is_quad(), "charts need quads");
        let vertices = 0..topology.vertex_count() as u32;
        let mut corner_sectors = vec![0; topology.half_edge_count()];
        for vertex in vertices.clone() {
            for (sector, h) in topology.outgoing(vertex).enumerate() {
                corner_sectors[h as usize] = sector as u32;
            }
        }
        Self {
            stars: vertices.map(|v| Star::of(topology, v)).collect(),
            corner_sectors,
            colours: colours(topology),
        }
    }

    /// Returns the shapes of the charts, one for each vertex.
    #[must_use]
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }

    /// Returns the sector that a corner of a face is in the chart of its vertex.
    #[must_use]
    pub fn sector(&self, corner: u32) -> u32 {
        self.corner_sectors[corner as usize]
    }

    /// Returns sets of charts that have no face in common, which together are all charts.
    #[must_use]
    pub fn colours(&self) -> &[Vec<u32>] {
        &self.colours
    }
}

/// Returns, for every chart, whether a sharp edge inside of the surface or a sharp corner touches it.
///
/// The boundary does not count: the half-star of a chart there has it as its end, not inside.
#[must_use]
pub fn sharp_charts(topology: &PolygonTopology, sharpness: &Sharpness) -> Vec<bool> {
    let vertices = 0..topology.vertex_count() as u32;
    vertices.map(|v| is_sharp(topology, sharpness, v)).collect()
}

fn is_sharp(topology: &PolygonTopology, sharpness: &Sharpness, vertex: u32) -> bool {
    let inside = |h: u32| !topology.is_boundary_edge(topology.edge(h));
    let mut spokes = topology.spokes(vertex).filter(|&h| inside(h));
    let corner = sharpness.vertex(vertex) > 0.0 && topology.outgoing(vertex).count() > 1;
    corner || spokes.any(|h| sharpness.edge(topology.edge(h)) > 0.0)
}

/// Colours vertices so that those of a face differ, the first free colour for each in their order.
fn colours(topology: &PolygonTopology) -> Vec<Vec<u32>> {
    let mut colour_of = vec![u32::MAX; topology.vertex_count()];
    let mut colours: Vec<Vec<u32>> = Vec::new();
    let mut taken = Vec::new();
    for vertex in 0..topology.vertex_count() as u32 {
        taken.clear();
        taken.resize(colours.len(), false);
        for h in topology.outgoing(vertex) {
            for &other in topology.face_vertices(topology.face(h)) {
                if let Some(slot) = taken.get_mut(colour_of[other as usize] as usize) {
                    *slot = true;
                }
            }
        }
        let free = taken
            .iter()
            .position(|&used| !used)
            .unwrap_or(colours.len());
        if free == colours.len() {
            colours.push(Vec::new());
        }
        colours[free].push(vertex);
        colour_of[vertex as usize] = free as u32;
    }
    colours
}
