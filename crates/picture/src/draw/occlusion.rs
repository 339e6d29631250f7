//! Ambient occlusion in the picture: how much of the sky what is seen nearby hides.
//!
//! For every pixel a few of its neighbours within reach are asked how far they rise above its
//! tangent plane. Each pixel of a 4x4 tile asks in other directions, and the mean over such a tile
//! takes the grain out again.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::frame::Frame;
use super::prepare::Prepared;
use super::{Buffers, NOTHING, Occlusion};

/// Openness of every pixel, and the depth that it belongs to.
pub(super) struct Openness {
    width: usize,
    height: usize,
    /// Depth at the middle of the pixel; 0 for the background.
    depth: Vec<f32>,
    /// Share of the sky in 0..=1 that nothing hides.
    open: Vec<f32>,
}

/// Neighbours that are asked.
const TAPS: usize = 16;
/// Side of the tile over which directions vary.
const TILE: usize = 4;
/// Different turns of the directions in a tile.
const TURNS: usize = 16;
/// Angle between successive neighbours: the golden one spreads any number of them evenly.
const GOLDEN_ANGLE: f32 = 2.399_963;
/// Sine of the rise over the tangent plane that facets of a mesh may have without a shade.
const RISE: f32 = 0.08;
/// Darkening at strength 1 per mean rise.
const GAIN: f32 = 3.0;
/// Depths that differ by less than this share of the reach are one surface.
const SAME_SURFACE: f32 = 0.2;
/// The farthest neighbour in pixels, which bounds the time of close views.
const FARTHEST: f32 = 160.0;

/// Returns the openness of all pixels.
pub(super) fn per_pixel(
    prepared: &Prepared<'_>,
    frame: &Frame,
    buffers: &Buffers,
    occlusion: &Occlusion,
) -> Openness {
    let samples = frame.samples;
    let (width, height) = (frame.width / samples, frame.height / samples);
    let middle = |pixel: usize| pixel * samples + samples / 2;
    let sample = |x: usize, y: usize| middle(y) * frame.width + middle(x);
    let mut openness = Openness {
        width,
        height,
        depth: vec![0.0; width * height],
        open: vec![1.0; width * height],
    };
    let rows = openness.depth.par_chunks_mut(width).enumerate();
    rows.for_each(|(y, row)| {
        for (x, depth) in row.iter_mut().enumerate() {
            let near = buffers.near[sample(x, y)];
            *depth = if near > 0.0 { 1.0 / near } else { 0.0 };
        }
    });
    if occlusion.strength <= 0.0 || occlusion.reach <= 0.0 {
        return openness;
    }
    let corner = frame.pixel_ray(0, 0);
    let gather = Gather {
        first: [corner.x as f32, corner.y as f32],
        pixels: (frame.focal / samples as f64) as f32,
        depth: &openness.depth,
        width,
        height,
        reach: occlusion.reach as f32,
        strength: GAIN * occlusion.strength as f32,
        neighbours: (0..TURNS).map(Gather::neighbours).collect(),
    };
    let mut raw = vec![1.0; width * height];
    raw.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, open) in row.iter_mut().enumerate() {
            let id = buffers.id[sample(x, y)];
            if id != NOTHING {
                let ray = frame.pixel_ray(x, y);
                *open = gather.open(x, y, &normal(prepared, id, &ray));
            }
        }
    });
    openness.open = gather.smooth(&raw);
    openness
}

fn normal(prepared: &Prepared<'_>, id: u32, ray: &Vector3<f64>) -> Vector3<f32> {
    if id >= prepared.first_sphere {
        return prepared.spheres[(id - prepared.first_sphere) as usize].normal(ray);
    }
    let (mesh, face) = prepared.face(id);
    mesh.hit(face, ray).normal
}

/// What the search around a pixel needs.
struct Gather<'a> {
    /// Slopes of the ray through the first pixel.
    first: [f32; 2],
    /// Pixels that the unit at depth 1 spans.
    pixels: f32,
    depth: &'a [f32],
    width: usize,
    height: usize,
    reach: f32,
    strength: f32,
    neighbours: Vec<[[f32; 2]; TAPS]>,
}

