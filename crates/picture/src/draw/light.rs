//! Light on surfaces: what a ray meets, its paint, and how bright it is.
//!
//! The lamps move with the camera, so that every view is lit alike: a key light from the upper
//! left, a weak fill from the right, a sky brighter than the ground, and a darker rim where a
//! surface turns away, which lets it stand out from white paper.

use nalgebra::Vector3;

use super::prepare::vertex_normals;
use crate::colour::{Linear, blend};
use crate::colour_map::ColourTable;
use crate::{Camera, Paint, Shading, Surface};

/// A surface in the camera's axes.
pub(super) struct Mesh<'a> {
    /// Number of its first face.
    pub(super) first: u32,
    /// Opacity in 0..=1.
    pub(super) opacity: f32,
    faces: &'a [[u32; 3]],
    corners: Vec<Vector3<f64>>,
    /// Normals of the vertices; none if the faces are flat.
    normals: Vec<Vector3<f32>>,
    cover: Cover<'a>,
}

/// A paint in linear light.
enum Cover<'a> {
    Uniform(Linear),
    Colours(Vec<Linear>),
    FaceColours(Vec<Linear>),
    Scalars(&'a [f64], Box<ColourTable>),
    Checkers(&'a [[[f64; 2]; 3]], f64, [Linear; 2]),
}

impl<'a> Cover<'a> {
    fn new(paint: Paint<'a>) -> Self {
        let linear = |colours: &[crate::Rgb]| colours.iter().map(|c| c.to_linear()).collect();
        match paint {
            Paint::Uniform(colour) => Self::Uniform(colour.to_linear()),
            Paint::Colours(colours) => Self::Colours(linear(colours)),
            Paint::FaceColours(colours) => Self::FaceColours(linear(colours)),
            Paint::Scalars { values, scale } => {
                Self::Scalars(values, Box::new(ColourTable::new(scale)))
            }
            Paint::Checkers {
                corners,
                squares,
                colours,
            } => Self::Checkers(corners, squares, colours.map(crate::Rgb::to_linear)),
        }
    }
}

/// Where a ray meets a face.
pub(super) struct Hit {
    face: usize,
    /// Weights of the three corners; they are not negative and sum to one.
    weights: [f64; 3],
    /// Unit normal on the side of the eye.
    pub(super) normal: Vector3<f32>,
    side: Side,
}

/// The side of a face that is seen.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Front,
    Back,
}

/// Share of each channel that the back of a face keeps: darker and warmer.
const BACK: Linear = [0.62, 0.42, 0.30];

impl<'a> Mesh<'a> {
    /// Returns a checked surface in the camera's axes, its faces numbered from `first`.
    pub(super) fn new(surface: &Surface<'a>, camera: &Camera, first: u32) -> Self {
        let corners: Vec<_> = surface
            .positions
            .iter()
            .map(|p| camera.to_view(p))
            .collect();
        let normals = match (surface.shading, surface.normals) {
            (Shading::Smooth, None) => vertex_normals(&corners, surface.faces),
            (Shading::Smooth, Some(own)) => own.iter().map(|n| camera.turned(n).cast()).collect(),
            (Shading::Flat, _) => Vec::new(),
        };
        Self {
            first,
            opacity: surface.opacity as f32,
            faces: surface.faces,
            corners,
            normals,
            cover: Cover::new(surface.paint),
        }
    }

    /// Returns the corners of a face.
    pub(super) fn corners_of(&self, face: usize) -> [Vector3<f64>; 3] {
        self.faces[face].map(|vertex| self.corners[vertex as usize])
    }

