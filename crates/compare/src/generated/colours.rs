//! Colours made from formulas on positions.

use std::f64::consts::TAU;

use msplines_common::Vector3;
use msplines_common::mesh::TriangleMesh;

/// Regions of the colour image.
const REGIONS: usize = 24;
/// Their colours, in turns.
const PALETTE: [[f64; 3]; 7] = [
    [0.78, 0.30, 0.24],
    [0.27, 0.38, 0.66],
    [0.85, 0.66, 0.32],
    [0.45, 0.55, 0.28],
    [0.88, 0.80, 0.68],
    [0.50, 0.32, 0.52],
    [0.20, 0.52, 0.52],
];
/// Steps of the additive recurrence of lowest discrepancy in three dimensions: powers of the inverse
/// of the root of x⁴ = x + 1.
const SPREAD: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];

/// Returns a colour of every vertex that is as hard everywhere, `[vertex][red, green, blue]` in
/// [0, 1].
///
/// A sinusoidal gradient in each channel, ripples of a twelfth of the size, and rings at equal
/// distances where the colour jumps: no part of the surface needs more knots than another.
#[must_use]
pub fn colour_pattern(mesh: &TriangleMesh) -> Vec<f64> {
    let [low, high] = mesh.bounding_box();
    let size = (high - low).max().max(f64::MIN_POSITIVE);
    let mut values = Vec::with_capacity(3 * mesh.vertex_count());
    for position in mesh.positions() {
        let [x, y, z] = ((position - low) / size).into();
        let ripple = 0.08 * (12.0 * TAU * (x + 0.5 * y)).sin() * (9.0 * TAU * z).cos();
        let radius = ((x - 0.5).powi(2) + (y - 0.4).powi(2) + (z - 0.3).powi(2)).sqrt();
        let ring = if (10.0 * radius).fract() < 0.5 {
            0.18
        } else {
            -0.18
        };
        let shade = [
            0.5 + 0.2 * (TAU * (x + 0.3 * z)).sin() + ring,
            0.5 + 0.2 * (TAU * (y - 0.2 * x)).cos() - 0.5 * ring,
            0.5 + 0.2 * (TAU * (z + 0.4 * y)).sin() + 0.3 * ring,
        ];
        values.extend(shade.map(|c| (c + ripple).clamp(0.0, 1.0)));
    }
    values
}

/// Returns an image-like colour of every vertex, `[vertex][red, green, blue]` in [0, 1].
///
/// As in a photograph of patched cloth, detail is unevenly spread: regions that are shaded smoothly
/// and meet at sharp borders, of which every third is woven from fine ripples and every other third
/// carries stripes with sharp borders.
#[must_use]
pub fn colour_image(mesh: &TriangleMesh) -> Vec<f64> {
    let [low, high] = mesh.bounding_box();
    let sides = high - low;
    let size = sides.max().max(f64::MIN_POSITIVE);
    let seeds: [Vector3<f64>; REGIONS] = std::array::from_fn(|region| {
        let spread = Vector3::from(SPREAD.map(|step| (0.5 + region as f64 * step).fract()));
        spread.component_mul(&sides) / size
    });
    let positions = mesh.positions().iter();
    positions
        .flat_map(|position| image_at((position - low) / size, &seeds))
        .collect()
}

/// Returns the colour of the image at a place in the unit cube; a region is the part of space that
/// is nearest to its seed.
fn image_at(at: Vector3<f64>, seeds: &[Vector3<f64>]) -> [f64; 3] {
    let squares = seeds.iter().map(|seed| (at - seed).norm_squared());
    let (region, square) = squares
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or_default();
    let [x, y, z] = at.into();
    let wave = |cycles: f64, along: f64| (cycles * TAU * along).sin();
    let light = 0.85 + 0.15 * wave(1.0, 0.6 * x + 0.5 * y + 0.4 * z) - square;
    let weave = |cycles: f64| wave(cycles, x + 0.4 * z) * wave(cycles, y - 0.4 * z);
    let (dye, texture) = match region % 3 {
        1 => (1.0, 0.1 * weave(9.0) + 0.05 * weave(21.0)),
        2 if wave(7.0, 0.5 * x + 0.8 * y + 0.3 * z) > 0.5 => (0.5, 0.0),
        _ => (1.0, 0.0),
    };
    PALETTE[region % PALETTE.len()].map(|base| (base * dye * light + texture).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;

    #[test]
    fn colours_are_channels_of_every_vertex_and_the_same_every_time() {
        let mesh = shapes::genus(8, 5_000);
        for colours in [colour_pattern, colour_image] {
            let found = colours(&mesh);
            assert_eq!(found.len(), 3 * mesh.vertex_count());
            assert!(found.iter().all(|c| (0.0..=1.0).contains(c)));
            assert_eq!(found, colours(&mesh));
        }
    }

    #[test]
    fn an_image_is_smooth_in_most_places_and_jumps_in_some() {
        let mesh = shapes::genus(8, 20_000);
        let colours = colour_image(&mesh);
        let jump = |[a, b, _]: &[u32; 3]| {
            let colour = |v: u32| Vector3::from_column_slice(&colours[3 * v as usize..][..3]);
            (colour(*a) - colour(*b)).norm()
        };
        let jumps: Vec<f64> = mesh.faces().iter().map(jump).collect();
        let share = |holds: &dyn Fn(f64) -> bool| {
            jumps.iter().filter(|&&jump| holds(jump)).count() as f64 / jumps.len() as f64
        };
        let (smooth, sharp) = (share(&|jump| jump < 0.02), share(&|jump| jump > 0.2));
        assert!(smooth > 0.4, "{smooth}");
        assert!((0.02..0.2).contains(&sharp), "{sharp}");
    }
}
