//! Why there is no mesh of a solid.

/// Why a surface was not filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MesherError {
    /// The surface has a boundary.
    #[error(
        "the surface is open: it has {loops} boundary loops, the first through vertex {vertex}; close its holes"
    )]
    Open {
        /// Number of boundary loops.
        loops: usize,
        /// A vertex of the first.
        vertex: u32,
    },
    /// The surface is in several pieces.
    #[error("the surface is {pieces} pieces, the second has vertex {vertex}; give one surface")]
    SeveralSurfaces {
        /// Number of pieces.
        pieces: u32,
        /// A vertex of the second.
        vertex: u32,
    },
    /// The surface has handles.
    #[error("the surface has genus {genus}, not 0; give one without tunnels or handles")]
    Genus {
        /// Number of handles.
        genus: u32,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite; repair the surface first")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// The surface encloses nothing.
    #[error("the surface encloses no volume; give a closed surface with an inside")]
    NoVolume,
    /// The surface passes through itself.
    #[error(
        "the surface passes through itself at {count} pairs of faces, the first are {} and {}; mend it, or have its parts united with --repair",
        .faces[0], .faces[1]
    )]
    Crossing {
        /// Number of pairs.
        count: usize,
        /// The first pair.
        faces: [u32; 2],
    },
    /// The lattice would not fit into memory.
    #[error(
        "a lattice of spacing {spacing:e} has {points:.1e} points, more than {most:.1e}; choose a larger spacing"
    )]
    TooFine {
        /// Distance of lattice points.
        spacing: f64,
        /// How many there would be.
        points: f64,
        /// How many there may be.
        most: f64,
    },
    /// An option that means nothing.
    #[error("`{name}` is {value:?}; give a number {range}")]
    Number {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// No lattice was fine enough.
    #[error(
        "{attempts} lattices were tried, down to a spacing of {spacing:?}; in the last one {shortfall}"
    )]
    NoLattice {
        /// Number of lattices tried.
        attempts: usize,
        /// Spacing of the last.
        spacing: f64,
        /// What was wrong with it.
        shortfall: Shortfall,
    },
    /// The observer asked to stop before there was a mesh.
    #[error("stopped before there was a mesh; allow more time")]
    Stopped,
}

/// What is wrong with the mesh from one lattice.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Shortfall {
    /// No lattice point is inside, or all that are lie next to the surface.
    #[error("no lattice point is well inside; choose a smaller spacing")]
    Empty,
    /// A part of the surface is far from the boundary.
    #[error(
        "a thin part is lost at ({}, {}, {}), by vertex {vertex}: {distance} away; choose a smaller spacing, or thicken the part",
        .position[0], .position[1], .position[2]
    )]
    PartLost {
        /// The vertex nearest to the point that is farthest away.
        vertex: u32,
        /// The point.
        position: [f64; 3],
        /// Its distance to the boundary.
        distance: f64,
    },
    /// The boundary has another topology than the surface.
    #[error(
        "the boundary has Euler characteristic {found} instead of {expected}: parts of the surface are closer together than the spacing, near ({}, {}, {}); choose a smaller spacing",
        .position[0], .position[1], .position[2]
    )]
    Topology {
        /// Euler characteristic of the boundary.
        found: i64,
        /// That of the surface.
        expected: i64,
        /// The point of the surface farthest from the boundary: likely, but not surely, the place.
        position: [f64; 3],
    },
    /// The solid is in several parts.
    #[error("the solid is in {parts} parts, one at ({}, {}, {}); choose a smaller spacing, or keep the largest part", .position[0], .position[1], .position[2])]
    SeveralParts {
        /// Number of parts.
        parts: u32,
        /// A vertex of the smallest part.
        position: [f64; 3],
    },
    /// Sheets of the boundary still touch.
    #[error("sheets of the boundary touch at ({}, {}, {}); choose a smaller spacing", .position[0], .position[1], .position[2])]
    Contact {
        /// Where.
        position: [f64; 3],
    },
}