impl Gather<'_> {
    /// Returns the point seen at a pixel, in the camera's axes.
    fn point(&self, x: usize, y: usize) -> Vector3<f32> {
        let depth = self.depth[y * self.width + x];
        Vector3::new(
            (self.first[0] + x as f32 / self.pixels) * depth,
            (self.first[1] + y as f32 / self.pixels) * depth,
            depth,
        )
    }

    /// Returns the neighbours of a pixel with this turn: directions times shares of the radius.
    fn neighbours(turn: usize) -> [[f32; 2]; TAPS] {
        let start = turn as f32 / TURNS as f32;
        std::array::from_fn(|tap| {
            let share = (tap as f32 + 0.5 + 0.5 * start) / TAPS as f32;
            let angle = start * std::f32::consts::TAU + tap as f32 * GOLDEN_ANGLE;
            [share * angle.cos(), share * angle.sin()]
        })
    }

    /// Returns the share of the sky over a pixel that its neighbours leave open.
    fn open(&self, x: usize, y: usize, normal: &Vector3<f32>) -> f32 {
        let here = self.point(x, y);
        let radius = (self.reach * self.pixels / here.z).min(FARTHEST);
        let [i, j] = [x % TILE, y % TILE];
        // A pattern in which neighbours in a tile have different turns.
        let neighbours = &self.neighbours[(5 * i + 7 * j + i * j) % TURNS];
        let mut hidden = 0.0;
        for offset in neighbours {
            // Half a pixel, as the cast rounds down.
            let [u, v] = [
                x as f32 + 0.5 + radius * offset[0],
                y as f32 + 0.5 + radius * offset[1],
            ];
            if u < 0.0 || v < 0.0 || u >= self.width as f32 || v >= self.height as f32 {
                continue;
            }
            let (u, v) = (u as usize, v as usize);
            if self.depth[v * self.width + u] <= 0.0 {
                continue;
            }
            let way = self.point(u, v) - here;
            let distance = way.norm();
            let fade = 1.0 - (distance / self.reach).powi(2);
            if distance > 0.0 && fade > 0.0 {
                hidden += fade * (way.dot(normal) / distance - RISE).max(0.0);
            }
        }
        (1.0 - self.strength * hidden / TAPS as f32).max(0.0)
    }

    /// Returns the means over tiles around each pixel, of pixels on the same surface.
    fn smooth(&self, raw: &[f32]) -> Vec<f32> {
        let mut smooth = vec![1.0; raw.len()];
        let rows = smooth.par_chunks_mut(self.width).enumerate();
        rows.for_each(|(y, row)| {
            for (x, mean) in row.iter_mut().enumerate() {
                let here = self.depth[y * self.width + x];
                if here <= 0.0 {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0.0);
                for v in y.saturating_sub(TILE / 2)..(y + TILE / 2).min(self.height) {
                    for u in x.saturating_sub(TILE / 2)..(x + TILE / 2).min(self.width) {
                        let there = self.depth[v * self.width + u];
                        if there > 0.0 && (there - here).abs() < SAME_SURFACE * self.reach {
                            sum += raw[v * self.width + u];
                            count += 1.0;
                        }
                    }
                }
                *mean = if count > 0.0 {
                    sum / count
                } else {
                    raw[y * self.width + x]
                };
            }
        });
        smooth
    }
}

impl Openness {
    /// Returns the openness at a pixel for a sample of this depth: the pixel's own, or at the rim
    /// of a surface that of the neighbour whose depth is nearest.
    pub(super) fn at(&self, x: usize, y: usize, depth: f32) -> f32 {
        let place = y * self.width + x;
        let apart = |place: usize| {
            let there = self.depth[place];
            if there > 0.0 {
                (there - depth).abs()
            } else {
                f32::MAX
            }
        };
        if apart(place) < 0.02 * depth {
            return self.open[place];
        }
        let mut best = place;
        for v in y.saturating_sub(1)..(y + 2).min(self.height) {
            for u in x.saturating_sub(1)..(x + 2).min(self.width) {
                let other = v * self.width + u;
                if apart(other) < apart(best) {
                    best = other;
                }
            }
        }
        self.open[best]
    }
}
