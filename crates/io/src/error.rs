//! Why a file cannot be read, and where in it.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::Format;

/// Why a file cannot be read: the file, the place, what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}; check that the file exists and may be read", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The file has no bytes.
    #[error("{} is empty; export it again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Neither content nor extension tells a format.
    #[error(
        "{} is in no known format; give an OBJ, OFF, PLY or STL file, with that extension",
        path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file breaks the rules of its format.
    #[error("{} ({format}), {place}: {problem}; {remedy}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// Where.
        place: Place,
        /// What is wrong.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file ends before the data it announces.
    #[error(
        "{} ({format}), {place}: the file ends early: {problem}; \
         copy or export it again, or correct the counts in its header",
        path.display()
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// Where.
        place: Place,
        /// What was announced, and what is there.
        problem: String,
    },
    /// The file uses a part of its format that is not read.
    #[error("{} ({format}), {place}: {feature} is not supported; {remedy}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// Where.
        place: Place,
        /// The part.
        feature: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file holds no vertex.
    #[error("{} ({format}) holds no vertices; give a surface mesh", path.display())]
    NoVertices {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
    },
    /// The file holds vertices but no face.
    #[error(
        "{} ({format}) holds {vertices} vertices but no faces; give a surface mesh, or make one of the points first, such as by screened Poisson reconstruction in MeshLab, Open3D or CGAL",
        path.display()
    )]
    NoFaces {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// How many vertices it holds.
        vertices: usize,
    },
    /// The file is in no format of curve networks.
    #[error(
        "{} is in no format of curve networks; give a .curves, OBJ or SVG file, with that extension",
        path.display()
    )]
    NotCurves {
        /// The file.
        path: PathBuf,
    },
    /// The file holds no curve.
    #[error(
        "{} ({format}) holds no curves; give `c` rows in a .curves file, `l` lines in an OBJ file, \
         or paths in an SVG file",
        path.display()
    )]
    NoCurves {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
    },
    /// The file is in no format of solids.
    #[error(
        "{} is in no format of solids; give tetrahedra as .mesh, .msh, .vtk, .vtu or .node with \
         .ele, with that extension",
        path.display()
    )]
    NotSolid {
        /// The file.
        path: PathBuf,
    },
    /// The file holds no tetrahedron.
    #[error(
        "{} ({format}) holds {vertices} vertices but no tetrahedra; give a solid, or its surface \
         to have it meshed",
        path.display()
    )]
    NoCells {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// How many vertices it holds.
        vertices: usize,
    },
    /// There are more vertices or face corners than 32-bit ids can name.
    #[error(
        "{} ({format}) holds {vertices} vertices and {corners} face corners, more than 32-bit \
         ids can name; decimate it first",
        path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// How many vertices it holds.
        vertices: usize,
        /// How many face corners it holds.
        corners: usize,
    },
}

/// A place in a file. Lines count from 1, bytes and elements from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line of a text file.
    Line(u64),
    /// A byte of a binary file.
    Byte(u64),
    /// An element of a text file, such as vertex 7.
    ElementAtLine {
        /// What it is.
        element: String,
        /// Which one.
        index: u64,
        /// Its line.
        line: u64,
    },
    /// An element of a binary file.
    ElementAtByte {
        /// What it is.
        element: String,
        /// Which one.
        index: u64,
        /// The byte reached.
        byte: u64,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::ElementAtLine {
                element,
                index,
                line,
            } => {
                write!(f, "{element} {index} (line {line})")
            }
            Self::ElementAtByte {
                element,
                index,
                byte,
            } => {
                write!(f, "{element} {index} (byte {byte})")
            }
        }
    }
}

impl Place {
    /// Returns this place told as an element of the file.
    pub(crate) fn in_element(self, element: &str, index: u64) -> Self {
        let element = element.to_owned();
        match self {
            Self::Line(line) => Self::ElementAtLine {
                element,
                index,
                line,
            },
            Self::Byte(byte) => Self::ElementAtByte {
                element,
                index,
                byte,
            },
            named => named,
        }
    }
}

/// What a parser finds wrong; [`Fault::in_file`] adds which file it was.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    Malformed {
        place: Place,
        problem: String,
        remedy: &'static str,
    },
    Truncated {
        place: Place,
        problem: String,
    },
    Unsupported {
        place: Place,
        feature: String,
        remedy: &'static str,
    },
}

/// The advice for a file whose text or bytes are damaged.
pub(crate) const CORRECT_OR_EXPORT: &str = "correct it there or export the file again";

impl Fault {
    pub(crate) fn malformed(place: Place, problem: impl Into<String>) -> Self {
        Self::Malformed {
            place,
            problem: problem.into(),
            remedy: CORRECT_OR_EXPORT,
        }
    }

    pub(crate) fn truncated(place: Place, problem: impl Into<String>) -> Self {
        Self::Truncated {
            place,
            problem: problem.into(),
        }
    }

    pub(crate) fn in_element(mut self, element: &str, index: u64) -> Self {
        let (Self::Malformed { place, .. }
        | Self::Truncated { place, .. }
        | Self::Unsupported { place, .. }) = &mut self;
        *place = place.clone().in_element(element, index);
        self
    }

    pub(crate) fn in_file(self, path: PathBuf, format: Format) -> ReadError {
        match self {
            Self::Malformed {
                place,
                problem,
                remedy,
            } => ReadError::Malformed {
                path,
                format,
                place,
                problem,
                remedy,
            },
            Self::Truncated { place, problem } => ReadError::Truncated {
                path,
                format,
                place,
                problem,
            },
            Self::Unsupported {
                place,
                feature,
                remedy,
            } => ReadError::Unsupported {
                path,
                format,
                place,
                feature,
                remedy,
            },
        }
    }
}
