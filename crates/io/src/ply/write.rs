//! From a surface to a binary PLY file in double precision.

use std::io::{self, Write};

use crate::output::Surface;

/// Writes a surface: positions and normals as doubles, attributes as further properties.
///
/// The colours `red`, `green`, `blue`, `alpha` become bytes where that loses nothing, since that is
/// what viewers look for. Texture coordinates are a list `texcoord` of each face as in MeshLab, which
/// takes it in single precision only.
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
    if surface.normals.is_some() {
        writeln!(
            to,
            "property double nx\nproperty double ny\nproperty double nz"
        )?;
    }
    for (attribute, &byte) in surface.attributes.iter().zip(&bytes) {
        let kind = if byte { "uchar" } else { "double" };
        writeln!(to, "property {kind} {}", attribute.name)?;
    }
    writeln!(to, "element face {}", surface.faces.len())?;
    writeln!(to, "property list uchar uint vertex_indices")?;
    if surface.corner_texture.is_some() {
        writeln!(to, "property list uchar float texcoord")?;
    }
    writeln!(to, "end_header")?;
    for (vertex, position) in surface.positions.iter().enumerate() {
        let normal = surface.normals.map(|normals| &normals[vertex]);
        let normal = normal.into_iter().flat_map(|normal| normal.iter());
        for coordinate in position.iter().chain(normal) {
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
    for (index, face) in surface.faces.iter().enumerate() {
        to.write_all(&[3])?;
        for vertex in face {
            to.write_all(&vertex.to_le_bytes())?;
        }
        if let Some(texture) = surface.corner_texture {
            to.write_all(&[6])?;
            for &coordinate in texture[3 * index..3 * index + 3].as_flattened() {
                to.write_all(&(coordinate as f32).to_le_bytes())?;
            }
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
