//! What cannot be written, told before anything is.

use nalgebra::Point3;

use super::{Surface, WriteError};

/// Refuses positions that are not finite.
pub(crate) fn check_positions(positions: &[Point3<f64>]) -> Result<(), WriteError> {
    let infinite = |p: &Point3<f64>| p.iter().any(|x| !x.is_finite());
    match positions.iter().position(infinite) {
        Some(vertex) => Err(WriteError::NotFinite {
            name: "position".to_owned(),
            vertex,
        }),
        None => Ok(()),
    }
}

/// Refuses a surface that is not fit to be written.
pub(super) fn check(surface: &Surface<'_>) -> Result<(), WriteError> {
    let vertices = surface.positions.len();
    for (face, corners) in surface.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(WriteError::IndexOutOfRange {
                face,
                vertex,
                vertices,
            });
        }
    }
    check_positions(surface.positions)?;
    check_normals(surface)?;
    check_texture(surface)?;
    check_attributes(surface)
}

fn check_normals(surface: &Surface<'_>) -> Result<(), WriteError> {
    let Some(normals) = surface.normals else {
        return Ok(());
    };
    let name = || "normal".to_owned();
    if normals.len() != surface.positions.len() {
        return Err(WriteError::AttributeLength {
            name: name(),
            values: normals.len(),
            vertices: surface.positions.len(),
        });
    }
    match normals
        .iter()
        .position(|n| n.iter().any(|x| !x.is_finite()))
    {
        Some(vertex) => Err(WriteError::NotFinite {
            name: name(),
            vertex,
        }),
        None => Ok(()),
    }
}

fn check_texture(surface: &Surface<'_>) -> Result<(), WriteError> {
    let Some(texture) = surface.corner_texture else {
        return Ok(());
    };
    let corners = 3 * surface.faces.len();
    if texture.len() != corners {
        let values = texture.len();
        return Err(WriteError::TextureLength { values, corners });
    }
    let infinite = |at: &[f64; 2]| at.iter().any(|&x| !(x as f32).is_finite());
    match texture.iter().position(infinite) {
        Some(place) => Err(WriteError::TextureNotFinite {
            face: place / 3,
            corner: place % 3,
        }),
        None => Ok(()),
    }
}

fn check_attributes(surface: &Surface<'_>) -> Result<(), WriteError> {
    let vertices = surface.positions.len();
    for (i, attribute) in surface.attributes.iter().enumerate() {
        let name = &attribute.name;
        let taken = surface.attributes[..i]
            .iter()
            .any(|other| other.name == *name);
        let reserved = match name.as_str() {
            "" | "x" | "y" | "z" => true,
            "nx" | "ny" | "nz" | "Normals" => surface.normals.is_some(),
            _ => false,
        };
        if taken || reserved || name.chars().any(|c| c.is_whitespace() || c.is_control()) {
            return Err(WriteError::AttributeName { name: name.clone() });
        }
        let values = attribute.values.len();
        if values != vertices {
            return Err(WriteError::AttributeLength {
                name: name.clone(),
                values,
                vertices,
            });
        }
        if let Some(vertex) = attribute.values.iter().position(|value| !value.is_finite()) {
            return Err(WriteError::NotFinite {
                name: name.clone(),
                vertex,
            });
        }
    }
    Ok(())
}
