//! Why curves bound no surface.

use nalgebra::Point3;

/// Why a network cannot become patches: where, and what to do. Points and curves count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// A curve ends where no other goes on.
    #[error(
        "curve {curve} ends at point {point} ({}), where no other curve passes; \
         join it to one there, or shorten it to its last junction",
        place(.position)
    )]
    Dangling {
        /// The curve.
        curve: usize,
        /// The point.
        point: u32,
        /// Where it is.
        position: Point3<f64>,
    },
    /// Two curves meet without sharing a point.
    #[error(
        "curves {} and {} meet at ({}) without a common point; give both a point of the \
         same index there, or move one away",
        .curves[0], .curves[1], place(.position)
    )]
    Touching {
        /// The curves.
        curves: [usize; 2],
        /// Where they meet.
        position: Point3<f64>,
    },
    /// Two curves run along the same segment.
    #[error(
        "curves {} and {} run over each other at ({}); keep one of them there",
        .curves[0], .curves[1], place(.position)
    )]
    Overlapping {
        /// The curves, or one twice.
        curves: [usize; 2],
        /// Where they do.
        position: Point3<f64>,
    },
    /// A closed curve meets no other, while others bound patches.
    #[error(
        "closed curve {curve} at ({}) meets no other curve, so that no patch can lead to it; \
         connect it with the rest, or take it out",
        place(.position)
    )]
    LooseLoop {
        /// The curve.
        curve: usize,
        /// A point of it.
        position: Point3<f64>,
    },
    /// Too many arcs end at a point.
    #[error(
        "{arcs} arcs meet at point {point} ({}), more than {most}; let some end before",
        place(.position)
    )]
    Crowded {
        /// The point.
        point: u32,
        /// Where it is.
        position: Point3<f64>,
        /// How many arcs end there.
        arcs: usize,
        /// How many may.
        most: usize,
    },
    /// The noise of restarts is no sensible number.
    #[error("a noise of {noise} makes no sense; give a number from 0 to 1")]
    Noise {
        /// The noise.
        noise: f64,
    },
    /// A cycle given by hand cannot be followed.
    #[error("given cycle {cycle} {problem}")]
    Given {
        /// The cycle.
        cycle: usize,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// An arc lies in no cycle given by hand, or in too many.
    #[error(
        "the arc of curve {curve} from ({}) to ({}) is in {uses} of the given cycles; \
         every arc bounds one or two",
        place(&.ends[0]), place(&.ends[1])
    )]
    GivenUses {
        /// The curve.
        curve: usize,
        /// The ends of the arc.
        ends: [Point3<f64>; 2],
        /// In how many cycles it is.
        uses: usize,
    },
    /// Cycles given by hand cannot be oriented alike.
    #[error(
        "given cycle {cycle} closes a one-sided surface (a Möbius band); take it out, or give others"
    )]
    OneSided {
        /// The cycle at which this shows.
        cycle: usize,
    },
    /// A `fill` or `hole` names no cycle, or several.
    #[error(
        "{count} cycles pass through all the points {points:?} given as `{list}`; \
         name points of exactly one"
    )]
    NotOneCycle {
        /// `fill` or `hole`.
        list: &'static str,
        /// The points.
        points: Vec<u32>,
        /// How many cycles pass through them.
        count: usize,
    },
    /// A cycle is named as a patch and as a hole.
    #[error("the cycle through points {points:?} is given as `fill` and as `hole`; take one away")]
    FilledHole {
        /// The points given for the hole.
        points: Vec<u32>,
    },
    /// A cycle passes a junction twice.
    #[error(
        "a cycle of {corners} arcs passes point {point} ({}) twice and bounds no disc; \
         give the cycles there by hand, or add a curve that splits it",
        place(.position)
    )]
    NoDisc {
        /// How many arcs the cycle has.
        corners: usize,
        /// The point.
        point: u32,
        /// Where it is.
        position: Point3<f64>,
    },
    /// The patches at a junction form more than one fan.
    #[error(
        "the patches at point {point} ({}) touch there only; fill one of the holes between them, \
         or give the cycles there by hand",
        place(.position)
    )]
    SeveralFans {
        /// The point.
        point: u32,
        /// Where it is.
        position: Point3<f64>,
    },
    /// No cycle is a patch.
    #[error("all {holes} cycles are holes, so that there is no surface; fill one of them")]
    NoPatch {
        /// How many cycles are holes.
        holes: usize,
    },
    /// The patches form no surface in another way, or too large a one.
    #[error("the patches form no surface: {0}; give the cycles by hand")]
    Topology(#[from] msplines_common::mesh::TopologyError),
    /// A vertex has more patches around it than a chart can hold.
    #[error(
        "the patches at ({}) make a chart of valence {valence}; one takes at most {most}: \
         let some curves end before",
        place(.position)
    )]
    Valence {
        /// Where the vertex is.
        position: Point3<f64>,
        /// Its valence; on the boundary twice its number of patches.
        valence: u32,
        /// How many a chart takes.
        most: u32,
    },
    /// A polynomial degree out of range.
    #[error("polynomials of degree {degree}; ask for 1 to 14, such as 5")]
    Degree {
        /// What was asked for.
        degree: u32,
    },
    /// Too few or too many nodes.
    #[error("{cells} cells along an edge; ask for 4 to 32, such as 8")]
    Cells {
        /// What was asked for.
        cells: u32,
    },
    /// A pursuit without atoms to choose from.
    #[error(
        "the pursuit may choose no atoms; ask for one at least, such as 25, and for `c0_atoms` \
         everywhere (`with`) if the dictionary has shape functions only"
    )]
    NoAtoms,
    /// A weight that means nothing.
    #[error("`{name}` is {value}; give a number above 0")]
    Weight {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The equations have no solution in floating-point numbers.
    #[error("the surface between the curves cannot be found: {0}")]
    Factor(#[from] msplines_common::linalg::FactorError),
    /// The equations are too many.
    #[error("the surface between the curves cannot be found: {0}")]
    Ordering(#[from] msplines_common::linalg::OrderingError),
    /// Coefficients are not finite.
    #[error("the curves lead to no finite surface: {0}")]
    Surface(#[from] crate::error::SplineError),
}

/// Returns a position as text, with enough digits to find it.
fn place(p: &Point3<f64>) -> String {
    format!("{:.6}, {:.6}, {:.6}", p.x, p.y, p.z)
}
