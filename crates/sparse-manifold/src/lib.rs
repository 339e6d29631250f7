//! Manifold surfaces over quad meshes, by sparse representations on charts that agree.
//!
//! # Reference
//! [Wang2016].

pub mod network;
