//! Which lattice points are inside, and where lattice edges are cut.

use super::crossings::Crossing;
use super::grid::{DIRECTIONS, Grid, STEPS};

/// Direction whose lines the winding numbers are added up along.
const UPWARDS: u32 = 2;

/// A point where the surface of the solid cuts a lattice edge with one end inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The lower and the upper end.
    pub(super) ends: [u32; 2],
    /// Direction of the edge.
    pub(super) direction: u8,
    /// Fraction of the edge from its lower end.
    pub(super) fraction: f64,
}

/// The lattice points inside and the cuts between them and those outside.
pub(super) struct Lattice {
    /// Whether each lattice point is inside.
    pub(super) inside: Vec<bool>,
    /// Cuts, by lower end and direction.
    pub(super) cuts: Vec<Cut>,
}

impl Lattice {
    /// Returns the lattice of the solid that a surface winds around, `inwards` telling whether the
    /// surface is oriented inwards.
    pub(super) fn build(grid: &Grid, crossings: &[Crossing], inwards: bool) -> Self {
        let sense = if inwards { -1 } else { 1 };
        let windings = windings(grid, crossings, sense);
        let mut cuts = Vec::new();
        for same in crossings.chunk_by(|a, b| a.edge == b.edge) {
            let (lower, direction) = (
                same[0].edge / DIRECTIONS as u32,
                same[0].edge % DIRECTIONS as u32,
            );
            let [at, step] = [grid.coordinates(lower), STEPS[direction as usize]];
            let upper = grid.id([0, 1, 2].map(|axis| at[axis] + step[axis]));
            let winding = windings[lower as usize];
            let starts_inside = winding > 0;
            if starts_inside == (windings[upper as usize] > 0) {
                continue;
            }
            cuts.push(Cut {
                ends: [lower, upper],
                direction: direction as u8,
                fraction: nearest_to_inside(same, winding, sense),
            });
        }
        Self {
            inside: windings.into_iter().map(|winding| winding > 0).collect(),
            cuts,
        }
    }
}

/// Returns how often the surface winds around each lattice point.
fn windings(grid: &Grid, crossings: &[Crossing], sense: i32) -> Vec<i32> {
    let mut windings = vec![0i32; grid.point_count()];
    let strides = grid.strides();
    for crossing in crossings {
        if crossing.edge % DIRECTIONS as u32 == UPWARDS {
            let lower = (crossing.edge / DIRECTIONS as u32) as usize;
            let layer = strides.iter().find(|(range, _)| range.contains(&lower));
            let stride = layer.map_or(0, |(_, stride)| *stride);
            windings[lower + stride] += sense * i32::from(crossing.turn);
        }
    }
    for (range, stride) in strides {
        let layer = &mut windings[range];
        for place in stride..layer.len() {
            layer[place] += layer[place - stride];
        }
    }
    windings
}

/// Returns the first change between inside and outside along an edge, from its end inside.
fn nearest_to_inside(crossings: &[Crossing], lower: i32, sense: i32) -> f64 {
    let starts_inside = lower > 0;
    let (mut winding, mut found) = (lower, crossings[0].fraction);
    for crossing in crossings {
        let was_inside = winding > 0;
        winding += sense * i32::from(crossing.turn);
        if was_inside != (winding > 0) {
            found = crossing.fraction;
            if starts_inside {
                break;
            }
        }
    }
    found
}
