//! What can be said about conformal atlases.

use std::path::PathBuf;

use clap::Args;
use msplines_compare::case::Form;

/// `msplines conformal`.
#[derive(Debug, Args)]
pub(crate) struct Conformal {
    /// Mesh file: OBJ, OFF, PLY or STL. Of any genus, closed or with holes.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .json for the atlas; .obj, .ply or .glb for the mesh
    /// with texture coordinates of corners, in which an image of 8 by 8 squares shows 40 along the
    /// diagonal; .npy for these coordinates alone, a row of six for every face.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// The holomorphic form of a surface with handles: that of most even length, which is taken where
    /// absent, the most even one with integer periods of its imaginary part, or the one with these
    /// periods or coefficients of its real part, two for every handle.
    #[arg(
        long,
        value_name = "optimal|integer|periods:X,...|coefficients:X,...",
        allow_hyphen_values = true
    )]
    pub(crate) form: Option<Form>,
    /// Vertices, counted from 0, whose stars are removed first.
    #[arg(long, value_name = "V,...", value_delimiter = ',')]
    pub(crate) puncture: Vec<u32>,
}
