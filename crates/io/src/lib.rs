//! Readers and writers of surface meshes, of solids, of curve networks and of arrays.
//!
//! [`read_soup`] takes OBJ, OFF, PLY and STL files and returns what they say, in file order, with
//! nothing about the mesh checked: an index may lie outside, a coordinate may be NaN. Whether the
//! soup is a mesh is for `msplines_common::mesh` to tell. What no soup can hold is a [`ReadError`]
//! that names the file, the place, the fault and what to do. Memory is bounded by the size of the
//! file, whatever its header claims.
//!
//! [`write_surface`] writes PLY, OBJ, VTU and glb. Every file is written beside its target and
//! renamed, so that a target is whole or absent, and the same surface gives the same bytes.
//! [`write_cells`] writes Bézier cells of any shape and degree as they are, [`write_step`] patches with
//! the edges that they share.
//!
//! [`read_tets`] takes tetrahedra from Medit, Gmsh, VTK and TetGen files, and [`write_volume`] writes
//! tetrahedra and hexahedra.
//!
//! [`read_curves`] takes curve networks from `.curves`, OBJ and SVG files, and [`read_creases`] the
//! creases beside a control mesh.
//!
//! [`read_npy`] and [`write_npy`] take arrays of numbers from and to NumPy, under the same rules.
//!
//! | format | read | write | coordinates written | data written |
//! |---|---|---|---|---|
//! | PLY | text, both binary orders, strips; normals | binary, little-endian | double | all attributes, normals; texture of corners in single |
//! | OBJ | polygons, vertex colours, normals; lines as curves | text | double | normals, texture of corners |
//! | OFF | text, also with normals and colours | | | |
//! | STL | text, binary | | | |
//! | VTU | tetrahedra: text, base64, appended, zlib | XML with base64 data; Bézier cells | double | all attributes, normals; weights |
//! | VTK | tetrahedra: text, binary | | | |
//! | Medit | tetrahedra: text | text | double | none |
//! | STEP | | AP214, text; Bézier patches as solids or shells | double | weights |
//! | Gmsh | tetrahedra: 2.2 and 4.1, text, binary | 4.1, text | double | all attributes |
//! | TetGen | tetrahedra: `.node` with `.ele` | | | |
//! | glb | | glTF 2.0 | single | colours, normals, texture of corners |
//! | curves | text | | | |
//! | SVG | paths, lines, polylines, polygons | | | |
//! | creases | text | | | |
//! | npy | floating-point and whole numbers, both byte orders | binary | double | |
//!
//! Normals that are read become the attributes `nx`, `ny`, `nz`, whatever the format;
//! `msplines_common::mesh::vertex_normals` makes vectors of them.

mod bezier;
mod curves;
mod digest;
mod error;
mod format;
mod glb;
mod npy;
mod obj;
mod off;
mod output;
mod ply;
mod read;
mod step;
mod stl;
mod text;
mod volume;
mod vtu;

pub use bezier::write_cells;
pub use curves::{Creases, parse_creases, parse_curves, read_creases, read_curves};
pub use digest::sha256_file;
pub use error::{Place, ReadError};
pub use format::Format;
pub use npy::{Array, parse_npy, read_npy, write_npy};
pub use output::{OutputFormat, Surface, WriteError, write_atomically, write_surface};
pub use read::{parse_points, parse_soup, read_points, read_soup};
pub use step::write_step;
pub use volume::{Field, Volume, VolumeCells, parse_tetgen, parse_tets, read_tets, write_volume};
