//! Checks a scene and turns it into the camera's axes.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::curves::Stroke;
use super::frame::Frame;
use super::light::Mesh;
use super::spheres::Ball;
use super::triangles::{self, Triangle};
use crate::error::{PictureError, check_option};
use crate::{Camera, Curves, Object, Paint, Scene, Spheres, Surface};

/// A scene ready to be drawn: everything that may be in sight, in the camera's axes.
pub(super) struct Prepared<'a> {
    /// Surfaces, with the numbers of their faces in increasing order.
    meshes: Vec<Mesh<'a>>,
    /// Triangles of opaque surfaces.
    pub(super) solid: Vec<Triangle>,
    /// Triangles of translucent surfaces.
    pub(super) glass: Vec<Triangle>,
    /// Spheres in sight.
    pub(super) spheres: Vec<Ball>,
    /// Number of the first sphere; faces have lower ones.
    pub(super) first_sphere: u32,
    /// Segments of curves.
    pub(super) strokes: Vec<Stroke>,
}

/// Faces that are set up as one task; the order of the triangles does not depend on the split.
const CHUNK: usize = 1 << 13;

impl<'a> Prepared<'a> {
    /// Returns the scene in the camera's axes, or what is wrong with it.
    pub(super) fn build(scene: &Scene<'a>, frame: &Frame) -> Result<Self, PictureError> {
        let mut prepared = Self {
            meshes: Vec::new(),
            solid: Vec::new(),
            glass: Vec::new(),
            spheres: Vec::new(),
            first_sphere: 0,
            strokes: Vec::new(),
        };
        for (object, item) in scene.objects.iter().enumerate() {
            match item {
                Object::Surface(surface) => {
                    check_surface(object, surface)?;
                    prepared.add_surface(surface, &scene.camera, frame);
                }
                Object::Curves(curves) => {
                    check_curves(object, curves)?;
                    prepared.add_curves(curves, object as u32, &scene.camera, frame);
                }
                Object::Spheres(spheres) => {
                    check_spheres(object, spheres)?;
                    prepared.add_spheres(spheres, &scene.camera, frame);
                }
            }
        }
        Ok(prepared)
    }

    fn add_surface(&mut self, surface: &Surface<'a>, camera: &Camera, frame: &Frame) {
        if surface.opacity <= 0.0 {
            return;
        }
        let mesh = Mesh::new(surface, camera, self.first_sphere);
        let chunks = surface.faces.par_chunks(CHUNK).enumerate();
        let parts: Vec<Vec<Triangle>> = chunks
            .map(|(chunk, faces)| {
                let mut triangles = Vec::with_capacity(faces.len());
                for face in chunk * CHUNK..chunk * CHUNK + faces.len() {
                    let id = mesh.first + face as u32;
                    triangles::add(mesh.corners_of(face), id, frame, &mut triangles);
                }
                triangles
            })
            .collect();
        let to = if surface.opacity < 1.0 {
            &mut self.glass
        } else {
            &mut self.solid
        };
        parts.iter().for_each(|part| to.extend_from_slice(part));
        self.first_sphere += surface.faces.len() as u32;
        self.meshes.push(mesh);
    }

    fn add_curves(&mut self, curves: &Curves<'_>, object: u32, camera: &Camera, frame: &Frame) {
        let ends = |segment: &[u32; 2]| {
            segment.map(|point| camera.to_view(&curves.points[point as usize]))
        };
        let strokes = curves
            .segments
            .iter()
            .filter_map(|segment| Stroke::new(ends(segment), curves, object, frame));
        self.strokes.extend(strokes);
    }

    fn add_spheres(&mut self, spheres: &Spheres<'_>, camera: &Camera, frame: &Frame) {
        let colour = spheres.colour.to_linear();
        let balls = spheres
            .centres
            .iter()
            .filter_map(|centre| Ball::new(camera.to_view(centre), spheres.radius, colour, frame));
        self.spheres.extend(balls);
    }

