//! A manifold surface as a value: charts, functions, and their blend.

use std::collections::BTreeMap;
use std::sync::Arc;

use msplines_common::Point3;
use msplines_common::evaluate::{
    Domain as EvaluationDomain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline,
};
use msplines_common::mesh::SurfacePoint;
use msplines_common::mesh::polygon::PolygonMesh;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::dictionary::{Atom, DEGREE, Dictionary, DictionaryKind};
use crate::domain::{Domain, TURNS, corner_coordinates};
use crate::error::SplineError;
use crate::fit::charts::{COMPONENTS, Function, default_degree};
use crate::fit::{MOST_VALENCE, first_crowded};
use crate::jet::Jet;
use crate::weight::{FLAT, weight};

/// Points evaluated together.
const BLOCK: usize = 256;

/// How far coordinates may leave the unit square by rounding.
const OUTSIDE: f64 = 1e-9;

/// Where a chart has kinks through its centre, differential geometry is taken this far inside.
const NEAR_CENTRE: f64 = 1e-4;

/// A blend `Σ w_j q_j` of functions on the charts of a quad mesh.
///
/// Smooth to any order where charts have no shape functions; with them it is continuous everywhere,
/// and smooth inside of the faces.
///
/// # Reference
/// [Wang2016] Eq. (1), Eq. (2).
#[derive(Clone, Debug)]
pub struct SparseManifold {
    mesh: PolygonMesh,
    domain: Arc<Domain>,
    made_of: (DictionaryKind, Option<u32>),
    dictionaries: Vec<Arc<Dictionary>>,
    functions: Vec<Function>,
}

/// Position, normal and curvature at a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Position.
    pub position: Point3<f64>,
    /// Unit normal, to the side from which faces run counter-clockwise; zero where the surface has
    /// no tangent plane.
    pub normal: Vector3<f64>,
    /// Mean curvature: positive where the surface bends towards the normal.
    pub mean_curvature: f64,
    /// Gaussian curvature.
    pub gaussian_curvature: f64,
}

impl SparseManifold {
    pub(crate) fn new(
        mesh: &PolygonMesh,
        domain: Domain,
        kind: DictionaryKind,
        degree: Option<u32>,
        functions: Vec<Function>,
    ) -> Self {
        let mut known = BTreeMap::new();
        let dictionaries = domain.stars().iter().map(|&star| {
            let degree = degree.unwrap_or_else(|| default_degree(star));
            let build = || Arc::new(Dictionary::new(kind, degree, star));
            Arc::clone(known.entry(star).or_insert_with(build))
        });
        Self {
            mesh: mesh.clone(),
            dictionaries: dictionaries.collect(),
            domain: Arc::new(domain),
            made_of: (kind, degree),
            functions,
        }
    }

    /// Returns the surface of stored charts: of every vertex the numbers of its atoms and their
    /// coefficients, `[atom][coordinate]`.
    ///
    /// `degree` is that of the monomials; absent, it depends on the valence, as in
    /// [`Local::Polynomial`](crate::Local::Polynomial).
    ///
    /// # Errors
    /// A mesh that is not of quads or has a vertex of too many faces; a degree out of range; charts, atoms or
    /// coefficients that do not fit it.
    pub fn from_parts(
        mesh: &PolygonMesh,
        kind: DictionaryKind,
        degree: Option<u32>,
        charts: Vec<(Vec<u16>, Vec<f64>)>,
    ) -> Result<Self, SplineError> {
        mesh.check_quads()?;
        if let Some(degree) = degree.filter(|&degree| degree > DEGREE) {
            return Err(SplineError::Degree { degree });
        }
        if let Some((vertex, valence)) = first_crowded(mesh) {
            return Err(SplineError::Valence {
                vertex,
                valence,
                most: MOST_VALENCE,
            });
        }
        let (found, expected) = (charts.len(), mesh.vertex_count());
        if found != expected {
            return Err(SplineError::Charts { found, expected });
        }
        if let Some(degree) = degree.filter(|&degree| degree > DEGREE) {
            return Err(SplineError::Degree { degree });
        }
        let functions = charts.into_iter().map(|(support, coefficients)| Function {
            support,
            coefficients,
        });
        let domain = Domain::build(mesh.topology());
        let spline = Self::new(mesh, domain, kind, degree, functions.collect());
        for (chart, function) in spline.functions.iter().enumerate() {
            let atoms = spline.dictionaries[chart].atoms().len();
            let known = function
                .support
                .iter()
                .all(|&atom| usize::from(atom) < atoms);
            let whole = function.coefficients.len() == COMPONENTS * function.support.len();
            if !known || !whole || function.coefficients.iter().any(|c| !c.is_finite()) {
                return Err(SplineError::Chart { chart, atoms });
            }
        }
        Ok(spline)
    }

