//! What can be said about Powell-Sabin splines.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use msplines_compare::case::Form;

/// `msplines fit powell-sabin`.
#[derive(Debug, Args)]
pub(crate) struct PowellSabin {
    /// Mesh file: OBJ, OFF, PLY or STL, of any genus, closed or with holes. Normals are those of the
    /// file, or estimated from the faces around each vertex where it has none.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .json for the spline; .ply, .obj or .glb for its
    /// points at the vertices of the input, or a tessellation with --tessellate; .vtu for exact Bezier
    /// triangles; .npy for the points alone.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// Weights of the membrane and of the thin plate in the energy that the surface minimises.
    #[arg(
        long,
        value_name = "MEMBRANE,THINPLATE",
        value_parser = fairness,
        default_value = "1,1",
        allow_hyphen_values = true
    )]
    pub(crate) fairness: [f64; 2],
    /// Lengths in which the thin plate is fair: those of the flat domain, as in the paper, or of the
    /// mesh.
    #[arg(long, value_enum, default_value_t = Weights::Geometric)]
    pub(crate) weights: Weights,
    /// What fills the holes at the zeros of the form.
    #[arg(long, value_enum, default_value_t = Fill::Smooth)]
    pub(crate) fill: Fill,
    /// The holomorphic form of a surface with handles, as for `conformal`.
    #[arg(
        long,
        value_name = "optimal|integer|periods:X,...|coefficients:X,...",
        allow_hyphen_values = true
    )]
    pub(crate) form: Option<Form>,
    /// Vertices, counted from 0, whose stars are removed first.
    #[arg(long, value_name = "V,...", value_delimiter = ',')]
    pub(crate) puncture: Vec<u32>,
    /// Triangles along each side of a face in files of the surface, with exact normals; its points at
    /// the vertices of the input where absent.
    #[arg(long, value_name = "N")]
    pub(crate) tessellate: Option<u32>,
    /// Also measure the two-sided distance between the input and the surface.
    #[arg(long)]
    pub(crate) distance: bool,
}

/// Lengths in which the thin plate is fair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Weights {
    /// Those of the flat domain.
    Parametric,
    /// Those of the mesh.
    Geometric,
}

/// What fills a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Fill {
    /// Nothing.
    Open,
    /// A minimal surface over its rim, as in the paper.
    Minimal,
    /// A spline in a chart around the zero, without a seam.
    Smooth,
}

/// `msplines reshape`.
#[derive(Debug, Args)]
pub(crate) struct Reshape {
    /// Spline file that `msplines fit powell-sabin -o FILE.json` wrote, of a torus or a surface with a
    /// boundary; or `msplines fit t-spline`, of any surface.
    pub(crate) spline: PathBuf,
    /// Insert a vertex in the middle of the face nearest to a place, and move the surface there; first
    /// of all, more than one by repeating.
    #[arg(long, value_name = "X,Y,Z:DX,DY,DZ", value_parser = numbers::<6>, allow_hyphen_values = true)]
    pub(crate) insert: Vec<[f64; 6]>,
    /// Give the vertex nearest to a place another normal; more than one by repeating.
    #[arg(long, value_name = "X,Y,Z:NX,NY,NZ", value_parser = numbers::<6>, allow_hyphen_values = true)]
    pub(crate) turn: Vec<[f64; 6]>,
    /// Scale the control triangle of the vertex nearest to a place; more than one by repeating.
    #[arg(long, value_name = "X,Y,Z:FACTOR", value_parser = numbers::<4>, allow_hyphen_values = true)]
    pub(crate) scale: Vec<[f64; 4]>,
    /// T-splines: move the control point of this number, counted from 0; more than one by repeating.
    #[arg(long, value_name = "INDEX:DX,DY,DZ", value_parser = numbered, allow_hyphen_values = true)]
    pub(crate) control: Vec<Numbered>,
    /// T-splines: move the control points around a place; more than one by repeating.
    #[arg(long = "move", value_name = "X,Y,Z:DX,DY,DZ", value_parser = numbers::<6>, allow_hyphen_values = true)]
    pub(crate) moves: Vec<[f64; 6]>,
    /// Distance from those places within which control points move, less and less towards it; the
    /// nearest one alone where absent.
    #[arg(long, value_name = "LENGTH", default_value = "0", value_parser = super::not_negative)]
    pub(crate) within: f64,
    /// T-splines: bring the surface at a vertex of the input, counted from 0, to a point by the least change
    /// of its control points; last of all, all vertices at once where repeated.
    #[arg(long, value_name = "VERTEX:X,Y,Z", value_parser = numbered, allow_hyphen_values = true)]
    pub(crate) pull: Vec<Numbered>,
    /// T-splines: list the control points after all changes, with their places on the cylinders and in space.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) list: Option<PathBuf>,
    /// Triangles along each side of a face in files of the surface, with exact normals.
    #[arg(long, value_name = "N")]
    pub(crate) tessellate: Option<u32>,
    /// File to write, as of the fit; more than one by repeating.
    #[arg(
        short,
        long = "output",
        value_name = "OUT",
        required_unless_present = "list"
    )]
    pub(crate) outputs: Vec<PathBuf>,
}

/// Their signs are for the fit to judge.
fn fairness(text: &str) -> Result<[f64; 2], String> {
    numbers::<2>(text).map_err(|_| "give two finite weights, such as 1,1".to_owned())
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split([',', ':']).map(|n| n.trim().parse()).collect();
    match numbers.map(<[f64; N]>::try_from) {
        Ok(Ok(all)) if all.iter().all(|x| x.is_finite()) => Ok(all),
        _ => Err(format!("give {N} finite numbers, a place first")),
    }
}

/// A number of something, and a vector or point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbered {
    pub(crate) index: u32,
    pub(crate) numbers: [f64; 3],
}

fn numbered(text: &str) -> Result<Numbered, String> {
    let refused = || "give a number counted from 0 and three finite ones: 7:0,0,0.1".to_owned();
    let (index, rest) = text.split_once(':').ok_or_else(refused)?;
    Ok(Numbered {
        index: index.trim().parse().map_err(|_| refused())?,
        numbers: numbers::<3>(rest).map_err(|_| refused())?,
    })
}
