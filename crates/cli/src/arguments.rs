//! The command line.

mod conformal;
mod manifold;
mod powell_sabin;
mod solid;
mod t_spline;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use msplines_compare::case::{Amount, Knots};

pub(crate) use conformal::Conformal;
pub(crate) use manifold::{
    AtomSelection, CreaseRule, CurveNetwork, Kinks, LocalFit, Points, SparseManifold,
};
pub(crate) use powell_sabin::{Fill, PowellSabin, Reshape, Weights};
pub(crate) use solid::{Deform, Map, SolidFit, Trivariate};
pub(crate) use t_spline::{Solver, TSpline, Toggle};

/// Splines on triangle meshes of any shape.
///
/// Exit codes: 0 a result, 2 the command cannot be meant so, 3 the input is refused, 4 the method
/// cannot take this input, 5 stopped early with the result so far written.
#[derive(Debug, Parser)]
#[command(name = "msplines", version, about)]
pub struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// What every subcommand takes.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Threads; all cores where absent. Results do not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
    /// Seed of everything random.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Say nothing but errors.
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Mend defects of the mesh and say what was done, instead of refusing it.
    #[arg(long, global = true)]
    pub(crate) repair: bool,
    /// Seconds after which the best result so far is written.
    #[arg(long, global = true, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) time_limit: Option<f64>,
    /// File for the record of the run, as JSON.
    #[arg(long, global = true, value_name = "RUN.json")]
    pub(crate) report: Option<PathBuf>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Say what a mesh file holds and list its defects.
    Info(Info),
    /// Fit a spline to a mesh.
    Fit {
        #[command(subcommand)]
        method: Fit,
    },
    /// Split a surface into layers of biharmonic B-splines, and put it together again.
    Decompose(Decompose),
    /// Evaluate a spline file.
    Evaluate(Evaluate),
    /// Move control points of a trivariate spline.
    Deform(Deform),
    /// Move control points of a biharmonic B-spline.
    Edit(Edit),
    /// Change a Powell-Sabin spline without zeros (new vertices, normals, control triangles) or a T-spline
    /// (control points, points of the surface).
    Reshape(Reshape),
    /// Add biharmonic B-splines on the same mesh.
    Combine(Combine),
    /// Lay out a surface in the plane, keeping angles.
    Conformal(Conformal),
}

/// `msplines info`.
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// Mesh file: OBJ, OFF, PLY or STL; or tetrahedra: .mesh, .msh, .vtk, .vtu, or .node with .ele.
    pub(crate) input: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// `msplines fit`.
#[derive(Debug, Subcommand)]
pub(crate) enum Fit {
    /// A biharmonic B-spline with optimised knots.
    Biharmonic(Biharmonic),
    /// A least-squares mesh.
    LsMesh(LsMesh),
    /// A smooth manifold with creases over a mesh of quads.
    SparseManifold(SparseManifold),
    /// A surface through a network of curves.
    CurveNetwork(CurveNetwork),
    /// A solid as a smooth map of the unit cube.
    Trivariate(Trivariate),
    /// One C1 surface through all vertices of a mesh and their normals, of any genus.
    PowellSabin(PowellSabin),
    /// A C2 T-spline that approximates a mesh of any genus.
    TSpline(TSpline),
}

/// What every fit takes.
#[derive(Debug, Args)]
pub(crate) struct FitFiles {
    /// Mesh file: OBJ, OFF, PLY or STL.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .ply, .vtu, .glb or .obj for the surface, .json
    /// for the spline.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// What is fitted: the positions, the colours of the vertices, or the numbers in a NumPy array or
    /// text file with a row for every vertex.
    #[arg(
        long,
        value_name = "positions|colors|FILE",
        default_value = "positions",
        conflicts_with = "attributes"
    )]
    pub(crate) data: String,
    /// Fit these vertex attributes instead of the positions, such as red,green,blue.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) attributes: Vec<String>,
    /// Measure the two-sided distance between the surfaces as well; takes a few seconds.
    #[arg(long)]
    pub(crate) distance: bool,
    /// Write only the digest of the mesh file into a .json, not the mesh.
    #[arg(long)]
    pub(crate) domain_by_digest: bool,
}

