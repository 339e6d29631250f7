//! Texture coordinates of an atlas.

use msplines_common::mesh::TriangleMesh;
use msplines_conformal::Atlas;
use msplines_conformal::measure::{Stretch, area, flat_stretches};

/// Squares of a checkerboard along a unit of texture, as images for this purpose have them.
pub(crate) const CHECKERS: f64 = 8.0;
/// Squares along the diagonal of the surface, where the atlas has its median scale.
const ALONG_DIAGONAL: f64 = 40.0;

/// Returns what the atlas does to every face that is not at a zero, with the area of the face. O(n).
pub(super) fn stretches(atlas: &Atlas) -> Vec<(Stretch, f64)> {
    let lengths = lengths(atlas.mesh());
    let mut outside = vec![true; lengths.len()];
    for &face in atlas.zeros().iter().flat_map(|zero| &zero.faces) {
        outside[face as usize] = false;
    }
    let found = flat_stretches(&lengths, atlas.form());
    let all = found.into_iter().zip(lengths).zip(outside);
    all.filter(|(_, outside)| *outside)
        .map(|((stretch, sides), _)| (stretch, area(sides)))
        .collect()
}

/// Returns the texture coordinates of the corners of every face: the atlas, so large that an image of
/// 8 by 8 squares, repeated, shows 40 along the diagonal where lengths have the median of the atlas.
///
/// The median, as the mean follows the few faces that a stereographic image blows up. O(n log n).
pub(super) fn texture(atlas: &Atlas, stretches: &[(Stretch, f64)]) -> Vec<[[f64; 2]; 3]> {
    let unit = atlas.mesh().diagonal() * median_scale(stretches) * CHECKERS / ALONG_DIAGONAL;
    let mut corners = atlas.corners();
    for number in corners.as_flattened_mut().as_flattened_mut() {
        *number /= unit;
    }
    corners
}

/// The median over the surface of lengths in the plane over lengths on the surface.
fn median_scale(stretches: &[(Stretch, f64)]) -> f64 {
    let scales = stretches
        .iter()
        .map(|(stretch, area)| (stretch.scale, *area));
    let mut weighted: Vec<(f64, f64)> = scales.filter(|(scale, _)| scale.is_normal()).collect();
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = weighted.iter().map(|(_, area)| area).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let median = weighted.iter().find(|(_, area)| {
        sum += area;
        sum >= half
    });
    median.map_or(1.0, |found| found.0)
}

fn lengths(mesh: &TriangleMesh) -> Vec<[f64; 3]> {
    let at = |v: u32| mesh.positions()[v as usize];
    let sides =
        |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| (at(b) - at(a)).norm());
    mesh.faces().iter().map(sides).collect()
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;
    use msplines_conformal::AtlasOptions;

    use super::*;

    #[test]
    fn half_of_the_surface_has_squares_of_a_fortieth_of_the_diagonal() {
        for mesh in [shapes::torus(1.0, 0.4, 900), shapes::sphere(900)] {
            let found = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved())
                .expect("an atlas");
            let mesh = found.atlas.mesh();
            let texture = texture(&found.atlas, &stretches(&found.atlas));
            // Squares along the diagonal, by the areas of face and image.
            let mut areas: Vec<(f64, f64)> = Vec::new();
            for (face, [a, b, c]) in texture.iter().enumerate() {
                let flat = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                let area = mesh.face_normal(face as u32).norm();
                areas.push((
                    CHECKERS * mesh.diagonal() * (flat.max(0.0) / area).sqrt(),
                    area,
                ));
            }
            areas.sort_by(|a, b| a.0.total_cmp(&b.0));
            let share = |squares: f64| {
                let below = areas.iter().filter(|(own, _)| *own < squares);
                below.map(|(_, area)| area).sum::<f64>() / areas.iter().map(|(_, a)| a).sum::<f64>()
            };
            // Faces at the pole and of the same size as the median are a few per cent.
            assert!(share(0.9 * ALONG_DIAGONAL) < 0.55 && share(1.1 * ALONG_DIAGONAL) > 0.45);
        }
    }
}
