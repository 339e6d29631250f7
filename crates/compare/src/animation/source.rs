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

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;
    use crate::case::Input;
    use crate::clock::PhaseClock;
    use crate::input::load;
    use crate::models::models_folder;

    fn file(folder: &Path, name: &str, numbers: &[f32]) -> std::path::PathBuf {
        let path = folder.join(name);
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(&path, bytes).expect("written");
        path
    }

    /// A shift by `x`.
    fn shift(x: f32) -> [f32; MAP] {
        [1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    }

    #[test]
    fn skinning_blends_the_maps_of_the_bones() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mesh = shapes::sphere(12);
        let quarter_turn = [0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0];
        let frames = [[shift(0.0), shift(0.0)], [shift(8.0), quarter_turn]];
        let transforms = file(folder.path(), "t.f32", &frames.concat().concat());
        let weights: Vec<f32> = (0..mesh.vertex_count())
            .flat_map(|_| [0.25, 0.75])
            .collect();
        let weights = file(folder.path(), "w.f32", &weights);
        let skinned = Animation::Skinned {
            weights,
            transforms,
        };
        let loaded = skinned.load(&mesh).expect("files that fit");
        assert_eq!((loaded.frames, loaded.dimension), (2, 3));
        let (rest, moved) = (loaded.frame(0), loaded.frame(1));
        for (vertex, p) in mesh.positions().iter().enumerate() {
            assert_eq!(rest[3 * vertex..][..3], [p.x, p.y, p.z]);
            // A quarter of the shift by 8, three quarters of the turn and its shift by 2.
            let expected = [
                0.25 * (p.x + 8.0) - 0.75 * p.y,
                0.25 * p.y + 0.75 * p.x,
                p.z + 0.75 * 2.0,
            ];
            for (found, expected) in moved[3 * vertex..].iter().zip(expected) {
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
        }
    }

    #[test]
    fn files_that_do_not_fit_are_refused_with_their_numbers() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str, numbers: &[f32]| file(folder.path(), name, numbers);
        let mesh = shapes::sphere(12);
        let vertices = mesh.vertex_count();
        let two_bones = at("w.f32", &vec![0.5; 2 * vertices]);
        let one_frame = at("t.f32", &[shift(0.0), shift(0.0)].concat());
        let torn = folder.path().join("torn.f32");
        std::fs::write(&torn, [0; 7]).expect("written");
        let odd = at("odd.f32", &vec![0.5; 2 * vertices + 1]);
        let bad = [
            (
                odd,
                one_frame.clone(),
                format!("odd.f32: {} numbers", 2 * vertices + 1),
            ),
            (
                two_bones.clone(),
                at("odd-t.f32", &[0.0; 25]),
                "odd-t.f32: 25 numbers are not 24".to_owned(),
            ),
            (
                two_bones.clone(),
                at("no.f32", &[]),
                "no.f32: 0 numbers".to_owned(),
            ),
            (
                at("few.f32", &[1.0]),
                one_frame.clone(),
                format!("few.f32: 1 numbers are not as many for each of {vertices}"),
            ),
            (torn, one_frame.clone(), "torn.f32: 7 bytes".to_owned()),
            (
                at("nan.f32", &vec![f32::NAN; vertices]),
                one_frame,
                "nan.f32: number 0 is not finite".to_owned(),
            ),
            (
                two_bones,
                folder.path().join("none.f32"),
                "none.f32: cannot be read".to_owned(),
            ),
        ];
        for (weights, transforms, message) in bad {
            let skinned = Animation::Skinned {
                weights,
                transforms,
            };
            let error = skinned.load(&mesh).expect_err(&message).to_string();
            assert!(
                error.starts_with(&format!("animation {message}")),
                "{error}"
            );
        }
    }

    #[test]
    fn an_array_has_a_row_for_every_vertex_of_every_frame() {
        let mesh = shapes::sphere(12);
        let vertices = mesh.vertex_count();
        let array = |shape: [usize; 3], last: f64| {
            let count: usize = shape.iter().product();
            let mut values: Vec<f64> = (0..count).map(|i| i as f64).collect();
            values[count - 1] = last;
            let shape = shape.to_vec();
            Loaded::of_array(&mesh, Path::new("a/b.npy"), Array { shape, values })
        };
        let loaded = array([2, vertices, 1], 3.0).expect("an array that fits");
        assert_eq!((loaded.frames, loaded.dimension), (2, 1));
        assert_eq!(loaded.frame(1)[0], vertices as f64);
        assert_eq!(loaded.names(), ["value_0"]);
        assert_eq!(loaded.scale(&mesh), 2.0 * vertices as f64 - 2.0);
        let error = array([2, vertices + 1, 3], 0.0)
            .expect_err("too many")
            .to_string();
        let shape = format!("animation b.npy: its shape is [2, {}, 3]", vertices + 1);
        assert!(error.starts_with(&shape), "{error}");
        let error = array([2, vertices, 3], f64::NAN)
            .expect_err("not finite")
            .to_string();
        let place = format!("frame 1 is not finite at vertex {}", vertices - 1);
        assert!(error.contains(&place), "{error}");
    }

    #[test]
    fn the_formula_starts_at_rest_and_moves_every_vertex_smoothly() {
        let mesh = shapes::bumpy_sphere(500);
        let loaded = Animation::TwistAndWave.load(&mesh).expect("no files");
        let distance = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / mesh.diagonal()
        };
        let rest: Vec<f64> = mesh
            .positions()
            .iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .collect();
        assert!(distance(&loaded.frame(0), &rest) < 1e-15);
        assert!(distance(&loaded.frame(25), &rest) > 0.05);
        for frame in 0..loaded.frames {
            let next = loaded.frame((frame + 1) % loaded.frames);
            let step = distance(&loaded.frame(frame), &next);
            assert!(step < 0.02, "frame {frame}: {step}");
        }
    }

    #[test]
    fn the_bird_of_the_library_is_skinned_as_its_reference_frame() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        // A relative folder is meant from the project's root, where the tests are started.
        let folder = root.join(models_folder(None, &root)).join("anim");
        if !folder.join("bird_rest.ply").is_file() {
            println!("not run: bird_rest");
            return;
        }
        let mesh = |name: &str| {
            let (path, repair) = (folder.join(name), false);
            let mut clock = PhaseClock::start(std::time::Instant::now());
            load(&Input::File { path, repair }, &mut clock)
                .expect("a mesh")
                .mesh
        };
        let rest = mesh("bird_rest.ply");
        let skinned = Animation::Skinned {
            weights: folder.join("bird_weights.f32"),
            transforms: folder.join("bird_transforms.f32"),
        };
        let loaded = skinned.load(&rest).expect("files that fit");
        assert_eq!(loaded.frames, 100);
        let found = loaded.frame(50);
        for (vertex, expected) in mesh("bird_frame050.ply").positions().iter().enumerate() {
            let found = Point3::from_slice(&found[3 * vertex..][..3]);
            // The reference is stored in single precision.
            let error = (found - expected).norm();
            assert!(error < 1e-6 * rest.diagonal(), "vertex {vertex}: {error}");
        }
    }
}
