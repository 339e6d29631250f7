//! The segments of a network, and how the curves go on at their ends.
//!
//! # Notation
//! Segment `s` has two ends, `2 s` at its first point and `2 s + 1` at its second. Two ends at a point
//! are linked if one curve runs smoothly from one segment into the other.

use msplines_common::mesh::curves::CurveNetwork;
use nalgebra::{Point3, Vector3};

use super::arc_curve::catmull_rom;

/// Cosine between the directions of two ends up to which they may be one smooth curve, where the
/// network does not tell: a turn of up to 32 degrees.
const STRAIGHT: f64 = -0.85;

/// One straight piece of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) points: [u32; 2],
    pub(super) curve: usize,
    pub(super) crease: bool,
}

/// All segments, the ends at every point, and their links.
pub(super) struct Segments<'a> {
    pub(super) network: &'a CurveNetwork,
    pub(super) list: Vec<Segment>,
    /// The end that continues each end.
    links: Vec<Option<u32>>,
    ends: Vec<u32>,
    offsets: Vec<u32>,
}

impl<'a> Segments<'a> {
    /// Returns the segments of a network. Curves that only end at others are linked where they
    /// hardly turn: at points of two ends always, at junctions if no curve runs through any.
    pub(super) fn of(network: &'a CurveNetwork) -> Self {
        let mut segments = Self {
            network,
            list: Vec::with_capacity(network.segment_count()),
            links: vec![None; 2 * network.segment_count()],
            ends: Vec::new(),
            offsets: Vec::new(),
        };
        for (index, curve) in network.curves().iter().enumerate() {
            let first = segments.list.len();
            for (points, &crease) in curve.points.windows(2).zip(&curve.creases) {
                segments.list.push(Segment {
                    points: [points[0], points[1]],
                    curve: index,
                    crease,
                });
            }
            let last = segments.list.len() - 1;
            for s in first..last {
                segments.link(2 * s as u32 + 1, 2 * s as u32 + 2);
            }
            if curve.is_closed() {
                segments.link(2 * last as u32 + 1, 2 * first as u32);
            }
        }
        segments.gather_ends();
        segments.guess_links();
        segments
    }

    fn link(&mut self, one: u32, two: u32) {
        self.links[one as usize] = Some(two);
        self.links[two as usize] = Some(one);
    }

    fn gather_ends(&mut self) {
        let mut by_point: Vec<(u32, u32)> = (0..2 * self.list.len() as u32)
            .map(|end| (self.point_id(end), end))
            .collect();
        by_point.sort_unstable();
        let points = self.network.points().len() as u32;
        self.ends = by_point.iter().map(|pair| pair.1).collect();
        self.offsets = (0..=points)
            .map(|p| by_point.partition_point(|pair| pair.0 < p) as u32)
            .collect();
    }

    fn guess_links(&mut self) {
        let points = 0..self.network.points().len() as u32;
        let through = |p: u32| {
            let ends = self.ends_at(p);
            ends.len() > 2 && ends.iter().any(|&end| self.links[end as usize].is_some())
        };
        let at_junctions = !points.clone().any(through);
        for p in points {
            let free = self.ends_at(p).iter().copied();
            let free: Vec<u32> = free.filter(|&e| self.links[e as usize].is_none()).collect();
            if self.ends_at(p).len() != 2 && !at_junctions {
                continue;
            }
            let straightest = |end: u32| {
                let cosine = |other: u32| self.direction(end).dot(&self.direction(other));
                let others = free.iter().copied().filter(|&other| other != end);
                others
                    .map(|other| (cosine(other), other))
                    .filter(|pair| pair.0 < STRAIGHT)
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .map(|pair| pair.1)
            };
            let mutual = |&end: &u32| {
                let other = straightest(end)?;
                (end < other && straightest(other) == Some(end)).then_some((end, other))
            };
            let pairs: Vec<(u32, u32)> = free.iter().filter_map(mutual).collect();
            for (one, two) in pairs {
                self.link(one, two);
            }
        }
    }

    /// Returns the index of the point at an end.
    pub(super) fn point_id(&self, end: u32) -> u32 {
        self.list[end as usize / 2].points[end as usize % 2]
    }

    /// Returns the point at an end.
    pub(super) fn point(&self, end: u32) -> Point3<f64> {
        self.network.points()[self.point_id(end) as usize]
    }

    /// Returns the ends at a point, ascending.
    pub(super) fn ends_at(&self, point: u32) -> &[u32] {
        let point = point as usize;
        &self.ends[self.offsets[point] as usize..self.offsets[point + 1] as usize]
    }

    /// Returns the end in which the curve of an end continues.
    pub(super) fn continuation(&self, end: u32) -> Option<u32> {
        self.links[end as usize]
    }

    /// Returns the unit vector from an end into its segment.
    fn direction(&self, end: u32) -> Vector3<f64> {
        (self.point(end ^ 1) - self.point(end)).normalize()
    }

    /// Returns the smooth curve of a segment from an end to the other.
    pub(super) fn cubic(&self, end: u32) -> [Point3<f64>; 4] {
        let beyond = |end: u32| self.continuation(end).map(|next| self.point(next ^ 1));
        let ends = [self.point(end), self.point(end ^ 1)];
        catmull_rom(beyond(end), ends, beyond(end ^ 1))
    }
}