    /// Returns where a ray from the eye meets the plane of a face, moved into the face.
    ///
    /// A corner's weight is the volume that the ray spans with the other two corners, so it is
    /// exact in perspective, and a face that reaches behind the eye needs no cutting.
    pub(super) fn hit(&self, face: usize, ray: &Vector3<f64>) -> Hit {
        let [a, b, c] = self.corners_of(face);
        let volumes = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|side| side.dot(ray));
        let sum: f64 = volumes.iter().sum();
        let weights = volumes.map(|volume| (volume / sum).max(0.0));
        let total: f64 = weights.iter().sum();
        // Seen edge-on a face spans no volume.
        let weights = if total.is_finite() && total > 0.0 {
            weights.map(|weight| weight / total)
        } else {
            [1.0 / 3.0; 3]
        };
        let flat = (b - a).cross(&(c - a));
        let side = if flat.dot(ray) > 0.0 {
            Side::Back
        } else {
            Side::Front
        };
        let smooth = self.smooth_normal(face, weights);
        let normal = smooth
            .or_else(|| flat.try_normalize(0.0).map(|normal| normal.cast()))
            .unwrap_or_else(|| -Vector3::z());
        let normal = if side == Side::Back { -normal } else { normal };
        Hit {
            face,
            weights,
            normal,
            side,
        }
    }

    fn smooth_normal(&self, face: usize, weights: [f64; 3]) -> Option<Vector3<f32>> {
        if self.normals.is_empty() {
            return None;
        }
        let [a, b, c] = self.faces[face].map(|vertex| self.normals[vertex as usize]);
        let [u, v, w] = weights.map(|weight| weight as f32);
        (a * u + b * v + c * w).try_normalize(1e-6)
    }

    /// Returns whether the paint has edges inside of faces, so that every sample needs its own.
    pub(super) fn varies_within_faces(&self) -> bool {
        matches!(self.cover, Cover::Checkers(..))
    }

    /// Returns the colour of the paint where a ray meets the surface.
    pub(super) fn colour(&self, hit: &Hit) -> Linear {
        let vertices = self.faces[hit.face].map(|vertex| vertex as usize);
        let colour = match &self.cover {
            Cover::Uniform(colour) => *colour,
            Cover::FaceColours(colours) => colours[hit.face],
            Cover::Colours(colours) => {
                let [a, b, c] = vertices.map(|vertex| colours[vertex]);
                let [u, v, w] = hit.weights.map(|weight| weight as f32);
                [0, 1, 2].map(|i| a[i] * u + b[i] * v + c[i] * w)
            }
            Cover::Scalars(values, table) => {
                let terms = [0, 1, 2].map(|i| hit.weights[i] * values[vertices[i]]);
                table.colour(terms.iter().sum())
            }
            Cover::Checkers(corners, squares, colours) => {
                let [a, b, c] = corners[hit.face];
                let [u, v, w] = hit.weights;
                let cell = |i: usize| ((u * a[i] + v * b[i] + w * c[i]) * squares).floor();
                colours[usize::from((cell(0) + cell(1)).rem_euclid(2.0) >= 1.0)]
            }
        };
        // What lets one look through has no inside to be told from its outside.
        if hit.side == Side::Front || self.opacity < 1.0 {
            return colour;
        }
        [0, 1, 2].map(|i| colour[i] * BACK[i])
    }
}

/// Directions towards the lamps: right, down and forward from the eye.
const KEY: [f32; 3] = [-0.42, -0.66, -0.62];
const FILL: [f32; 3] = [0.80, -0.10, -0.59];
/// Brightness of the lamps. A face towards the eye returns about its own colour.
const KEY_LIGHT: f32 = 0.70;
const FILL_LIGHT: f32 = 0.20;
const SKY_LIGHT: f32 = 0.52;
const GROUND_LIGHT: f32 = 0.30;
/// How much darker a surface becomes where it turns away from the eye.
const RIM: f32 = 0.30;
/// Strength and sharpness of the highlight.
const SHINE: f32 = 0.05;
const SHARPNESS: i32 = 24;

/// Returns the light that a surface of this colour sends to the eye.
///
/// `ray` points from the eye, `openness` in 0..=1 is the share of the sky that nothing hides.
pub(super) fn lit(
    colour: Linear,
    normal: &Vector3<f32>,
    ray: &Vector3<f64>,
    openness: f32,
) -> Linear {
    let to_eye: Vector3<f32> = (-ray.normalize()).cast();
    let key = Vector3::from(KEY);
    let facing = normal.dot(&to_eye).clamp(0.0, 1.0);
    let sky = 0.5 - 0.5 * normal.y;
    let ambient = GROUND_LIGHT + (SKY_LIGHT - GROUND_LIGHT) * sky;
    let direct = KEY_LIGHT * normal.dot(&key).max(0.0)
        + FILL_LIGHT * normal.dot(&Vector3::from(FILL)).max(0.0);
    let rim = 1.0 - RIM * (1.0 - facing).powi(3);
    let light = (ambient * openness + direct * (0.4 + 0.6 * openness)) * rim;
    let half = (key + to_eye).normalize();
    let shine = SHINE * normal.dot(&half).max(0.0).powi(SHARPNESS) * openness;
    let diffuse = colour.map(|channel| channel * light);
    blend(diffuse, [1.0; 3], shine)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::{FILL, KEY, lit};

    #[test]
    fn lamps_point_in_unit_directions() {
        for lamp in [KEY, FILL] {
            assert!((Vector3::from(lamp).norm() - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn a_face_towards_the_eye_keeps_its_colour_and_a_hollow_is_darker() {
        let ray = Vector3::z();
        let towards = -Vector3::z();
        let open = lit([0.5; 3], &towards, &ray, 1.0)[0];
        assert!((0.4..0.6).contains(&open), "{open}");
        assert!(lit([0.5; 3], &towards, &ray, 0.3)[0] < 0.7 * open);
        assert!(lit([0.5; 3], &Vector3::x(), &ray, 1.0)[0] < open);
    }
}
