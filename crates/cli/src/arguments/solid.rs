//! What can be said about trivariate splines.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// `msplines fit trivariate`.
#[derive(Debug, Args)]
pub(crate) struct Trivariate {
    /// Closed surface (OBJ, OFF, PLY or STL), or tetrahedra: .mesh, .msh, .vtk, .vtu, or .node with
    /// .ele.
    pub(crate) input: PathBuf,
    /// File to write, more than one by repeating: .json for the spline; .vtu for exact Bézier cells,
    /// .xml for G+Smo; .msh, .mesh or .hex.vtu for hexahedra; .ply, .obj or .glb for the boundary.
    #[arg(short, long = "output", value_name = "OUT")]
    pub(crate) outputs: Vec<PathBuf>,
    /// Vertices that become the corners of the cube, counted from 0: the coordinates of corner c are
    /// the bits of c, the first the lowest. Found where absent.
    #[arg(long, value_name = "A,...,H", value_parser = corners)]
    pub(crate) corners: Option<[u32; 8]>,
    /// What the solid is mapped to.
    #[arg(long, value_enum, default_value_t = Map::Cube)]
    pub(crate) map: Map,
    /// How the spline is fitted to samples of the solid; certified where absent.
    #[arg(long, value_enum)]
    pub(crate) fit: Option<SolidFit>,
    /// Spans of the spline in each direction; the first level has as few as doubling allows.
    #[arg(long, value_name = "N", conflicts_with = "levels", value_parser = clap::value_parser!(u32).range(1..=512))]
    pub(crate) spans: Option<u32>,
    /// Spans of the first and the last level, the last a power of two times the first.
    #[arg(long, value_name = "FIRST..LAST", value_parser = levels)]
    pub(crate) levels: Option<Levels>,
    /// Root mean square of the distances, in the units of the solid, at which multilevel B-splines end.
    #[arg(long, value_name = "RMS", value_parser = super::not_negative)]
    pub(crate) stop: Option<f64>,
    /// Points inside of the solid and on its surface that are fitted.
    #[arg(long, value_name = "INSIDE,SURFACE", value_parser = samples, conflicts_with = "paper")]
    pub(crate) samples: Option<[usize; 2]>,
    /// Cells in each direction of the samplings by which the spline is judged as finite elements.
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        default_values_t = [20, 30, 47],
        value_parser = clap::value_parser!(u32).range(1..=200)
    )]
    pub(crate) validate_at: Vec<u32>,
    /// About how many tetrahedra a surface is filled with, 60,000 where absent; where that is too coarse for
    /// its parts, more are taken.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=50_000_000))]
    pub(crate) cells: Option<u32>,
    /// The same by the number of lattice edges along the diagonal of the solid's box.
    #[arg(long, value_name = "N", value_parser = super::positive, conflicts_with = "cells")]
    pub(crate) spacing: Option<f64>,
    /// The settings of the paper: a harmonic map whose folds are counted, and multilevel B-splines of
    /// its vertices.
    #[arg(long)]
    pub(crate) paper: bool,
    /// Fill a surface with tetrahedra by the program `tetgen`.
    #[arg(long)]
    pub(crate) tetgen: bool,
    /// Cut every span into so many by so many by so many cells.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) tessellate: u32,
    /// Measure the two-sided distance between the surfaces as well; takes a few seconds.
    #[arg(long)]
    pub(crate) distance: bool,
}

/// What a solid is mapped to.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Map {
    /// The unit cube.
    Cube,
    /// A cylinder around an axis, the baseline of comparisons: its axis is degenerate.
    Cylinder,
}

/// How a spline is fitted to samples of a solid.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum SolidFit {
    /// By least squares, proved not to fold.
    Certified,
    /// By least squares alone.
    LeastSquares,
    /// By multilevel B-splines.
    Multilevel,
}

/// Spans of the first and the last level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Levels {
    pub(crate) first: usize,
    pub(crate) last: usize,
}

/// `msplines deform`.
#[derive(Debug, Args)]
pub(crate) struct Deform {
    /// Spline file that `msplines fit trivariate -o FILE.json` wrote.
    pub(crate) spline: PathBuf,
    /// Place of a control point in the lattice, counted from 0, and its new position; more than one by
    /// repeating.
    #[arg(long = "move", value_name = "I,J,K=X,Y,Z", value_parser = relocation, required = true, allow_hyphen_values = true)]
    pub(crate) moves: Vec<Relocation>,
    /// Cut every span into so many by so many by so many cells; as in the fit where absent.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) tessellate: Option<u32>,
    /// File to write, more than one by repeating, as of `fit trivariate`.
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub(crate) outputs: Vec<PathBuf>,
}

/// A control point and where it goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relocation {
    pub(crate) index: [usize; 3],
    pub(crate) to: [f64; 3],
}

fn corners(text: &str) -> Result<[u32; 8], String> {
    let vertices: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let eight = vertices.ok().and_then(|list| list.try_into().ok());
    eight.ok_or_else(|| {
        "give the numbers of eight vertices, such as 3,7,12,9,20,21,22,23".to_owned()
    })
}

fn samples(text: &str) -> Result<[usize; 2], String> {
    let counts: Result<Vec<usize>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let two = counts.ok().and_then(|list| list.try_into().ok());
    two.ok_or_else(|| "give two numbers of points, such as 150000,60000".to_owned())
}

fn levels(text: &str) -> Result<Levels, String> {
    let ends = text.split_once("..");
    let ends = ends.and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    match ends {
        Some((first, last)) => Ok(Levels { first, last }),
        None => Err("give the spans of the first and the last level, such as 2..64".to_owned()),
    }
}

fn relocation(text: &str) -> Result<Relocation, String> {
    let sides = text.split_once('=').and_then(|(index, to)| {
        let index: Option<Vec<usize>> = index.split(',').map(|n| n.trim().parse().ok()).collect();
        let to: Option<Vec<f64>> = to.split(',').map(|n| n.trim().parse().ok()).collect();
        Some((index?.try_into().ok()?, to?.try_into().ok()?))
    });
    let relocation = sides.map(|(index, to): ([usize; 3], [f64; 3])| Relocation { index, to });
    relocation.ok_or_else(|| {
        "give the place of a control point and its new position: I,J,K=X,Y,Z".to_owned()
    })
}
