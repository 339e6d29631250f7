//! Surfaces from curve networks.
//!
//! # Reference
//! [Wang2016] §4.3.
