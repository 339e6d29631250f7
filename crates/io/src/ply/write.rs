//! From a surface to a binary PLY file in double precision.

use std::io::{self, Write};

use crate::output::Surface;

/// Writes a surface: positions as doubles, attributes as further properties.
///
/// The colours `red`, `green`, `blue`, `alpha` become bytes where that loses nothing, since that is
/// what viewers look for.
pub(crate) fn write(surface: &Surface<'_>, to: &mut dyn Write) -> io::Result<()> {
    let bytes: Vec<bool> = surface
        .attributes
        .iter()
        .map(|a| is_colour(&a.name) && a.values.iter().all(|&value| fits_byte(value)))
        .collect();
    writeln!(to, "ply\nformat binary_little_endian 1.0")?;
    writeln!(to, "element vertex {}", surface.positions.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(to, "property double {axis}")?;
    }
    for (attribute, &byte) in surface.attributes.iter().zip(&bytes) {
        let kind = if byte { "uchar" } else { "double" };
        writeln!(to, "property {kind} {}", attribute.name)?;
    }
    writeln!(to, "element face {}", surface.faces.len())?;
    writeln!(to, "property list uchar uint vertex_indices\nend_header")?;
    for (vertex, position) in surface.positions.iter().enumerate() {
        for coordinate in position.iter() {
            to.write_all(&coordinate.to_le_bytes())?;
        }
        for (attribute, &byte) in surface.attributes.iter().zip(&bytes) {
            let value = attribute.values[vertex];
            if byte {
                to.write_all(&[value as u8])?;
            } else {
                to.write_all(&value.to_le_bytes())?;
            }
        }
    }
    for face in surface.faces {
        to.write_all(&[3])?;
        for vertex in face {
            to.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}

fn is_colour(name: &str) -> bool {
    matches!(name, "red" | "green" | "blue" | "alpha")
}

fn fits_byte(value: f64) -> bool {
    f64::from(value as u8).to_bits() == value.to_bits()
}
