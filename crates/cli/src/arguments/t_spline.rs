//! What can be said about T-splines.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use msplines_compare::case::{Form, Puncture};
use msplines_t_spline::Sampling;

/// `msplines fit t-spline`.
#[derive(Debug, Args)]
pub(crate) struct TSpline {
    /// Mesh file: OBJ, OFF, PLY or STL, of any genus, closed or with holes.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .json for the spline; .ply, .obj or .glb for its
    /// points at the vertices of the input, or a tessellation with --tessellate; .npy for the points
    /// alone.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// Control points, as many as there may be; 2000 where neither these nor a tolerance are given.
    #[arg(long, value_name = "N", conflicts_with = "tolerance")]
    pub(crate) control_points: Option<usize>,
    /// Largest distance of a vertex from the surface, as a percentage or fraction of the longest side
    /// of the bounding box: 0.36% or 0.0036.
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Whether vertices move over the domain to the nearest points of the surface.
    #[arg(long, value_enum, default_value_t = Toggle::On)]
    pub(crate) correction: Toggle,
    /// Vertices, counted from 0, whose stars are removed and closed by caps; `auto` for as many at
    /// the protrusions of a closed surface as make its form more even. Surfaces of genus 0 need two such or
    /// long boundary loops; the farthest from each other where absent. Short loops are closed.
    #[arg(long, value_name = "V,...|auto", allow_hyphen_values = true)]
    pub(crate) puncture: Option<Puncture>,
    /// Weight of the thin plate, relative to that of the vertices.
    #[arg(long, value_name = "W", allow_hyphen_values = true)]
    pub(crate) fairness: Option<f64>,
    /// Samples wanted per control point: faces too large for that are sampled inside, and 0 leaves it at
    /// the vertices.
    #[arg(long, value_name = "N", default_value_t = Sampling::default().per_control_point)]
    pub(crate) face_samples: f64,
    /// How the systems are solved: the paper iterates.
    #[arg(long, value_enum, default_value_t = Solver::Factorisation)]
    pub(crate) solver: Solver,
    /// The holomorphic form of a closed surface with handles, of integer periods.
    #[arg(long, value_name = "integer|integer:N,...", allow_hyphen_values = true)]
    pub(crate) form: Option<Form>,
    /// Triangles along each side of a face in files of the surface; its points at the vertices of the
    /// input where absent.
    #[arg(long, value_name = "N")]
    pub(crate) tessellate: Option<u32>,
    /// Also measure the two-sided distance between the input and the surface.
    #[arg(long)]
    pub(crate) distance: bool,
    /// Write only the digest of the mesh file into a .json, not the mesh.
    #[arg(long)]
    pub(crate) domain_by_digest: bool,
}

/// Whether something is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Toggle {
    /// It is.
    On,
    /// It is not.
    Off,
}

/// How a system of equations is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Solver {
    /// By a sparse factorisation.
    Factorisation,
    /// By conjugate gradients.
    ConjugateGradients,
}

fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(percent) => (percent, 100.0),
        None => (text, 1.0),
    };
    let number = number.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let number = number.ok_or("give a percentage or a fraction, such as 0.36% or 0.0036")?;
    Ok(number / unit)
}