    /// Returns the control mesh, whose faces address the points of the surface.
    #[must_use]
    pub fn mesh(&self) -> &PolygonMesh {
        &self.mesh
    }

    /// Returns the kind of its dictionaries, and the degree of their monomials; absent, that depends on
    /// the valence.
    #[must_use]
    pub fn made_of(&self) -> (DictionaryKind, Option<u32>) {
        self.made_of
    }

    /// Returns the charts.
    #[must_use]
    pub fn manifold(&self) -> &Domain {
        &self.domain
    }

    /// Returns the atoms of a chart that are used, and their coefficients, `[atom][coordinate]`.
    #[must_use]
    pub fn chart(&self, chart: u32) -> (&[u16], &[f64]) {
        let function = &self.functions[chart as usize];
        (&function.support, &function.coefficients)
    }

    /// Returns the functions that a chart may be made of.
    #[must_use]
    pub fn dictionary(&self, chart: u32) -> &Dictionary {
        &self.dictionaries[chart as usize]
    }

    /// Returns the number of coefficients that are not zero.
    #[must_use]
    pub fn coefficient_count(&self) -> usize {
        let coefficients = self.functions.iter().flat_map(|f| &f.coefficients);
        coefficients.filter(|c| **c != 0.0).count()
    }

    pub(crate) fn dictionaries(&self) -> &[Arc<Dictionary>] {
        &self.dictionaries
    }

    pub(crate) fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// Returns whether a chart has kinks inside.
    fn has_kinks(&self, chart: u32) -> bool {
        let atoms = self.dictionaries[chart as usize].atoms();
        let mut support = self.functions[chart as usize].support.iter();
        support.any(|&atom| atoms[usize::from(atom)].is_shape())
    }

    /// Returns the surface at a point, by the coordinates of one corner of its face.
    fn jets(&self, face: u32, at: [f64; 2], frame: u32, derivatives: bool) -> [Jet; COMPONENTS] {
        let mut sum = [Jet::default(); COMPONENTS];
        for corner in 0..4 {
            let uv = corner_coordinates(corner, at);
            let [wu, wv] = uv.map(weight);
            if wu[0] * wv[0] == 0.0 {
                continue;
            }
            let h = 4 * face + corner;
            let chart = self.mesh.topology().origin(h);
            let blend = Jet::of_product(wu, wv);
            let local = self.local_jets(chart, self.domain.sector(h), uv, derivatives);
            let rows = TURNS[((4 + corner - frame) % 4) as usize];
            for (sum, jet) in sum.iter_mut().zip(local) {
                *sum = *sum + blend.times(&jet).turned(rows);
            }
        }
        sum
    }

    /// Returns the function of a chart by the corner coordinates of a sector.
    fn local_jets(
        &self,
        chart: u32,
        sector: u32,
        at: [f64; 2],
        derivatives: bool,
    ) -> [Jet; COMPONENTS] {
        let dictionary = &self.dictionaries[chart as usize];
        let place = dictionary.place(sector, at, derivatives);
        self.combined(chart, |atom| place.jet(atom))
    }

    /// Returns the function of a smooth chart by its scaled coordinates.
    fn plane_jets(&self, chart: u32, sector: u32, at: [f64; 2]) -> [Jet; COMPONENTS] {
        let place = self.dictionaries[chart as usize].place(sector, at, false);
        self.combined(chart, |atom| place.plane_jet(atom))
    }

