//! Boxes laid out over borders.

use super::{Beyond, Border, CylinderComplex, Node};

/// The part of a developed box that lies in one cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Piece {
    /// The cylinder.
    pub cylinder: u32,
    /// Where the node would be in the coordinates of that cylinder, as seen from this piece.
    pub origin: [i64; 2],
    /// Extent in `x`, within `[0, C]`.
    pub x: [i64; 2],
    /// Extent in `y`, within `[0, H]`.
    pub y: [i64; 2],
}

/// A box around a node, laid out over the surface: straight on from the node in `x`, then in `y`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Development {
    /// Its parts, of positive area: several of one cylinder where the box is wider than that is round.
    /// No two have the same origin if there are no zeros inside, so that a point near the node lies as
    /// often in the box as there are origins from which it does.
    pub pieces: Vec<Piece>,
    /// Zeros strictly inside, relative to the node.
    pub zeros: Vec<[i64; 2]>,
}

/// One strip of the box on its way: a range of `x`, not wrapped, in a cylinder.
#[derive(Clone, Copy)]
struct Strip {
    cylinder: u32,
    origin: [i64; 2],
    x: [i64; 2],
}

impl CylinderComplex {
    /// Lays out the box `x` by `y` around a node; parts beyond the surface are left out.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn develop(&self, node: Node, x: [i64; 2], y: [i64; 2]) -> Development {
        let mut out = Development::default();
        let strip = Strip {
            cylinder: node.cylinder,
            origin: [node.x, node.y],
            x: x.map(|end| node.x + end),
        };
        self.lay_strip(strip, y, &mut out);
        for border in [Border::Bottom, Border::Top] {
            self.develop_over(strip, border, [x, y], &mut out);
        }
        out.pieces.sort_unstable();
        out.pieces.dedup_by(|next, first| {
            // Tables may start inside of a box, and break what is one piece.
            let same = (next.cylinder, next.origin) == (first.cylinder, first.origin);
            if same {
                first.x = [first.x[0].min(next.x[0]), first.x[1].max(next.x[1])];
            }
            same
        });
        out
    }

    /// Adds the images of a strip within its cylinder.
    fn lay_strip(&self, strip: Strip, y: [i64; 2], out: &mut Development) {
        let own = &self.cylinders[strip.cylinder as usize];
        let y = [
            (strip.origin[1] + y[0]).max(0),
            (strip.origin[1] + y[1]).min(own.height),
        ];
        if y[0] >= y[1] {
            return;
        }
        let size = own.circumference;
        for turn in strip.x[0].div_euclid(size)..=(strip.x[1] - 1).div_euclid(size) {
            let shift = turn * size;
            out.pieces.push(Piece {
                cylinder: strip.cylinder,
                origin: [strip.origin[0] - shift, strip.origin[1]],
                x: [(strip.x[0] - shift).max(0), (strip.x[1] - shift).min(size)],
                y,
            });
        }
    }

    /// Continues a strip over a border and on, as far as the box goes.
    fn develop_over(
        &self,
        strip: Strip,
        border: Border,
        bounds: [[i64; 2]; 2],
        out: &mut Development,
    ) {
        let own = &self.cylinders[strip.cylinder as usize];
        let edge = match border {
            Border::Bottom => 0,
            Border::Top => own.height,
        } - strip.origin[1];
        let [x, y] = bounds;
        if edge <= y[0] && border == Border::Bottom || edge >= y[1] && border == Border::Top {
            return;
        }
        let mut from = strip.x[0];
        while from < strip.x[1] {
            let segment = self.segment(strip.cylinder, border, from);
            let into = from.rem_euclid(own.circumference) - segment.start;
            let across = from - strip.origin[0];
            if into == 0 && segment.zero.is_some() && x[0] < across && across < x[1] {
                out.zeros.push([across, edge]);
            }
            let to = strip.x[1].min(from + segment.length - into);
            if let Beyond::Cylinder { cylinder, start } = segment.beyond {
                let shift = start + into - from;
                let there = match border {
                    Border::Bottom => self.cylinders[cylinder as usize].height,
                    Border::Top => 0,
                };
                let next = Strip {
                    cylinder,
                    origin: [strip.origin[0] + shift, there - edge],
                    x: [from + shift, to + shift],
                };
                self.lay_strip(next, y, out);
                self.develop_over(next, border, bounds, out);
            }
            from = to;
        }
    }
}