/// `msplines fit biharmonic`.
#[derive(Debug, Args)]
pub(crate) struct Biharmonic {
    #[command(flatten)]
    pub(crate) files: FitFiles,
    /// Number of knots, or percentage of the vertices: 1500 or 3%; `all` interpolates every vertex,
    /// `auto` takes as many as the noise of the data bears.
    #[arg(
        long,
        value_name = "N|P%|all|auto",
        required_unless_present = "knots_from"
    )]
    pub(crate) knots: Option<Knots>,
    /// Take the vertices nearest to the points of this mesh or point file as knots.
    #[arg(long, value_name = "FILE", conflicts_with = "knots")]
    pub(crate) knots_from: Option<PathBuf>,
    /// Place those knots at the nearest points of the surface, inside faces as well.
    #[arg(long, requires = "knots_from")]
    pub(crate) inside_faces: bool,
    #[command(flatten)]
    pub(crate) choices: BiharmonicChoices,
}

/// What is chosen about biharmonic B-splines, whatever is done with them.
#[derive(Debug, Args)]
pub(crate) struct BiharmonicChoices {
    /// How the places of the knots are chosen.
    #[arg(long, value_enum, default_value_t = Selection::Exchange)]
    pub(crate) selection: Selection,
    /// Edges where the surface may be sharp: those whose faces meet at more than so many degrees, or
    /// those in a text file, two vertices a line, counted from zero.
    #[arg(long, value_name = "ANGLE|FILE")]
    pub(crate) features: Option<String>,
    /// How much each vertex counts: a NumPy array or text file with a number for every vertex.
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
    /// How long knots are optimised.
    #[arg(long, value_enum, default_value_t = Effort::Standard)]
    pub(crate) effort: Effort,
    /// Move a few knots in the end to lower the largest error, at up to 1 % more mean error.
    #[arg(long)]
    pub(crate) polish: bool,
    /// Use the Laplacian of the intrinsic Delaunay triangulation: slower, for badly shaped
    /// triangles.
    #[arg(long)]
    pub(crate) intrinsic_delaunay: bool,
}

/// How the places of knots are chosen.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Selection {
    /// Backward elimination from a dense sample, then exchange.
    Exchange,
    /// The reweighted l1 norm; for up to some 30,000 vertices.
    L1,
    /// The same, then exchange.
    #[value(name = "l1+exchange")]
    L1Exchange,
    /// A sample that is denser where the data bends.
    Curvature,
    /// An even sample.
    BlueNoise,
}

/// How long knots are optimised.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Effort {
    /// Elimination and one exchange.
    Fast,
    /// Elimination and a few exchanges.
    Standard,
    /// More, smaller rounds.
    Best,
}

/// `msplines decompose`.
#[derive(Debug, Args)]
pub(crate) struct Decompose {
    #[command(flatten)]
    pub(crate) files: FitFiles,
    /// Knots of each layer, coarse to fine, as numbers or percentages of the vertices.
    #[arg(long, value_name = "N|P%,...", value_delimiter = ',', required = true)]
    pub(crate) layers: Vec<Amount>,
    /// Factor of each layer and of what the layers leave; all 1 where absent, which gives the input
    /// back. Larger ones exaggerate, zero leaves out.
    #[arg(
        long,
        value_name = "F,...",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub(crate) factors: Vec<f64>,
    #[command(flatten)]
    pub(crate) choices: BiharmonicChoices,
}

