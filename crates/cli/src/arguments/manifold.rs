//! What can be said about manifolds of compatible sparse representations.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// `msplines fit sparse-manifold`.
#[derive(Debug, Args)]
pub(crate) struct SparseManifold {
    /// Control mesh of quads (OBJ, OFF or PLY), whose Catmull-Clark surface is approximated; with
    /// --scan a mesh of triangles that is itself approximated.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .ply, .vtu, .glb or .obj for the surface, .json
    /// for the spline.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// Sharp edges and corners: rows of two vertex numbers from 1, the same twice for a corner, and a
    /// sharpness, 10 for always. Where absent, the file beside the mesh that is named alike and ends
    /// in .creases; `none` for a smooth surface.
    #[arg(long, value_name = "FILE|none")]
    pub(crate) creases: Option<PathBuf>,
    /// Most functions that a chart is a combination of.
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) sparsity: u32,
    /// Which function comes next.
    #[arg(long, value_enum, default_value_t = AtomSelection::Plain)]
    pub(crate) selection: AtomSelection,
    /// Catmull-Clark steps whose points are approximated.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=6))]
    pub(crate) levels: u32,
    /// How the function of a chart is found.
    #[arg(long, value_enum, default_value_t = LocalFit::Sparse)]
    pub(crate) local: LocalFit,
    /// Let all charts have kinks, not only those that a sharp edge or corner touches.
    #[arg(long)]
    pub(crate) open_gate: bool,
    /// Vertices whose charts stay smooth whatever touches them, counted from 0.
    #[arg(long, value_name = "V,...", value_delimiter = ',')]
    pub(crate) smooth_charts: Vec<u32>,
    /// The settings of the paper: two levels, 25 functions for each coordinate, kinks everywhere.
    #[arg(long, conflicts_with_all = ["sparsity", "selection", "levels", "local", "open_gate"])]
    pub(crate) paper: bool,
    /// Put a mesh with other faces than quads through one Catmull-Clark step.
    #[arg(long)]
    pub(crate) refine_polygons: bool,
    /// How semi-sharp edges get smooth.
    #[arg(long, value_enum, default_value_t = CreaseRule::Uniform)]
    pub(crate) crease_rule: CreaseRule,
    /// Round the corners of an open mesh, too.
    #[arg(long)]
    pub(crate) smooth_corners: bool,
    /// Approximate the input itself: it is decimated to so many vertices, whose faces become quads.
    #[arg(long, value_name = "VERTICES", conflicts_with_all = ["creases", "refine_polygons"])]
    pub(crate) scan: Option<usize>,
    /// Cut every face of the surface into so many by so many cells.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) tessellate: u32,
    /// Write only the digest of the mesh file into a .json, not the mesh.
    #[arg(long)]
    pub(crate) domain_by_digest: bool,
}

/// `msplines fit curve-network`.
#[derive(Debug, Args)]
pub(crate) struct CurveNetwork {
    /// Curves that meet at common points: .curves, .obj with lines, or .svg with paths.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .ply, .vtu, .glb or .obj for the surface, .json
    /// for the spline.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// A cycle of points, counted from 0, that stays open; more than one by repeating.
    #[arg(long, value_name = "P,P,...", value_parser = points)]
    pub(crate) hole: Vec<Points>,
    /// A cycle of points that is filled although it looks like an opening; more than one by repeating.
    #[arg(long, value_name = "P,P,...", value_parser = points)]
    pub(crate) fill: Vec<Points>,
    /// A cycle of points around a patch; with any, no others are looked for.
    #[arg(long, value_name = "P,P,...", value_parser = points)]
    pub(crate) cycle: Vec<Points>,
    /// Number of vertices less edges plus faces that the surface should have.
    #[arg(long, value_name = "CHI", allow_hyphen_values = true)]
    pub(crate) expected_euler: Option<i64>,
    /// Keep kinks out, or let them in everywhere, instead of along creases only.
    #[arg(long, value_enum, default_value_t = Kinks::Creases)]
    pub(crate) kinks: Kinks,
    /// Largest degree of the polynomials of a chart, instead of 6.
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(1..=14))]
    pub(crate) degree: Option<u32>,
    /// The paper's pursuit on the curves alone, which leaves to chance what lies between them.
    #[arg(long, conflicts_with_all = ["kinks", "degree"])]
    pub(crate) paper: bool,
    /// Cut every face of the surface into so many by so many cells.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) tessellate: u32,
}

/// Points of a cycle.
#[derive(Clone, Debug)]
pub(crate) struct Points(pub(crate) Vec<u32>);

fn points(text: &str) -> Result<Points, String> {
    let points: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    points
        .map(Points)
        .map_err(|_| "give the numbers of points, such as 3,7,12,9".to_owned())
}

/// Where a surface over curves may have kinks.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Kinks {
    /// Along curves that are flagged as creases.
    Creases,
    /// Along all curves.
    Everywhere,
    /// Nowhere.
    Nowhere,
}

/// Which function of a chart comes next.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum AtomSelection {
    /// The one closest to what is left: orthogonal matching pursuit.
    Omp,
    /// The one that leaves least: order-recursive matching pursuit.
    Ormp,
    /// The one of largest correlation, whatever its length.
    Plain,
}

/// How the function of a chart is found.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum LocalFit {
    /// A few of many functions.
    Sparse,
    /// All polynomials up to a degree, by least squares.
    Polynomial,
    /// Splines, by least squares.
    Spline,
}

/// How semi-sharp edges get smooth.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum CreaseRule {
    /// By one each step.
    Uniform,
    /// The same, after averaging with their neighbours.
    Chaikin,
}
