//! An animation in memory, and its frames one by one.

use std::f64::consts::TAU;
use std::path::Path;

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};
use msplines_io::{Array, read_npy};

use super::Animation;
use crate::error::RunError;
use crate::input::{file_name, range};

/// Numbers of an affine map: a matrix and a shift, row by row.
const MAP: usize = 12;

/// Largest angle of the twist between the ends of the axis.
const TWIST: f64 = 1.2;
/// Height of the wave over the diagonal.
const WAVE_HEIGHT: f64 = 0.04;
/// Length of the wave over the diagonal.
const WAVE_LENGTH: f64 = 0.5;

/// An animation in memory.
#[derive(Clone, Debug)]
pub(crate) struct Loaded {
    /// Number of frames.
    pub(crate) frames: usize,
    /// Components of a value.
    pub(crate) dimension: usize,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Skinned {
        rest: Vec<Point3<f64>>,
        weights: Vec<f32>,
        transforms: Vec<f32>,
        bones: usize,
    },
    Array(Vec<f64>),
    TwistAndWave {
        rest: Vec<Point3<f64>>,
        centre: Point3<f64>,
        diagonal: f64,
    },
}

impl Animation {
    /// Reads the files of the animation of `mesh`.
    ///
    /// # Errors
    /// A file that cannot be read, or whose size does not fit the mesh.
    pub(crate) fn load(&self, mesh: &TriangleMesh) -> Result<Loaded, RunError> {
        match self {
            Self::Skinned {
                weights,
                transforms,
            } => skinned(mesh, weights, transforms),
            Self::Array(path) => {
                let array = read_npy(path).map_err(|e| refused(path, e.to_string()))?;
                Loaded::of_array(mesh, path, array)
            }
            Self::TwistAndWave => {
                let [low, high] = mesh.bounding_box();
                let source = Source::TwistAndWave {
                    rest: mesh.positions().to_vec(),
                    centre: low + (high - low) * 0.5,
                    diagonal: mesh.diagonal(),
                };
                let (frames, dimension) = (Self::WAVE_FRAMES, 3);
                Ok(Loaded {
                    frames,
                    dimension,
                    source,
                })
            }
        }
    }
}

impl Loaded {
    /// Returns the animation in an array of frames × vertices × components.
    ///
    /// # Errors
    /// Another shape, or a number that is not finite.
    pub(crate) fn of_array(
        mesh: &TriangleMesh,
        path: &Path,
        array: Array,
    ) -> Result<Self, RunError> {
        let vertices = mesh.vertex_count();
        let (frames, dimension) = match *array.shape.as_slice() {
            [frames, found, dimension] if frames > 0 && found == vertices && dimension > 0 => {
                (frames, dimension)
            }
            _ => {
                let shape = &array.shape;
                let reason = format!(
                    "its shape is {shape:?}; give frames × {vertices} vertices × components"
                );
                return Err(refused(path, reason));
            }
        };
        if let Some(index) = array.values.iter().position(|x| !x.is_finite()) {
            let (frame, vertex) = (index / (vertices * dimension), index / dimension % vertices);
            let reason = format!("frame {frame} is not finite at vertex {vertex}; mend the file");
            return Err(refused(path, reason));
        }
        Ok(Self {
            frames,
            dimension,
            source: Source::Array(array.values),
        })
    }

    /// Returns the values of a frame below [`Self::frames`], `[vertex][component]`.
    pub(crate) fn frame(&self, frame: usize) -> Vec<f64> {
        let coordinates = |p: Point3<f64>| [p.x, p.y, p.z];
        match &self.source {
            Source::Skinned {
                rest,
                weights,
                transforms,
                bones,
            } => {
                let maps = &transforms[frame * bones * MAP..][..bones * MAP];
                let rows = rest.iter().zip(weights.chunks_exact(*bones));
                rows.flat_map(|(x, w)| coordinates(blend(x, w, maps)))
                    .collect()
            }
            Source::Array(values) => {
                let length = values.len() / self.frames;
                values[frame * length..][..length].to_vec()
            }
            Source::TwistAndWave {
                rest,
                centre,
                diagonal,
            } => {
                let phase = TAU * frame as f64 / self.frames as f64;
                let moved = |x: &Point3<f64>| wave(x, centre, *diagonal, phase);
                rest.iter().flat_map(|x| coordinates(moved(x))).collect()
            }
        }
    }
}