/// `msplines fit ls-mesh`.
#[derive(Debug, Args)]
pub(crate) struct LsMesh {
    #[command(flatten)]
    pub(crate) files: FitFiles,
    /// Number of control vertices, or percentage of the vertices: 1500 or 3%.
    #[arg(long, value_name = "N|P%")]
    pub(crate) controls: Amount,
    /// Solves of the selection, each of which adds as many of the local error maxima; with as many
    /// as controls it is the greedy selection.
    #[arg(long, value_name = "N", conflicts_with = "greedy", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) solves: Option<u32>,
    /// Choose one control vertex per solve, at the largest error.
    #[arg(long)]
    pub(crate) greedy: bool,
    /// Weight of the control vertices.
    #[arg(long, value_name = "W", conflicts_with = "hard", value_parser = positive)]
    pub(crate) weight: Option<f64>,
    /// Interpolate the control vertices exactly.
    #[arg(long)]
    pub(crate) hard: bool,
}

/// `msplines evaluate`.
#[derive(Debug, Args)]
pub(crate) struct Evaluate {
    /// Spline file that `msplines fit -o FILE.json` wrote.
    pub(crate) spline: PathBuf,
    /// The mesh that was fitted, where the spline file holds only its digest.
    #[arg(long, value_name = "INPUT")]
    pub(crate) mesh: Option<PathBuf>,
    /// Rounds of midpoint subdivision at whose vertices the spline is evaluated; of a sparse manifold,
    /// the number of times that the side of every face is halved.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=8))]
    pub(crate) subdivide: u32,
    /// Cut every span of a trivariate spline into so many by so many by so many cells; as in the fit
    /// where absent.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) tessellate: Option<u32>,
    /// Level of a T-spline: 0 is the coarsest surface on the way of its fit, and the last one, the surface
    /// itself, is taken where absent. Vertices are at the parameters that they have on the last.
    #[arg(long, value_name = "K")]
    pub(crate) level: Option<u32>,
    /// Write points and first derivatives of a trivariate spline at the parameters in this NumPy array
    /// or text file, rows of u v w, as .npy or .csv.
    #[arg(long, value_name = "FILE")]
    pub(crate) at: Option<PathBuf>,
    /// File to write, more than one by repeating: .ply, .vtu, .glb or .obj for the surface, .json
    /// for the spline; of a trivariate spline as of its fit.
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub(crate) outputs: Vec<PathBuf>,
}

/// `msplines edit`.
#[derive(Debug, Args)]
pub(crate) struct Edit {
    #[command(flatten)]
    pub(crate) evaluate: Evaluate,
    /// Place of the control points and by how much they move, in the units of the mesh; more than one
    /// by repeating.
    #[arg(long = "move", value_name = "X,Y,Z:DX,DY,DZ", value_parser = movement, required = true, allow_hyphen_values = true)]
    pub(crate) moves: Vec<[f64; 6]>,
    /// Distance from the place within which control points move, less and less towards it; the
    /// nearest one alone where absent.
    #[arg(long, value_name = "LENGTH", default_value = "0", value_parser = not_negative)]
    pub(crate) within: f64,
}

/// `msplines combine`.
#[derive(Debug, Args)]
pub(crate) struct Combine {
    #[command(flatten)]
    pub(crate) evaluate: Evaluate,
    /// Factor of the first spline.
    #[arg(
        long,
        value_name = "F",
        default_value_t = 1.0,
        allow_hyphen_values = true
    )]
    pub(crate) factor: f64,
    /// Another spline file and its factor; more than one by repeating.
    #[arg(long = "with", value_name = "SPLINE.json[:F]", required = true, value_parser = clap::builder::NonEmptyStringValueParser::new())]
    pub(crate) others: Vec<String>,
}

fn movement(text: &str) -> Result<[f64; 6], String> {
    let numbers: Result<Vec<f64>, _> = text.split([',', ':']).map(|n| n.trim().parse()).collect();
    match numbers.map(<[f64; 6]>::try_from) {
        Ok(Ok(six)) if six.iter().all(|x| x.is_finite()) => Ok(six),
        _ => Err("give six finite numbers: X,Y,Z:DX,DY,DZ".to_owned()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("give a length that is not negative".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("give a positive number".to_owned()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..1e9).contains(&value) => Ok(value),
        _ => Err("give a number of seconds".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::Arguments;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
