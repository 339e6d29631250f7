//! A body-centred cubic lattice, and a surface in whole numbers on it.
//!
//! # Notation
//! Lattice points are whole numbers `(i, j, k)` of one parity, in units of half the spacing. Each has
//! 14 neighbours: 6 at `(±2, 0, 0)` and so on along long edges, 8 at `(±1, ±1, ±1)` along short ones.

use msplines_common::mesh::TriangleMesh;
use nalgebra::Point3;

use super::error::MesherError;

/// Whole units of the longest side of the box: products of three differences fit into 128 bits, and
/// of two, projected along a diagonal, into 64.
const UNITS: f64 = (1u64 << 27) as f64;

/// Most lattice points: with all that is kept of each, about 1.5 GB.
const MOST_POINTS: f64 = 1e8;

/// Half spacings between the surface's box and the end of the lattice.
const MARGIN: f64 = 3.4;

/// Number of directions of lattice edges, each one counted with its opposite.
pub(super) const DIRECTIONS: usize = 7;

/// Steps of lattice edges from their lower ends, long ones first.
pub(super) const STEPS: [[i32; 3]; DIRECTIONS] = [
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 1, 1],
    [1, -1, 1],
    [-1, 1, 1],
    [-1, -1, 1],
];

/// A lattice over the box of a surface.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Position of the whole numbers (0, 0, 0).
    origin: Point3<f64>,
    /// Length of a whole unit.
    unit: f64,
    /// Whole units of half the spacing.
    pub(super) half: i64,
    /// Largest coordinate each way, even.
    pub(super) size: [i32; 3],
}

impl Grid {
    pub(super) fn build(surface: &TriangleMesh, spacing: f64) -> Result<Self, MesherError> {
        let [low, high] = surface.bounding_box();
        let extent = (high - low) / (0.5 * spacing);
        let sizes = extent.map(|x| 2.0 * ((x + 2.0 * MARGIN) / 2.0).ceil());
        let points = sizes.product() / 4.0;
        let half = (UNITS / sizes.max()).floor();
        // A box so flat that its other sides need many more steps than its diagonal has is not
        // possible, so that points bound the whole numbers as well.
        if !(points <= MOST_POINTS && half >= 16.0) {
            return Err(MesherError::TooFine {
                spacing,
                points,
                most: MOST_POINTS,
            });
        }
        let unit = 0.5 * spacing / half;
        let size = [sizes.x as i32, sizes.y as i32, sizes.z as i32];
        let centre = nalgebra::center(&low, &high);
        let reach = sizes * (0.25 * spacing);
        Ok(Self {
            origin: centre - reach,
            unit,
            half: half as i64,
            size,
        })
    }

    /// Returns the vertices of a surface in whole units.
    pub(super) fn rounded(&self, surface: &TriangleMesh) -> Vec<[i64; 3]> {
        let rounded = |p: &Point3<f64>| {
            let at = (p - self.origin) / self.unit;
            [
                at.x.round() as i64,
                at.y.round() as i64,
                at.z.round() as i64,
            ]
        };
        surface.positions().iter().map(rounded).collect()
    }

    /// Returns the number of lattice points.
    pub(super) fn point_count(&self) -> usize {
        let [even, odd] = self.layers();
        even.iter().product::<usize>() + odd.iter().product::<usize>()
    }

    /// Returns the numbers of points each way of the even and of the odd points.
    fn layers(&self) -> [[usize; 3]; 2] {
        let odd = self.size.map(|n| n as usize / 2);
        [odd.map(|n| n + 1), odd]
    }

    /// Returns the number of a lattice point: first the even ones, then the odd ones, along the
    /// first axis fastest.
    pub(super) fn id(&self, at: [i32; 3]) -> u32 {
        let [even, odd] = self.layers();
        let [i, j, k] = at.map(|x| (x / 2) as usize);
        if at[0] % 2 == 0 {
            ((k * even[1] + j) * even[0] + i) as u32
        } else {
            (even.iter().product::<usize>() + (k * odd[1] + j) * odd[0] + i) as u32
        }
    }

    /// Returns the coordinates of a lattice point.
    pub(super) fn coordinates(&self, id: u32) -> [i32; 3] {
        let [even, odd] = self.layers();
        let evens: usize = even.iter().product();
        let (place, counts, shift) = match id as usize {
            id if id < evens => (id, even, 0),
            id => (id - evens, odd, 1),
        };
        let [i, j, k] = [
            place % counts[0],
            place / counts[0] % counts[1],
            place / (counts[0] * counts[1]),
        ];
        [i, j, k].map(|x| 2 * x as i32 + shift)
    }

    /// Returns how much larger the number of the point two above is: for even and odd points.
    pub(super) fn strides(&self) -> [(std::ops::Range<usize>, usize); 2] {
        let [even, odd] = self.layers();
        let evens: usize = even.iter().product();
        [
            (0..evens, even[0] * even[1]),
            (evens..self.point_count(), odd[0] * odd[1]),
        ]
    }

    /// Returns the position at a fraction of the way along the lattice edge in a direction.
    pub(super) fn position(&self, lower: [i32; 3], direction: u8, fraction: f64) -> Point3<f64> {
        let step = STEPS[direction as usize];
        let half = self.half as f64 * self.unit;
        let offset = [0, 1, 2]
            .map(|axis| half * (f64::from(lower[axis]) + fraction * f64::from(step[axis])));
        self.origin + nalgebra::Vector3::from(offset)
    }

    /// Returns the position of a lattice point.
    pub(super) fn point(&self, at: [i32; 3]) -> Point3<f64> {
        self.position(at, 0, 0.0)
    }
}

/// Returns the direction of the edge between two neighbouring lattice points, and whether the first
/// is its lower end.
pub(super) fn direction(from: [i32; 3], to: [i32; 3]) -> (u8, bool) {
    let step = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    if let Some(axis) = step.iter().position(|&x| x.abs() == 2) {
        return (axis as u8, step[axis] > 0);
    }
    let upwards = step[2] > 0;
    let (x, y) = (step[0] * step[2] > 0, step[1] * step[2] > 0);
    (3 + 2 * u8::from(!x) + u8::from(!y), upwards)
}