    fn combined(&self, chart: u32, jet: impl Fn(Atom) -> Jet) -> [Jet; COMPONENTS] {
        let function = &self.functions[chart as usize];
        let atoms = self.dictionaries[chart as usize].atoms();
        let mut sum = [Jet::default(); COMPONENTS];
        let terms = function
            .support
            .iter()
            .zip(function.coefficients.chunks_exact(COMPONENTS));
        for (&atom, coefficients) in terms {
            let jet = jet(atoms[usize::from(atom)]);
            for (sum, &c) in sum.iter_mut().zip(coefficients) {
                *sum = *sum + jet * c;
            }
        }
        sum
    }

    /// Returns the position of a point of a face.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn position(&self, face: u32, at: [f64; 2]) -> Point3<f64> {
        Point3::from(self.jets(face, at, 0, false).map(|jet| jet.value))
    }

    /// Returns position, normal and curvature at points.
    ///
    /// They are exact, from derivatives by the coordinates of the nearest chart, also at extraordinary
    /// vertices. On a crease they are those of the side of the point's face.
    ///
    /// # Errors
    /// A point outside of the mesh.
    pub fn geometry(&self, points: &[SurfacePoint]) -> Result<Vec<Geometry>, EvaluateError> {
        self.check(points)?;
        Ok(points
            .par_iter()
            .with_min_len(BLOCK)
            .map(|point| self.geometry_at(point.face, [point.at[0], point.at[1]]))
            .collect())
    }

    fn geometry_at(&self, face: u32, at: [f64; 2]) -> Geometry {
        let corner = match at.map(|c| c > 0.5) {
            [false, false] => 0,
            [true, false] => 1,
            [true, true] => 2,
            [false, true] => 3,
        };
        let uv = corner_coordinates(corner, at);
        let h = 4 * face + corner;
        let chart = self.mesh.topology().origin(h);
        let alone = uv.iter().all(|&c| c <= FLAT);
        if alone && !self.has_kinks(chart) {
            return Geometry::of(&self.plane_jets(chart, self.domain.sector(h), uv));
        }
        let centre = uv.iter().all(|&c| c < NEAR_CENTRE);
        let near = if centre { [NEAR_CENTRE; 2] } else { uv };
        let shifted = crate::domain::face_coordinates(corner, near);
        let mut geometry = Geometry::of(&self.jets(face, shifted, corner, true));
        geometry.position = self.position(face, at);
        geometry
    }

    fn check(&self, points: &[SurfacePoint]) -> Result<(), EvaluateError> {
        let faces = self.mesh.face_count();
        for (index, point) in points.iter().enumerate() {
            let face = point.face;
            if face as usize >= faces {
                let point = index;
                return Err(EvaluateError::NoSuchFace { point, face, faces });
            }
            let inside = |c: &f64| (-OUTSIDE..=1.0 + OUTSIDE).contains(c);
            if !point.at[..2].iter().all(inside) {
                let point = index;
                return Err(EvaluateError::OutsideFace { point, face });
            }
        }
        Ok(())
    }

    /// Finds points at which derivatives by face coordinates do not exist: extraordinary vertices.
    fn check_derivatives(&self, points: &[SurfacePoint]) -> Result<(), EvaluateError> {
        for (index, point) in points.iter().enumerate() {
            for corner in 0..4 {
                let uv = corner_coordinates(corner, [point.at[0], point.at[1]]);
                let vertex = self.mesh.topology().origin(4 * point.face + corner);
                let star = self.domain.stars()[vertex as usize];
                if uv == [0.0, 0.0] && star.valence != 4 {
                    let (point, face) = (index, point.face);
                    return Err(EvaluateError::NoDerivative {
                        point,
                        face,
                        vertex,
                    });
                }
            }
        }
        Ok(())
    }
}