impl Loaded {
    /// Returns whether the values are positions: three components are.
    pub(crate) fn are_positions(&self) -> bool {
        self.dimension == 3
    }

    /// Returns the names of the components.
    pub(crate) fn names(&self) -> Vec<String> {
        if self.are_positions() {
            return ["x", "y", "z"].map(str::to_owned).to_vec();
        }
        (0..self.dimension).map(|c| format!("value_{c}")).collect()
    }

    /// Returns what the errors of all frames are divided by: the diagonal of the mesh for positions,
    /// the range of all frames for other values.
    pub(crate) fn scale(&self, mesh: &TriangleMesh) -> f64 {
        match &self.source {
            Source::Array(values) if !self.are_positions() => range(values),
            _ => mesh.diagonal(),
        }
    }
}

/// Returns `Σ w[b] (A[b] x + a[b])`.
fn blend(x: &Point3<f64>, weights: &[f32], maps: &[f32]) -> Point3<f64> {
    let mut sum = Vector3::zeros();
    for (&weight, map) in weights.iter().zip(maps.chunks_exact(MAP)) {
        for (axis, row) in map.chunks_exact(4).enumerate() {
            let row = [row[0], row[1], row[2], row[3]].map(f64::from);
            let moved = row[0] * x.x + row[1] * x.y + row[2] * x.z + row[3];
            sum[axis] += f64::from(weight) * moved;
        }
    }
    sum.into()
}

/// Returns where the formula moves `x` in a phase of its period: nowhere in the first frame.
fn wave(x: &Point3<f64>, centre: &Point3<f64>, diagonal: f64, phase: f64) -> Point3<f64> {
    let from = (x - centre) / diagonal;
    let (sin, cos) = (TWIST * phase.sin() * from.y).sin_cos();
    let running = (TAU * from.y / WAVE_LENGTH - phase).sin();
    let height = WAVE_HEIGHT * 0.5 * (1.0 - phase.cos()) * running;
    let moved = Vector3::new(
        cos * from.x + sin * from.z + height,
        from.y,
        cos * from.z - sin * from.x,
    );
    centre + moved * diagonal
}

fn skinned(mesh: &TriangleMesh, weights: &Path, transforms: &Path) -> Result<Loaded, RunError> {
    let vertices = mesh.vertex_count();
    let of_vertices = numbers(weights)?;
    let bones = of_vertices.len() / vertices;
    if bones == 0 || of_vertices.len() != vertices * bones {
        let found = of_vertices.len();
        let reason = format!(
            "{found} numbers are not as many for each of {vertices} vertices; give the weights of \
             the input, vertices × bones"
        );
        return Err(refused(weights, reason));
    }
    let of_frames = numbers(transforms)?;
    let frames = of_frames.len() / (bones * MAP);
    if frames == 0 || of_frames.len() != frames * bones * MAP {
        let (found, each) = (of_frames.len(), bones * MAP);
        let reason = format!(
            "{found} numbers are not {each} for each frame; give frames × {bones} bones × 3 × 4, \
             as {} has weights for {bones} bones",
            file_name(weights)
        );
        return Err(refused(transforms, reason));
    }
    let source = Source::Skinned {
        rest: mesh.positions().to_vec(),
        weights: of_vertices,
        transforms: of_frames,
        bones,
    };
    let dimension = 3;
    Ok(Loaded {
        frames,
        dimension,
        source,
    })
}

/// Returns the numbers in a file of float32, little endian.
fn numbers(path: &Path) -> Result<Vec<f32>, RunError> {
    const SIZE: usize = size_of::<f32>();
    let bytes = std::fs::read(path).map_err(|e| refused(path, format!("cannot be read: {e}")))?;
    if bytes.len() % SIZE != 0 {
        let reason = format!(
            "{} bytes are no whole numbers of {SIZE} bytes; give float32, little endian",
            bytes.len()
        );
        return Err(refused(path, reason));
    }
    let (words, _) = bytes.as_chunks::<SIZE>();
    let numbers: Vec<f32> = words.iter().map(|&word| f32::from_le_bytes(word)).collect();
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(numbers),
        Some(index) => {
            let reason = format!("number {index} is not finite; mend the file");
            Err(refused(path, reason))
        }
    }
}

fn refused(path: &Path, reason: String) -> RunError {
    RunError::Array {
        option: "animation",
        file: file_name(path),
        reason,
    }
}
