//! Normals of a mesh: those of its file, or estimated ones.

use msplines_common::Vector3;
use msplines_common::mesh;
use msplines_powell_sabin::estimate_normals;

use super::LoadedInput;
use crate::error::RunError;

/// A unit normal for every vertex of a mesh, and what is to be said about them.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexNormals {
    /// The normals.
    pub normals: Vec<Vector3<f64>>,
    /// Which of them are not those of the file, or point the other way.
    pub warnings: Vec<String>,
}

/// Returns the normals that came with the file of an input; where it has none, those estimated from the
/// faces around, with a warning that says so. O(n).
///
/// # Errors
/// A vertex whose faces have no area, or cancel, and to which the file gives no direction.
pub fn vertex_normals(input: &LoadedInput) -> Result<VertexNormals, RunError> {
    let refused = |reason: String| RunError::Input {
        file: input.facts.file.clone(),
        reason,
    };
    let given = mesh::vertex_normals(&input.attributes);
    let given = given.filter(|normals| normals.len() == input.mesh.vertex_count());
    let Some(mut normals) = given else {
        let normals = estimate_normals(&input.mesh).map_err(|e| refused(e.to_string()))?;
        let warning =
            "the file has no normals; they are estimated from the faces around each vertex";
        return Ok(VertexNormals {
            normals,
            warnings: vec![warning.to_owned()],
        });
    };
    let mut warnings = Vec::new();
    // The faces around tell what is missing, and which side is outside.
    let missing = normals
        .iter()
        .filter(|normal| **normal == Vector3::zeros())
        .count();
    let estimated = match estimate_normals(&input.mesh) {
        Ok(estimated) => estimated,
        Err(_) if missing == 0 => return Ok(VertexNormals { normals, warnings }),
        Err(error) => return Err(refused(error.to_string())),
    };
    let mut opposed = 0;
    for (normal, estimate) in normals.iter_mut().zip(&estimated) {
        if *normal == Vector3::zeros() {
            *normal = *estimate;
        }
        opposed += usize::from(normal.dot(estimate) < 0.0);
    }
    let count = normals.len();
    if missing > 0 {
        warnings.push(format!(
            "the file gives {missing} of {count} vertices no normal; theirs are estimated from the faces around"
        ));
    }
    if opposed > 0 {
        warnings.push(format!(
            "{opposed} of {count} normals of the file point against the faces around them; leave them out of the file to have them estimated"
        ));
    }
    Ok(VertexNormals { normals, warnings })
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use msplines_common::mesh::VertexAttribute;

    use super::*;
    use crate::case::Input;
    use crate::clock::PhaseClock;
    use crate::generated::GeneratedSurface;
    use crate::input::load;

    /// Returns a unit sphere with these multiples of its normals as attributes.
    fn sphere(factor: impl Fn(usize) -> f64) -> LoadedInput {
        let surface = Input::Surface(GeneratedSurface::Sphere);
        let mut input = load(&surface, &mut PhaseClock::start(Instant::now())).expect("a sphere");
        let attribute = |axis: usize, name: &str| VertexAttribute {
            name: name.to_owned(),
            values: input
                .mesh
                .positions()
                .iter()
                .enumerate()
                .map(|(v, p)| factor(v) * p[axis])
                .collect(),
        };
        input.attributes = [attribute(0, "nx"), attribute(1, "ny"), attribute(2, "nz")].into();
        input
    }

    /// The faces of a sphere of 5,000 vertices tell its normals to about the square of a face.
    const FACE: f64 = 1e-2;

    #[test]
    fn normals_of_the_file_are_taken_as_they_are() {
        let input = sphere(|_| 3.0);
        let found = vertex_normals(&input).expect("normals");
        assert!(found.warnings.is_empty());
        for (normal, position) in found.normals.iter().zip(input.mesh.positions()) {
            assert!((normal - position.coords).norm() < 1e-12);
        }
    }

    #[test]
    fn what_is_missing_is_estimated_and_said() {
        let mut input = sphere(|v| if v < 7 { 0.0 } else { 1.0 });
        let found = vertex_normals(&input).expect("normals");
        assert!(
            found.warnings.len() == 1 && found.warnings[0].contains("gives 7 of"),
            "{:?}",
            found.warnings
        );
        let near = |found: &VertexNormals, input: &LoadedInput| {
            let pairs = found.normals.iter().zip(input.mesh.positions());
            pairs
                .map(|(n, p)| (n - p.coords).norm())
                .fold(0.0, f64::max)
        };
        assert!(near(&found, &input) < FACE);
        input.attributes.clear();
        let found = vertex_normals(&input).expect("normals");
        assert!(
            found.warnings[0].contains("no normals"),
            "{:?}",
            found.warnings
        );
        assert!(near(&found, &input) < FACE);
    }

    #[test]
    fn normals_that_point_inwards_are_told() {
        let found = vertex_normals(&sphere(|v| if v < 5 { -1.0 } else { 1.0 })).expect("normals");
        assert!(
            found.warnings[0].starts_with("5 of"),
            "{:?}",
            found.warnings
        );
    }
}
