//! From samples to pixels: shades, blends what is translucent, and averages in linear light.

use std::ops::Range;

use rayon::prelude::*;

use super::frame::{self, Frame};
use super::light::lit;
use super::occlusion::Openness;
use super::prepare::Prepared;
use super::{BAND, Buffers, NOTHING};
use crate::colour::{Linear, blend, bytes_from_linear};
use crate::{Image, PictureError, Rgb};

/// A translucent piece over one sample.
#[derive(Clone, Copy)]
struct Layer {
    /// Place of the sample in the band.
    place: u32,
    /// Inverse depth.
    inverse: f32,
    colour: Linear,
    opacity: f32,
    /// Number of the curves it belongs to; none for faces.
    curves: Option<u32>,
}

/// Layers of a band, for each sample from far to near.
struct Layers {
    layers: Vec<Layer>,
    /// Where each sample's layers start; empty if there are none at all.
    starts: Vec<u32>,
}

impl Layers {
    /// Returns the layers sorted by sample and from far to near; at one depth, what was added
    /// first is behind.
    fn sorted(added: &[Layer], samples: usize) -> Self {
        let mut layers = added.to_vec();
        if added.is_empty() {
            let starts = Vec::new();
            return Self { layers, starts };
        }
        let mut starts = vec![0_u32; samples + 1];
        for layer in added {
            starts[layer.place as usize + 1] += 1;
        }
        for i in 0..samples {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        for layer in added {
            let next = &mut next[layer.place as usize];
            layers[*next as usize] = *layer;
            *next += 1;
        }
        for run in layers.chunk_by_mut(|a, b| a.place == b.place) {
            unite_strokes(run);
            run.sort_by(|a, b| a.inverse.total_cmp(&b.inverse));
        }
        Self { layers, starts }
    }

    fn over(&self, place: usize) -> &[Layer] {
        match (self.starts.get(place), self.starts.get(place + 1)) {
            (Some(&start), Some(&end)) => &self.layers[start as usize..end as usize],
            _ => &[],
        }
    }
}

/// Lets the strokes of one object over one sample act as one, so that the ends of segments, which
/// overlap, are no darker than the rest; what is taken into another is left with no opacity.
fn unite_strokes(run: &mut [Layer]) {
    for i in 1..run.len() {
        let (before, rest) = run.split_at_mut(i);
        let layer = &mut rest[0];
        let same = |other: &&mut Layer| other.curves.is_some() && other.curves == layer.curves;
        if let Some(first) = before.iter_mut().find(same) {
            first.opacity = first.opacity.max(layer.opacity);
            first.inverse = first.inverse.max(layer.inverse);
            layer.opacity = 0.0;
        }
    }
}

/// What shading a band needs.
struct Resolve<'a> {
    prepared: &'a Prepared<'a>,
    frame: &'a Frame,
    buffers: &'a Buffers,
    openness: &'a Openness,
    background: Linear,
}

/// Returns the picture.
pub(super) fn image(
    prepared: &Prepared<'_>,
    frame: &Frame,
    buffers: &Buffers,
    openness: &Openness,
    background: Rgb,
) -> Result<Image, PictureError> {
    let samples = frame.samples;
    let width = frame.width / samples;
    let mut image = Image::new(width, frame.height / samples, background)?;
    let rows = BAND * samples;
    let bands = frame.height.div_ceil(rows);
    let glass = frame::bins(prepared.glass.iter().map(|t| t.rows(frame)), rows, bands);
    let strokes = frame::bins(prepared.strokes.iter().map(|s| s.rows(frame)), rows, bands);
    let resolve = Resolve {
        prepared,
        frame,
        buffers,
        openness,
        background: background.to_linear(),
    };
    let bytes = image.bytes_mut().par_chunks_mut(3 * width * BAND);
    bytes.enumerate().for_each(|(band, bytes)| {
        let first = band * rows;
        let range = first..first + bytes.len() / (3 * width) * samples;
        let layers = resolve.layers(&glass[band], &strokes[band], range);
        for (pixel, bytes) in bytes.chunks_exact_mut(3).enumerate() {
            let (x, y) = (pixel % width, pixel / width);
            if let Some(colour) = resolve.pixel(x, y, band * BAND, &layers) {
                bytes.copy_from_slice(&bytes_from_linear(colour));
            }
        }
    });
    Ok(image)
}

