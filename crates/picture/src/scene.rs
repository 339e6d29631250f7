//! What a picture shows: surfaces, curves and spheres, and how they are painted.

use nalgebra::{Point3, Vector3};

use crate::colour_map::ColourScale;
use crate::{Camera, Drawing, Image, PictureError, Rgb};

/// How the faces of a surface are coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint<'a> {
    /// One colour.
    Uniform(Rgb),
    /// A colour per vertex, mixed in linear light.
    Colours(&'a [Rgb]),
    /// A colour per face, such as one per chart.
    FaceColours(&'a [Rgb]),
    /// A number per vertex. The number is interpolated and then looked up, so that the colours
    /// between are the scale's own; a face with a NaN is grey.
    Scalars {
        /// One per vertex.
        values: &'a [f64],
        /// What the numbers look like.
        scale: ColourScale,
    },
    /// A checkerboard in texture coordinates, which shows how a map distorts.
    Checkers {
        /// Texture coordinates of the three corners of each face.
        corners: &'a [[[f64; 2]; 3]],
        /// Squares along a unit of texture.
        squares: f64,
        /// Colours of the two kinds of square.
        colours: [Rgb; 2],
    },
}

/// How the normal of a surface varies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// Normals of vertices, the mean of their faces weighted by area, interpolated.
    #[default]
    Smooth,
    /// One normal per face.
    Flat,
}

/// A triangle mesh to be drawn.
///
/// Both sides of a face are drawn. The side from which its vertices run counter-clockwise has the
/// paint's colour, the other a darker and warmer one, so that one sees where a hole lets look
/// inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<'a> {
    pub(crate) positions: &'a [Point3<f64>],
    pub(crate) faces: &'a [[u32; 3]],
    pub(crate) paint: Paint<'a>,
    pub(crate) shading: Shading,
    pub(crate) normals: Option<&'a [Vector3<f64>]>,
    pub(crate) opacity: f64,
}

impl<'a> Surface<'a> {
    /// Returns a smooth, opaque surface the colour of clay; the faces index the positions.
    #[must_use]
    pub fn new(positions: &'a [Point3<f64>], faces: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            faces,
            paint: Paint::Uniform(Rgb::CLAY),
            shading: Shading::Smooth,
            normals: None,
            opacity: 1.0,
        }
    }

    /// Returns the surface with these unit normals at its vertices in place of the means of its faces,
    /// for a surface whose own are known; of smooth shading only.
    #[must_use]
    pub fn normals(self, normals: &'a [Vector3<f64>]) -> Self {
        let normals = Some(normals);
        Self { normals, ..self }
    }

    /// Returns the surface with this paint.
    #[must_use]
    pub fn paint(self, paint: Paint<'a>) -> Self {
        Self { paint, ..self }
    }

    /// Returns the surface with this shading.
    #[must_use]
    pub fn shading(self, shading: Shading) -> Self {
        Self { shading, ..self }
    }

    /// Returns the surface with an opacity in 0..=1; below 1 what is behind shines through, from
    /// the farthest layer to the nearest.
    #[must_use]
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Line segments to be drawn: edges of a mesh, curves on a surface, sides of a control polygon.
///
/// A curve on a surface is seen where the surface is; the camera looks for it slightly nearer
/// (see [`Drawing::bias`]). Its colour is not shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curves<'a> {
    pub(crate) points: &'a [Point3<f64>],
    pub(crate) segments: &'a [[u32; 2]],
    pub(crate) width: f64,
    pub(crate) colour: Rgb,
    pub(crate) opacity: f64,
}

impl<'a> Curves<'a> {
    /// Returns segments 1.5 pixels wide in the colour of ink; they index the points.
    #[must_use]
    pub fn new(points: &'a [Point3<f64>], segments: &'a [[u32; 2]]) -> Self {
        Self {
            points,
            segments,
            width: 1.5,
            colour: Rgb::INK,
            opacity: 1.0,
        }
    }

    /// Returns the curves with this width in pixels of the picture.
    #[must_use]
    pub fn width(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// Returns the curves in this colour.
    #[must_use]
    pub fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }

    /// Returns the curves with an opacity in 0..=1: faint edges under other content.
    #[must_use]
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Size of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// In the unit of the positions; far ones look smaller.
    World(f64),
    /// In pixels of the picture; all look alike, as marks on a map do.
    Pixels(f64),
}

/// Shaded spheres: knots, control points.
///
/// A sphere that holds the eye is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spheres<'a> {
    pub(crate) centres: &'a [Point3<f64>],
    pub(crate) radius: Radius,
    pub(crate) colour: Rgb,
}

impl<'a> Spheres<'a> {
    /// Returns spheres of 5 pixels' radius in blue.
    #[must_use]
    pub fn new(centres: &'a [Point3<f64>]) -> Self {
        Self {
            centres,
            radius: Radius::Pixels(5.0),
            colour: Rgb::BLUE,
        }
    }

    /// Returns the spheres with this radius.
    #[must_use]
    pub fn radius(self, radius: Radius) -> Self {
        Self { radius, ..self }
    }

    /// Returns the spheres in this colour.
    #[must_use]
    pub fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }
}

/// Anything that a scene holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Object<'a> {
    /// A triangle mesh.
    Surface(Surface<'a>),
    /// Line segments.
    Curves(Curves<'a>),
    /// Spheres.
    Spheres(Spheres<'a>),
}

impl<'a> From<Surface<'a>> for Object<'a> {
    fn from(surface: Surface<'a>) -> Self {
        Self::Surface(surface)
    }
}

impl<'a> From<Curves<'a>> for Object<'a> {
    fn from(curves: Curves<'a>) -> Self {
        Self::Curves(curves)
    }
}

impl<'a> From<Spheres<'a>> for Object<'a> {
    fn from(spheres: Spheres<'a>) -> Self {
        Self::Spheres(spheres)
    }
}

/// A camera and what it sees. The objects borrow their positions and indices.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene<'a> {
    pub(crate) camera: Camera,
    pub(crate) objects: Vec<Object<'a>>,
}

impl<'a> Scene<'a> {
    /// Returns a scene with nothing in it.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            objects: Vec::new(),
        }
    }

    /// Adds an object. The order matters for errors only, which number the objects.
    pub fn add(&mut self, object: impl Into<Object<'a>>) -> &mut Self {
        self.objects.push(object.into());
        self
    }

    /// Returns the picture of the scene.
    ///
    /// Time grows with the faces and with the samples (pixels times `samples` squared); memory with
    /// 8 bytes a sample and 40 a face in sight. The work is split into bands of rows over rayon's
    /// threads, and the bytes do not depend on how many there are.
    ///
    /// # Errors
    /// If the picture is empty or too large, an index has no position, a position in use is not
    /// finite, a paint has not one value for each vertex or face, or an option makes no sense.
    pub fn draw(&self, drawing: &Drawing) -> Result<Image, PictureError> {
        crate::draw::draw(self, drawing)
    }

    /// Returns where a point appears in a picture, in pixels from its upper left corner, whether
    /// or not something hides it; `None` behind the camera.
    #[must_use]
    pub fn pixel(&self, point: &Point3<f64>, drawing: &Drawing) -> Option<[f64; 2]> {
        crate::draw::pixel(self, point, drawing)
    }
}

/// Returns the edges of faces, each once with the smaller index first, in increasing order.
#[must_use]
pub fn edges(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use super::edges;

    #[test]
    fn two_faces_share_an_edge() {
        let edges = edges(&[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
    }
}
