//! New vertices, and where they are due.

use msplines_common::evaluate::Order;
use msplines_common::mesh::{SurfacePoint, Topology};
use msplines_common::{Point3, Vector3};

use super::{flat, is_finite, turned};
use crate::domain::FlatDomain;
use crate::error::EditError;
use crate::spline::PowellSabinSpline;

/// Barycentric coordinates up to here are on the edge opposite to their corner.
const ON_EDGE: f64 = 1e-9;

/// A vertex to be inserted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewVertex {
    /// Where, inside of a face or on an edge.
    pub place: SurfacePoint,
    /// How far the surface is to move there.
    pub offset: Vector3<f64>,
    /// The normal of the surface there; nothing for the one it has.
    pub normal: Option<Vector3<f64>>,
}

/// What a new vertex of a refinement is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Its position.
    pub position: Point3<f64>,
    /// Its normal; nothing for the one that the surface has.
    pub normal: Option<Vector3<f64>>,
}

impl PowellSabinSpline {
    /// Returns the surface with one more vertex, the last one.
    ///
    /// It keeps value and gradient of the surface there, moved and turned as asked. Without a change
    /// the new surface differs only in faces whose split changes, and only where the old one is not a
    /// single quadratic there.
    ///
    /// # Reference
    /// [He2005] §3.4, Figure 6.
    ///
    /// # Errors
    /// A place that is no inner point of a face or edge, an offset that is not finite, or a normal that
    /// is no direction.
    pub fn with_vertex(&self, new: &NewVertex) -> Result<Self, EditError> {
        let vertex = self.flat_domain().mesh().vertex_count() as u32;
        let (position, gradient) = self.frame_at(new.place)?;
        let target = Target {
            position: position + new.offset,
            normal: new.normal,
        };
        let numbers = numbers(&target, gradient, vertex)?;
        let domain = self.domain_with(new.place, target.position)?;
        self.extended(domain, &[numbers])
    }

