//! From a scene to pixels, in three passes over bands of rows.
//!
//! 1. Opaque faces and spheres leave, for every sample, the inverse of the depth and the number of
//!    what is seen ([`Buffers`]).
//! 2. One value of ambient occlusion is found per pixel ([`occlusion`]).
//! 3. Every sample is shaded, curves and translucent faces are blended over it from far to near,
//!    and the samples of a pixel are averaged in linear light ([`resolve`]).
//!
//! A band is written by one thread and reads only results of earlier passes, so the number of
//! threads cannot show.

mod curves;
mod frame;
mod light;
mod occlusion;
mod prepare;
mod resolve;
mod spheres;
mod triangles;

use nalgebra::Point3;
use rayon::prelude::*;

use self::frame::Frame;
use self::prepare::Prepared;
use crate::error::check_option;
use crate::image::check_size;
use crate::{Image, PictureError, Rect, Rgb, Scene};

/// How a scene becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawing {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Samples along each side of a pixel, 1 to 8; more give smoother edges and take time.
    pub samples: usize,
    /// Colour where nothing is.
    pub background: Rgb,
    /// Darkening of hollows.
    pub occlusion: Occlusion,
    /// How far curves are drawn nearer than they are, as a share of [`Camera::radius`]
    /// (half the diagonal of what is framed): large enough that the chords of a mesh do not
    /// hide a curve on the smooth surface, small enough that nothing shines through.
    ///
    /// [`Camera::radius`]: crate::Camera::radius
    pub bias: f64,
    /// Draws a part of the picture only, magnified.
    pub detail: Option<Detail>,
}

impl Default for Drawing {
    fn default() -> Self {
        Self {
            width: 1000,
            height: 1000,
            samples: 3,
            background: Rgb::WHITE,
            occlusion: Occlusion::default(),
            bias: 0.006,
            detail: None,
        }
    }
}

/// Darkening of hollows: how much of the sky is hidden by what is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occlusion {
    /// 0 for none; 1 is the usual amount, up to 3.
    pub strength: f64,
    /// How far something can cast its shade, as a share of the camera's radius.
    pub reach: f64,
}

impl Default for Occlusion {
    fn default() -> Self {
        Self {
            strength: 1.0,
            reach: 0.2,
        }
    }
}

/// A part of a picture to be drawn magnified, as for a [`Callout`](crate::Callout).
///
/// The image then has the size of `source` times the magnification, and lines and marks grow along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// The part, in pixels of the whole picture; it may reach beyond it.
    pub source: Rect,
    /// Whole pixels per pixel of the source.
    pub magnification: usize,
}

/// Rows of pixels that are worked on as one task.
const BAND: usize = 16;

/// Number of a sample that shows the background.
const NOTHING: u32 = u32::MAX;

/// What is seen at every sample, row by row.
struct Buffers {
    /// Inverse of the depth; 0 for the background.
    near: Vec<f32>,
    /// Number of the face or sphere.
    id: Vec<u32>,
}

/// Returns the picture of a scene; see [`Scene::draw`].
pub(crate) fn draw(scene: &Scene<'_>, drawing: &Drawing) -> Result<Image, PictureError> {
    check(drawing)?;
    let (width, height) = frame::size(drawing);
    check_size(width, height, drawing.samples)?;
    let frame = Frame::new(&scene.camera, drawing);
    let prepared = Prepared::build(scene, &frame)?;
    let buffers = visible(&prepared, &frame);
    let shade = occlusion::per_pixel(&prepared, &frame, &buffers, &drawing.occlusion);
    resolve::image(&prepared, &frame, &buffers, &shade, drawing.background)
}

/// Returns where a point appears; see [`Scene::pixel`].
pub(crate) fn pixel(scene: &Scene<'_>, point: &Point3<f64>, drawing: &Drawing) -> Option<[f64; 2]> {
    let frame = Frame::new(&scene.camera, drawing);
    let seen = scene.camera.to_view(point);
    let samples = drawing.samples.max(1) as f64;
    (seen.z > 0.0).then(|| frame.project(&seen).map(|sample| sample / samples))
}

fn check(drawing: &Drawing) -> Result<(), PictureError> {
    let samples = drawing.samples as f64;
    let range = |low: f64, high: f64| move |value: f64| (low..=high).contains(&value);
    check_option("samples", samples, range(1.0, 8.0), "from 1 to 8")?;
    check_option("bias", drawing.bias, range(0.0, 1.0), "from 0 to 1")?;
    let Occlusion { strength, reach } = drawing.occlusion;
    check_option(
        "strength of occlusion",
        strength,
        range(0.0, 3.0),
        "from 0 to 3",
    )?;
    check_option("reach of occlusion", reach, range(0.0, 1.0), "from 0 to 1")?;
    if let Some(detail) = drawing.detail {
        let magnification = detail.magnification as f64;
        check_option(
            "magnification",
            magnification,
            range(1.0, 64.0),
            "from 1 to 64",
        )?;
        check_size(drawing.width, drawing.height, 1)?;
    }
    Ok(())
}

/// Returns what is seen at every sample; of two things at one depth the one with the lower number.
fn visible(prepared: &Prepared<'_>, frame: &Frame) -> Buffers {
    let samples = frame.width * frame.height;
    let mut buffers = Buffers {
        near: vec![0.0; samples],
        id: vec![NOTHING; samples],
    };
    let rows = BAND * frame.samples;
    let bands = frame.height.div_ceil(rows);
    let faces = frame::bins(prepared.solid.iter().map(|t| t.rows(frame)), rows, bands);
    let balls = frame::bins(prepared.spheres.iter().map(|s| s.rows(frame)), rows, bands);
    let near = buffers.near.par_chunks_mut(rows * frame.width);
    let id = buffers.id.par_chunks_mut(rows * frame.width);
    near.zip(id).enumerate().for_each(|(band, (near, id))| {
        let first = band * rows;
        let range = first..first + near.len() / frame.width;
        let mut put = |at: usize, inverse: f32, number: u32| {
            if inverse > near[at] {
                near[at] = inverse;
                id[at] = number;
            }
        };
        for &index in &faces[band] {
            let triangle = &prepared.solid[index as usize];
            triangle.cover(frame, range.clone(), |at, inverse| {
                put(at, inverse, triangle.id);
            });
        }
        for &index in &balls[band] {
            let number = prepared.first_sphere + index;
            prepared.spheres[index as usize]
                .cover(frame, range.clone(), |at, inverse| put(at, inverse, number));
        }
    });
    buffers
}
