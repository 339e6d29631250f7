//! Cylinders in whole units and the joints between them, from which the tables of a complex follow.

use crate::complex::{Beyond, Cylinder, CylinderComplex, Segment};

use super::error::DomainError;
use super::form::End;

/// A critical trajectory in whole units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Joint {
    /// The cylinder whose top it is part of, and where it starts there.
    pub(super) below: Option<(u32, i64)>,
    /// The cylinder whose bottom it is part of, and where it starts there.
    pub(super) above: Option<(u32, i64)>,
    pub(super) length: i64,
    /// The zero at its start.
    pub(super) zero: Option<u32>,
    /// The boundary loop it is.
    pub(super) end: Option<u32>,
}

/// Cylinders, by number, and their joints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Tables {
    pub(super) circumferences: Vec<i64>,
    pub(super) heights: Vec<i64>,
    pub(super) joints: Vec<Joint>,
}

impl Tables {
    /// The joints along one border.
    pub(super) fn along(
        &self,
        cylinder: u32,
        top: bool,
    ) -> impl Iterator<Item = (usize, i64)> + '_ {
        let joints = self.joints.iter().enumerate();
        joints.filter_map(move |(index, joint)| {
            let side = if top { joint.below } else { joint.above };
            side.filter(|side| side.0 == cylinder)
                .map(|side| (index, side.1))
        })
    }

    /// Checks that rounding left every length positive; heights may be 0 before a collapse.
    pub(super) fn check_sizes(&self) -> Result<(), DomainError> {
        let short = self.joints.iter().find(|joint| joint.length <= 0);
        let short = short.and_then(|joint| joint.above.or(joint.below));
        let low = self.heights.iter().position(|&height| height < 0);
        match short
            .map(|side| side.0)
            .or(low.map(|cylinder| cylinder as u32))
        {
            Some(cylinder) => Err(self.thin(cylinder)),
            None => Ok(()),
        }
    }

    fn thin(&self, cylinder: u32) -> DomainError {
        DomainError::Thin {
            cylinder,
            height: self.heights[cylinder as usize],
            circumference: self.circumferences[cylinder as usize],
        }
    }

    /// Builds the complex of the cylinders that have names, which are their numbers there.
    pub(super) fn complex(
        &self,
        names: &[Option<u32>],
        ends: &[End],
    ) -> Result<CylinderComplex, DomainError> {
        let mut cylinders = Vec::new();
        for cylinder in 0..self.heights.len() as u32 {
            if names[cylinder as usize].is_none() {
                continue;
            }
            if self.heights[cylinder as usize] <= 0 {
                return Err(self.thin(cylinder));
            }
            cylinders.push(Cylinder {
                circumference: self.circumferences[cylinder as usize],
                height: self.heights[cylinder as usize],
                bottom: self.segments(cylinder, false, names, ends),
                top: self.segments(cylinder, true, names, ends),
            });
        }
        Ok(CylinderComplex::build(cylinders)?)
    }

    fn segments(
        &self,
        cylinder: u32,
        top: bool,
        names: &[Option<u32>],
        ends: &[End],
    ) -> Vec<Segment> {
        let size = self.circumferences[cylinder as usize];
        let mut segments = Vec::new();
        for (index, start) in self.along(cylinder, top) {
            let joint = &self.joints[index];
            let over = if top { joint.above } else { joint.below };
            let beyond = |into: i64| match (over, joint.end) {
                (Some((other, there)), _) => Beyond::Cylinder {
                    cylinder: names[other as usize].unwrap_or(u32::MAX),
                    start: (there + into).rem_euclid(self.circumferences[other as usize]),
                },
                (None, end) => match end.map(|index| (index, ends[index as usize])) {
                    Some((index, End::Pole(_))) => Beyond::Pole { index },
                    other => Beyond::Boundary {
                        index: other.map_or(0, |end| end.0),
                    },
                },
            };
            let before_wrap = joint.length.min(size - start);
            segments.push(Segment {
                start,
                length: before_wrap,
                beyond: beyond(0),
                zero: joint.zero,
            });
            if before_wrap < joint.length {
                segments.push(Segment {
                    start: 0,
                    length: joint.length - before_wrap,
                    beyond: beyond(before_wrap),
                    zero: None,
                });
            }
        }
        segments.sort_by_key(|segment| segment.start);
        segments
    }
}
