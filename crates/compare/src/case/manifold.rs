//! Sparse manifolds as runs are asked for them.

use std::path::PathBuf;

use msplines_common::mesh::polygon::Rules;
use serde::{Deserialize, Serialize};

/// A sparse manifold with its options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SparseManifoldMethod {
    /// Options of the fit.
    pub options: msplines_sparse_manifold::Options,
    /// Variants of Catmull-Clark subdivision.
    pub rules: Rules,
    /// Where the sharpness of edges and corners comes from.
    pub creases: Creases,
    /// What is done with faces that are not quads.
    pub polygons: Polygons,
    /// Cells along the side of a face when the surface is cut into triangles.
    pub cells: u32,
    /// Vertices of a scan after decimation, from which the control mesh is made; the input is a control
    /// mesh itself where absent.
    pub scan: Option<usize>,
}

impl Default for SparseManifoldMethod {
    fn default() -> Self {
        Self {
            options: Default::default(),
            rules: Rules::default(),
            creases: Creases::Beside,
            polygons: Polygons::Refuse,
            cells: 8,
            scan: None,
        }
    }
}

/// A surface over a curve network with its options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CurveNetworkMethod {
    /// Options of cycles and fit.
    pub options: msplines_sparse_manifold::network::NetworkOptions,
    /// Cells along the side of a face when the surface is cut into triangles.
    pub cells: u32,
}

impl Default for CurveNetworkMethod {
    fn default() -> Self {
        Self {
            options: Default::default(),
            cells: 8,
        }
    }
}

/// The function of a single chart with its options.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChartMethod {
    /// How it is found.
    pub local: msplines_sparse_manifold::Local,
    /// Cells along the side of a sector at whose corners it is compared and shown.
    pub cells: u32,
}

impl ChartMethod {
    /// Returns the method with the default resolution.
    #[must_use]
    pub fn new(local: msplines_sparse_manifold::Local) -> Self {
        Self { local, cells: 32 }
    }
}

/// Where the sharpness of edges and corners comes from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Creases {
    /// The file of the same name with the extension `.creases`, if there is one.
    #[default]
    Beside,
    /// This file.
    File(PathBuf),
    /// Nothing is sharp but the boundary.
    None,
}

/// What is done with faces that are not quads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Polygons {
    /// They are refused.
    #[default]
    Refuse,
    /// All faces go through one Catmull-Clark step.
    Refine,
}
