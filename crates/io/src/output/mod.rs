//! From a surface to a file.

mod atomic;
mod check;
mod wedges;

use std::io;
use std::path::{Path, PathBuf};

use msplines_common::mesh::VertexAttribute;
use nalgebra::{Point3, Vector3};

pub use atomic::write_atomically;
pub(crate) use check::check_positions;
pub(crate) use wedges::Wedges;

use crate::format::extension;
use crate::glb::Document;
use crate::{obj, ply, vtu};

/// A triangle surface to write. Attributes have one value per position.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surface<'a> {
    /// Vertex positions.
    pub positions: &'a [Point3<f64>],
    /// Corners of each triangle, zero-based.
    pub faces: &'a [[u32; 3]],
    /// Per-vertex data beyond the positions.
    pub attributes: &'a [VertexAttribute],
    /// A normal per position, of any length, such as the exact one of a spline. glb has them of length
    /// 1 in single precision, and without them the means over the faces around.
    pub normals: Option<&'a [Vector3<f64>]>,
    /// Texture coordinates of each corner of each face, one face after another: the first grows to
    /// the right of an image, the second upwards. PLY and glb have them in single precision; glb
    /// counts the second downwards and splits vertices where their corners differ. VTU has none.
    pub corner_texture: Option<&'a [[f64; 2]]>,
}

/// A format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OutputFormat {
    /// Binary PLY in double precision.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// VTK's XML file of an unstructured grid, in double precision.
    Vtu,
    /// Binary glTF 2.0, in single precision, as glTF has it.
    Glb,
}

impl OutputFormat {
    /// Returns the format that the extension of `path` asks for.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match extension(path)?.as_str() {
            "ply" => Some(Self::Ply),
            "obj" => Some(Self::Obj),
            "vtu" => Some(Self::Vtu),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }
}

/// Why a surface or an array cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The extension tells no format.
    #[error("{} asks for no known format; name it .ply, .obj, .vtu or .glb", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The extension tells no format of solids.
    #[error("{} asks for no known format of solids; name it .mesh, .msh or .vtu", path.display())]
    UnknownVolumeFormat {
        /// The file.
        path: PathBuf,
    },
    /// A format without Bézier cells.
    #[error("{} asks for a format that has no Bézier cells; name it .vtu", path.display())]
    BezierFormat {
        /// The file.
        path: PathBuf,
    },
    /// The extension is not that of STEP.
    #[error("{} asks for no STEP file; name it .step or .stp", path.display())]
    StepFormat {
        /// The file.
        path: PathBuf,
    },
    /// Control points that do not fill whole cells.
    #[error(
        "{points} control points do not fill cells of {per_cell}; give all points of every cell"
    )]
    BezierPoints {
        /// Number of control points of all cells.
        points: usize,
        /// Those of a cell.
        per_cell: usize,
    },
    /// Bézier cells of degree 0.
    #[error("a Bézier cell of degree 0 is one point and no cell of VTK; raise its degree to 1")]
    BezierDegree,
    /// A weight of a control point that is not a positive number.
    #[error("the weight of control point {point} is {weight}; weights are positive and finite")]
    BezierWeight {
        /// The control point.
        point: usize,
        /// Its weight.
        weight: f64,
    },
    /// A cell names a vertex that does not exist.
    #[error("cell {cell} names vertex {vertex}, but there are {vertices} vertices")]
    CellIndexOutOfRange {
        /// The cell.
        cell: usize,
        /// The index it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A field has not its number of components per vertex or cell.
    #[error(
        "field `{name}` has {values} values for {count} vertices or cells of {components} each; \
         give that many for each"
    )]
    FieldLength {
        /// The field.
        name: String,
        /// How many values it has.
        values: usize,
        /// How many each vertex or cell should have.
        components: usize,
        /// How many vertices or cells there are.
        count: usize,
    },
    /// The file cannot be written.
    #[error(
        "cannot write {}: {source}; check that its folder exists, may be written and has room",
        path.display()
    )]
    Io {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A position or attribute is NaN or infinite, or becomes so in the precision of the format.
    #[error("`{name}` of vertex {vertex} is not finite in this format; leave the vertex out")]
    NotFinite {
        /// `position`, or the name of the attribute.
        name: String,
        /// The vertex.
        vertex: usize,
    },
    /// An attribute has not one value per vertex.
    #[error("attribute `{name}` has {values} values for {vertices} vertices; give one for each")]
    AttributeLength {
        /// The attribute.
        name: String,
        /// How many values it has.
        values: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// An attribute has a name the formats cannot hold.
    #[error(
        "attribute `{name}` cannot be written; give each attribute one name of its own, \
         without white space and other than x, y and z, and beside normals than nx, ny, nz and Normals"
    )]
    AttributeName {
        /// The name.
        name: String,
    },
    /// Texture coordinates are not one pair per corner.
    #[error("{values} pairs of texture coordinates for {corners} corners; give one for each")]
    TextureLength {
        /// How many pairs there are.
        values: usize,
        /// How many corners the faces have.
        corners: usize,
    },
    /// A texture coordinate is not finite in single precision.
    #[error(
        "the texture coordinates of corner {corner} of face {face} are not finite; leave it out"
    )]
    TextureNotFinite {
        /// The face.
        face: usize,
        /// Its corner, 0 to 2.
        corner: usize,
    },
    /// An array has no or too many dimensions, or not the values that its shape says.
    #[error(
        "an array of shape {shape:?} with {values} values cannot be written; give one to three \
         dimensions whose product is the number of values"
    )]
    ArrayShape {
        /// The shape.
        shape: Vec<usize>,
        /// How many values there are.
        values: usize,
    },
    /// The file would be larger than its format can say.
    #[error("a glb file of {bytes} bytes is beyond its limit of 4 GiB; write .vtu or .ply")]
    TooLarge {
        /// The size it would have.
        bytes: usize,
    },
    /// The description of the data cannot be turned into text.
    #[error("the glTF description cannot be written: {0}; write .vtu or .ply")]
    Json(String),
}

/// Writes a surface in the format that the extension of `path` asks for.
///
/// The file is written beside `path` and renamed; on an error nothing is left behind. The same
/// surface gives the same bytes.
///
/// # Errors
/// The extension is unknown, the file cannot be written, or the surface is not fit to be: an index
/// out of range, a number that is not finite, normals, texture coordinates or an attribute of another
/// length, an attribute without a name of its own, more than the format can hold.
pub fn write_surface(path: &Path, surface: &Surface<'_>) -> Result<(), WriteError> {
    let Some(format) = OutputFormat::of(path) else {
        return Err(WriteError::UnknownFormat {
            path: path.to_owned(),
        });
    };
    check::check(surface)?;
    match format {
        OutputFormat::Ply => write_atomically(path, |to| ply::write(surface, to)),
        OutputFormat::Obj => write_atomically(path, |to| obj::write(surface, to)),
        OutputFormat::Vtu => write_atomically(path, |to| vtu::write(surface, to)),
        OutputFormat::Glb => {
            let document = Document::build(surface)?;
            write_atomically(path, |to| document.write(to))
        }
    }
}