impl Resolve<'_> {
    /// Returns what is translucent in these rows of samples.
    fn layers(&self, glass: &[u32], strokes: &[u32], rows: Range<usize>) -> Layers {
        let (frame, near) = (self.frame, &self.buffers.near);
        let offset = rows.start * frame.width;
        let mut layers = Vec::new();
        for &index in glass {
            let triangle = &self.prepared.glass[index as usize];
            let (mesh, face) = self.prepared.face(triangle.id);
            triangle.cover(frame, rows.clone(), |place, inverse| {
                if inverse > near[offset + place] {
                    let ray = frame.ray(place % frame.width, rows.start + place / frame.width);
                    let hit = mesh.hit(face, &ray);
                    layers.push(Layer {
                        place: place as u32,
                        inverse,
                        colour: lit(mesh.colour(&hit), &hit.normal, &ray, 1.0),
                        opacity: mesh.opacity,
                        curves: None,
                    });
                }
            });
        }
        for &index in strokes {
            let stroke = &self.prepared.strokes[index as usize];
            stroke.cover(frame, near, rows.clone(), |place, inverse, opacity| {
                layers.push(Layer {
                    place: place as u32,
                    inverse,
                    colour: stroke.colour,
                    opacity,
                    curves: Some(stroke.object),
                });
            });
        }
        Layers::sorted(&layers, rows.len() * frame.width)
    }

    /// Returns the mean colour of a pixel's samples; `None` where only background is.
    fn pixel(&self, x: usize, row: usize, first_row: usize, layers: &Layers) -> Option<Linear> {
        let (frame, samples) = (self.frame, self.frame.samples);
        let mut sum = [0.0_f32; 3];
        let mut blank = true;
        let mut shaded = Shaded::default();
        for j in row * samples..(row + 1) * samples {
            for i in x * samples..(x + 1) * samples {
                let sample = (first_row * samples + j) * frame.width + i;
                let over = layers.over(j * frame.width + i);
                blank &= self.buffers.id[sample] == NOTHING && over.is_empty();
                let below = self.solid(sample, x, first_row + row, &mut shaded);
                let colour = over.iter().fold(below, |below, layer| {
                    blend(below, layer.colour, layer.opacity)
                });
                (0..3).for_each(|c| sum[c] += colour[c].min(1.0));
            }
        }
        (!blank).then(|| sum.map(|channel| channel / (samples * samples) as f32))
    }

    /// Returns the colour of what is opaque at a sample of pixel (x, y).
    fn solid(&self, sample: usize, x: usize, y: usize, shaded: &mut Shaded) -> Linear {
        let id = self.buffers.id[sample];
        if id == NOTHING {
            return self.background;
        }
        if let Some(colour) = shaded.find(id) {
            return colour;
        }
        let frame = self.frame;
        let openness = self.openness.at(x, y, 1.0 / self.buffers.near[sample]);
        if id >= self.prepared.first_sphere {
            let ball = &self.prepared.spheres[(id - self.prepared.first_sphere) as usize];
            let ray = frame.pixel_ray(x, y);
            let colour = lit(ball.colour, &ball.normal(&ray), &ray, openness);
            return shaded.keep(id, colour);
        }
        let (mesh, face) = self.prepared.face(id);
        let detailed = mesh.varies_within_faces();
        let ray = if detailed {
            frame.ray(sample % frame.width, sample / frame.width)
        } else {
            frame.pixel_ray(x, y)
        };
        let hit = mesh.hit(face, &ray);
        let colour = lit(mesh.colour(&hit), &hit.normal, &ray, openness);
        if detailed {
            colour
        } else {
            shaded.keep(id, colour)
        }
    }
}

/// Colours of the things last seen in a pixel. Within one pixel a face or sphere has one colour,
/// that at the middle of the pixel; only where things begin and end, each sample counts.
#[derive(Default)]
struct Shaded {
    entries: [(u32, Linear); 4],
    count: usize,
}

impl Shaded {
    fn find(&self, id: u32) -> Option<Linear> {
        let known = &self.entries[..self.count.min(self.entries.len())];
        known
            .iter()
            .find(|entry| entry.0 == id)
            .map(|entry| entry.1)
    }

    fn keep(&mut self, id: u32, colour: Linear) -> Linear {
        self.entries[self.count % self.entries.len()] = (id, colour);
        self.count += 1;
        colour
    }
}