impl Geometry {
    /// Returns the geometry of a parameterisation.
    fn of(jets: &[Jet; COMPONENTS]) -> Self {
        let vector = |pick: fn(&Jet) -> f64| Vector3::from([0, 1, 2].map(|i| pick(&jets[i])));
        let position = Point3::from(vector(|j| j.value));
        let (u, v) = (vector(|j| j.first[0]), vector(|j| j.first[1]));
        let area = u.cross(&v);
        let Some(normal) = area.try_normalize(f64::MIN_POSITIVE) else {
            return Self {
                position,
                normal: Vector3::zeros(),
                mean_curvature: 0.0,
                gaussian_curvature: 0.0,
            };
        };
        let (e, f, g) = (u.dot(&u), u.dot(&v), v.dot(&v));
        let l = vector(|j| j.second[0]).dot(&normal);
        let m = vector(|j| j.second[1]).dot(&normal);
        let n = vector(|j| j.second[2]).dot(&normal);
        let determinant = area.norm_squared();
        Self {
            position,
            normal,
            mean_curvature: (e * n - 2.0 * f * m + g * l) / (2.0 * determinant),
            gaussian_curvature: (l * n - m * m) / determinant,
        }
    }
}

impl SurfaceSpline for SparseManifold {
    fn domain(&self) -> EvaluationDomain<'_> {
        EvaluationDomain::Quads(&self.mesh)
    }

    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        self.check(points)?;
        if order > Order::Value {
            self.check_derivatives(points)?;
        }
        Ok(Box::new(Prepared {
            spline: self,
            points: points.to_vec(),
            order,
        }))
    }
}

/// Points and how much is asked about them.
struct Prepared<'a> {
    spline: &'a SparseManifold,
    points: Vec<SurfacePoint>,
    order: Order,
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        let derivatives = self.order > Order::Value;
        let jets: Vec<[Jet; COMPONENTS]> = self
            .points
            .par_iter()
            .with_min_len(BLOCK)
            .map(|p| self.spline.jets(p.face, [p.at[0], p.at[1]], 0, derivatives))
            .collect();
        out.dimension = COMPONENTS;
        out.values.clear();
        out.first.clear();
        out.second.clear();
        for jets in jets {
            out.values.extend(jets.map(|jet| jet.value));
            if self.order >= Order::First {
                (0..2).for_each(|i| out.first.extend(jets.map(|jet| jet.first[i])));
            }
            if self.order >= Order::Second {
                (0..3).for_each(|i| out.second.extend(jets.map(|jet| jet.second[i])));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the jets of a sphere of radius 2 by longitude and latitude.
    fn sphere(u: f64, v: f64) -> [Jet; COMPONENTS] {
        let wave = |x: f64| [2.0 * x.cos(), -2.0 * x.sin(), -2.0 * x.cos()];
        let sine = |x: f64| [x.sin(), x.cos(), -x.sin()];
        let cosine = |x: f64| [x.cos(), -x.sin(), -x.cos()];
        let height = [2.0 * v.sin(), 2.0 * v.cos(), -2.0 * v.sin()];
        [
            Jet::of_product(cosine(u), wave(v)),
            Jet::of_product(sine(u), wave(v)),
            Jet::of_product([1.0, 0.0, 0.0], height),
        ]
    }

    #[test]
    fn a_sphere_bends_away_from_its_outer_normal_everywhere_alike() {
        for (u, v) in [(0.0, 0.0), (1.2, 0.7), (-2.0, -1.1)] {
            let geometry = Geometry::of(&sphere(u, v));
            assert!((geometry.normal * 2.0 - geometry.position.coords).norm() < 1e-14);
            assert!((geometry.mean_curvature + 0.5).abs() < 1e-14);
            assert!((geometry.gaussian_curvature - 0.25).abs() < 1e-14);
        }
    }

    #[test]
    fn a_saddle_has_no_mean_curvature_in_its_middle() {
        let flat = |first: [f64; 2]| Jet {
            first,
            ..Jet::default()
        };
        let height = Jet {
            second: [1.0, 0.0, -1.0],
            ..Jet::default()
        };
        let geometry = Geometry::of(&[flat([1.0, 0.0]), flat([0.0, 1.0]), height]);
        assert_eq!(
            (geometry.mean_curvature, geometry.gaussian_curvature),
            (0.0, -1.0)
        );
    }

    #[test]
    fn no_tangent_plane_is_no_normal() {
        assert_eq!(Geometry::of(&[Jet::default(); 3]).normal, Vector3::zeros());
    }
}