    /// Returns the surface with one more vertex in each of `faces`, at the incentre, in their order, and
    /// edges around flipped until they are Delaunay in the flat metric.
    ///
    /// `target` says position and normal of the new vertex at a point from what the surface has there.
    /// Gradients are those of the old surface, turned; see [`Self::faired`] for the next step.
    ///
    /// # Reference
    /// [He2005] §3.4.
    ///
    /// # Errors
    /// No such face, one that is named twice, or a target that is no place or direction.
    pub fn refined(
        &self,
        faces: &[u32],
        target: &mut dyn FnMut(SurfacePoint, Target) -> Target,
    ) -> Result<Self, EditError> {
        let first = self.flat_domain().mesh().vertex_count() as u32;
        let mut sorted = faces.to_vec();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(EditError::RepeatedFace { face: pair[0] });
        }
        let (mut places, mut rows) = (Vec::new(), Vec::new());
        for (vertex, &face) in (first..).zip(faces) {
            self.check_face(face)?;
            let at = self.macro_triangle(face).incentre();
            let place = SurfacePoint { face, at };
            let (position, gradient) = self.frame_at(place)?;
            let normal = super::tangent_normal(gradient);
            let asked = target(place, Target { position, normal });
            rows.push(numbers(&asked, gradient, vertex)?);
            places.push((face, at, asked.position));
        }
        let domain = self.flat_domain().with_vertices_in_faces(&places)?;
        let domain = domain.delaunay_around(first..first + faces.len() as u32)?;
        self.extended(domain, &rows)
    }

    /// Returns up to `count` faces that are farthest from a target, worst first: `closest` says the
    /// point of the target nearest to a point of the surface, which is asked for at six points per
    /// face.
    ///
    /// # Errors
    /// A spline that is not a surface.
    ///
    /// # Panics
    /// Never: the points are on the domain.
    pub fn worst_faces(
        &self,
        count: usize,
        closest: &mut dyn FnMut(&Point3<f64>) -> Point3<f64>,
    ) -> Result<Vec<u32>, EditError> {
        self.check_surface()?;
        let mut errors = Vec::new();
        for face in 0..self.flat_domain().mesh().face_count() as u32 {
            let triangle = self.macro_triangle(face);
            let middle = |micro: usize| {
                let corners = triangle.micro_corners(micro);
                let at = [0, 1, 2].map(|i| corners.iter().map(|c| c[i]).sum::<f64>() / 3.0);
                SurfacePoint { face, at }
            };
            let points = [0, 1, 2, 3, 4, 5].map(middle);
            let samples = self
                .evaluate_flat(&points, Order::Value)
                .expect("points of the face");
            let distance = |row: &[f64]| {
                let point = Point3::from_slice(row);
                (closest(&point) - point).norm()
            };
            let worst = samples
                .values
                .chunks_exact(3)
                .map(distance)
                .fold(0.0, f64::max);
            errors.push((worst, face));
        }
        errors.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        Ok(errors
            .into_iter()
            .take(count)
            .map(|(_, face)| face)
            .collect())
    }

    fn check_face(&self, face: u32) -> Result<(), EditError> {
        let faces = self.flat_domain().mesh().face_count();
        if (face as usize) < faces {
            Ok(())
        } else {
            Err(EditError::NoSuchFace { face, faces })
        }
    }

    /// Returns position and flat derivatives at a point.
    fn frame_at(&self, place: SurfacePoint) -> Result<(Point3<f64>, [Vector3<f64>; 2]), EditError> {
        self.check_surface()?;
        self.check_face(place.face)?;
        let outside = |_| EditError::Place {
            face: place.face,
            at: place.at,
        };
        let samples = self
            .evaluate_flat(&[place], Order::First)
            .map_err(outside)?;
        let derivative = |at: usize| Vector3::from_column_slice(&samples.first[at..at + 3]);
        let position = Point3::from_slice(&samples.values);
        Ok((position, [derivative(0), derivative(3)]))
    }

    /// Returns the domain with a vertex inside of a face or on an edge.
    fn domain_with(
        &self,
        SurfacePoint { face, at }: SurfacePoint,
        position: Point3<f64>,
    ) -> Result<FlatDomain, EditError> {
        let small: Vec<u32> = (0..3).filter(|&i| at[i as usize] <= ON_EDGE).collect();
        match small[..] {
            [] => Ok(self
                .flat_domain()
                .with_vertices_in_faces(&[(face, at, position)])?),
            [opposite] => {
                let h = Topology::next(3 * face + opposite);
                let (tail, head) = ((h % 3) as usize, (Topology::next(h) % 3) as usize);
                let share = at[head] / (at[tail] + at[head]);
                Ok(self.flat_domain().with_vertex_on_edge(h, share, position)?)
            }
            _ => Err(EditError::Place { face, at }),
        }
    }

    /// Returns the spline over a domain with more vertices.
    fn extended(&self, domain: FlatDomain, rows: &[[f64; 9]]) -> Result<Self, EditError> {
        let (_, mut values, mut gradients) = self.clone().into_parts();
        for row in rows {
            values.extend(&row[..3]);
            gradients.extend(&row[3..]);
        }
        Ok(Self::from_parts(domain, 3, values, gradients)?)
    }
}

/// Returns value and derivatives of a new vertex.
fn numbers(
    target: &Target,
    gradient: [Vector3<f64>; 2],
    vertex: u32,
) -> Result<[f64; 9], EditError> {
    if !is_finite(&target.position) {
        return Err(EditError::Value { vertex });
    }
    let gradient = match &target.normal {
        Some(normal) => turned(gradient, normal, vertex)?,
        None => gradient,
    };
    let mut numbers = [0.0; 9];
    numbers[..3].copy_from_slice(target.position.coords.as_slice());
    numbers[3..].copy_from_slice(&flat(gradient));
    Ok(numbers)
}
