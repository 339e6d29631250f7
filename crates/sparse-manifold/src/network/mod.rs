//! Surfaces from curve networks.
//!
//! A [`CurveNetwork`](msplines_common::mesh::curves::CurveNetwork) becomes a [`CurveGraph`]:
//! junctions, and arcs between them that are smooth where their curve is. [`find_cycles`] tells which
//! arcs bound a patch, and [`NetworkDomain`] makes quads of the patches, each of whose edges knows the
//! piece of curve that runs along it. [`surface_network`] does all of it and puts a surface over the
//! quads that follows the curves and bends little between them.
//!
//! # Reference
//! [Wang2016] §4.3; cycles after [Zhuang2013].

mod arc_curve;
mod bending;
mod chase;
mod coons;
mod cycles;
mod domain;
mod error;
mod facets;
mod fill;
mod graph;
mod nodes;
mod options;
mod parameter;
mod report;
mod segments;
mod speeds;
mod surface;
mod system;
mod touching;

#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod uneven_tests;

pub use arc_curve::ArcCurve;
pub use cycles::{Cycle, CycleOptions, CycleReport, Cycles, find_cycles};
pub use domain::{DomainVertex, EdgeCurve, NetworkDomain};
pub use error::NetworkError;
pub use graph::{CurveGraph, Junction, NetworkArc};
pub use options::{C0Atoms, CurveSpeed, FillEnergy, NetworkOptions, SurfaceMethod};
pub use report::NetworkReport;
pub use speeds::ConePoint;
pub use surface::{NetworkFit, surface_network};