    /// Returns the surface that a number belongs to, and the face of it.
    pub(super) fn face(&self, id: u32) -> (&Mesh<'a>, usize) {
        let mesh = self.meshes.partition_point(|mesh| mesh.first <= id) - 1;
        let mesh = &self.meshes[mesh];
        (mesh, (id - mesh.first) as usize)
    }
}

fn check_surface(object: usize, surface: &Surface<'_>) -> Result<(), PictureError> {
    check_indices(object, surface.positions, surface.faces)?;
    check_option("opacity", surface.opacity, is_share, "from 0 to 1")?;
    let (vertices, faces) = (surface.positions.len(), surface.faces.len());
    if let Some(normals) = surface.normals {
        check_count(object, "normals", normals.len(), vertices)?;
    }
    let (what, found, expected) = match surface.paint {
        Paint::Uniform(_) => return Ok(()),
        Paint::Colours(colours) => ("colours of vertices", colours.len(), vertices),
        Paint::FaceColours(colours) => ("colours of faces", colours.len(), faces),
        Paint::Scalars { values, scale } => {
            scale.check()?;
            ("scalars", values.len(), vertices)
        }
        Paint::Checkers {
            corners, squares, ..
        } => {
            check_option("squares", squares, |_| true, "finite")?;
            ("texture corners", corners.len(), faces)
        }
    };
    check_count(object, what, found, expected)
}

fn check_count(
    object: usize,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), PictureError> {
    if found == expected {
        return Ok(());
    }
    Err(PictureError::WrongCount {
        object,
        what,
        expected,
        found,
    })
}

fn check_curves(object: usize, curves: &Curves<'_>) -> Result<(), PictureError> {
    check_indices(object, curves.points, curves.segments)?;
    check_option("opacity", curves.opacity, is_share, "from 0 to 1")?;
    let wanted = "from 0 to 1000 pixels";
    check_option(
        "width of curves",
        curves.width,
        |w| (0.0..=1e3).contains(&w),
        wanted,
    )
}

fn check_spheres(object: usize, spheres: &Spheres<'_>) -> Result<(), PictureError> {
    let (crate::Radius::World(radius) | crate::Radius::Pixels(radius)) = spheres.radius;
    check_option(
        "radius of spheres",
        radius,
        |r| r >= 0.0,
        "zero or positive",
    )?;
    let wrong = spheres.centres.iter().position(|point| !is_finite(point));
    wrong.map_or(Ok(()), |point| {
        Err(PictureError::NotFinite { object, point })
    })
}

fn check_indices<const N: usize>(
    object: usize,
    points: &[Point3<f64>],
    elements: &[[u32; N]],
) -> Result<(), PictureError> {
    for (element, corners) in elements.iter().enumerate() {
        for &point in corners {
            let Some(position) = points.get(point as usize) else {
                return Err(PictureError::IndexOutOfRange {
                    object,
                    element,
                    point,
                    points: points.len(),
                });
            };
            if !is_finite(position) {
                let point = point as usize;
                return Err(PictureError::NotFinite { object, point });
            }
        }
    }
    Ok(())
}

fn is_finite(point: &Point3<f64>) -> bool {
    point.iter().all(|coordinate| coordinate.is_finite())
}

fn is_share(value: f64) -> bool {
    (0.0..=1.0).contains(&value)
}

/// Returns the unit normals of the vertices: of the sum of their faces' normals, as long as twice
/// the faces' areas.
pub(super) fn vertex_normals(corners: &[Vector3<f64>], faces: &[[u32; 3]]) -> Vec<Vector3<f32>> {
    let mut sums = vec![Vector3::zeros(); corners.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| corners[vertex as usize]);
        let normal = (b - a).cross(&(c - a));
        for &vertex in face {
            sums[vertex as usize] += normal;
        }
    }
    let unit = |sum: &Vector3<f64>| sum.try_normalize(0.0).unwrap_or_default().cast();
    sums.iter().map(unit).collect()
}
