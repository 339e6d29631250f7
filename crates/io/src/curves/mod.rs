//! Readers of curve networks, and of the creases beside a control mesh.

mod creases;
mod draft;
mod obj;
mod svg;
mod text;

use std::path::Path;

use msplines_common::mesh::curves::CurveNetwork;

use crate::error::{Fault, Place};
use crate::read::bytes_of;
use crate::{Format, ReadError};

pub use creases::{Creases, parse_creases, read_creases};

/// Returns the curve network of a file: `.curves`, the lines of an OBJ, or the paths of an SVG.
///
/// The format is told by the extension. An SVG lies in the plane z = 0 with y upwards; its paths
/// become polylines that share points where their nodes coincide. Creases are flagged by the `k` rows
/// of `.curves`, and in the others by a group whose name (OBJ `g` or `o`, SVG `id` or `class`)
/// contains `crease`.
///
/// # Errors
/// The file cannot be read, is in no such format, breaks its rules, or holds no network.
pub fn read_curves(path: &Path) -> Result<CurveNetwork, ReadError> {
    parse_curves(path, &bytes_of(path)?)
}

/// Returns what [`read_curves`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_curves`].
pub fn parse_curves(path: &Path, bytes: &[u8]) -> Result<CurveNetwork, ReadError> {
    let path_of = || path.to_owned();
    if bytes.is_empty() {
        return Err(ReadError::Empty { path: path_of() });
    }
    let (format, draft) = match Format::detect(path, bytes) {
        Some(Format::Curves) => (Format::Curves, text::parse(bytes)),
        Some(Format::Obj) => (Format::Obj, obj::parse(bytes)),
        Some(Format::Svg) => (Format::Svg, svg::parse(bytes)),
        _ => return Err(ReadError::NotCurves { path: path_of() }),
    };
    let draft = draft.map_err(|fault| fault.in_file(path_of(), format))?;
    if draft.curves.is_empty() {
        return Err(ReadError::NoCurves {
            path: path_of(),
            format,
        });
    }
    draft
        .finish()
        .map_err(|fault| fault.in_file(path_of(), format))
}

/// Returns why such a file is no mesh.
pub(crate) fn no_mesh(format: Format) -> Fault {
    let (feature, remedy) = match format {
        Format::Creases => (
            "a list of creases as a mesh",
            "give the control mesh it belongs to",
        ),
        _ => (
            "a curve network as a mesh",
            "give an OBJ, OFF, PLY or STL file",
        ),
    };
    Fault::Unsupported {
        place: Place::Line(1),
        feature: feature.to_owned(),
        remedy,
    }
}
