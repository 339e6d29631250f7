//! Surfaces from curve networks.
//!
//! A [`CurveNetwork`](msplines_common::mesh::curves::CurveNetwork) becomes a [`CurveGraph`]:
//! junctions, and arcs between them that are smooth where their curve is. [`find_cycles`] tells which
//! arcs bound a patch, and [`NetworkDomain`] makes quads of the patches, each of whose edges knows the
//! piece of curve that runs along it.
//!
//! # Reference
//! [Wang2016] §4.3; cycles after [Zhuang2013].

mod arc_curve;
mod cycles;
mod domain;
mod error;
mod graph;
mod segments;
mod touching;

#[cfg(test)]
mod tests;

pub use arc_curve::ArcCurve;
pub use cycles::{Cycle, CycleOptions, CycleReport, Cycles, find_cycles};
pub use domain::{DomainVertex, EdgeCurve, NetworkDomain};
pub use error::NetworkError;
pub use graph::{CurveGraph, Junction, NetworkArc};
