//! From a shell of Bézier patches to STEP: ISO 10303-21 in the schema of AP214, `AUTOMOTIVE_DESIGN`.
//!
//! Patches are `B_SPLINE_SURFACE_WITH_KNOTS` and their edges `B_SPLINE_CURVE_WITH_KNOTS` of one span,
//! rational where there are weights. Every edge is one `EDGE_CURVE`, which the faces at it share. Curves
//! in the parameters of patches are left to readers.

mod part21;

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use msplines_common::bspline::{BezierEdge, BezierFace, BezierShell, ShellComponent};
use nalgebra::{Point3, Vector3};

use self::part21::{Entities, Id, Knots, List, Real, Rows};
use crate::WriteError;
use crate::format::extension;
use crate::output::write_atomically;

/// The accuracy that a file claims where vertices agree with curves exactly, as a part of the
/// diagonal of the control points: well above rounding, and below what programs for design resolve.
const ACCURACY: f64 = 1e-9;

/// Writes a shell as STEP, named `.step` or `.stp`.
///
/// If all of it is closed, each piece that hangs together is a solid, a `MANIFOLD_SOLID_BREP`;
/// otherwise it is a `SHELL_BASED_SURFACE_MODEL` of one shell for each piece. Coordinates are
/// millimetres, the unit of numbers that have none. The accuracy told is the tolerance of the shell, or
/// a billionth of its diagonal if that is more.
///
/// The file is written beside `path` and renamed; on an error nothing is left behind. The same shell
/// gives the same bytes, without a date, and numbers come back exactly. Points that are equal are
/// written once. Memory is that of the points' numbers in the file.
///
/// # Reference
/// ISO 10303-21 (the text), ISO 10303-42 (geometry and topology), ISO 10303-214 (the schema).
///
/// # Errors
/// The extension is neither `.step` nor `.stp`, or the file cannot be written.
pub fn write_step(path: &Path, shell: &BezierShell) -> Result<(), WriteError> {
    match extension(path).as_deref() {
        Some("step" | "stp") => write_atomically(path, |to| write(shell, to)),
        _ => Err(WriteError::StepFormat {
            path: path.to_owned(),
        }),
    }
}

const START: &str = "ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('surface of Bezier patches'),'2;1');
FILE_NAME('','1970-01-01T00:00:00',('Manifold Splines'),('Manifold Splines'),'Manifold Splines',\
'Manifold Splines','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
";
const END: &str = "ENDSEC;\nEND-ISO-10303-21;\n";

fn write(shell: &BezierShell, to: &mut dyn Write) -> io::Result<()> {
    to.write_all(START.as_bytes())?;
    let mut file = Writer {
        to: Entities::of(to),
        points: BTreeMap::new(),
    };
    let vertices = file.vertices(shell)?;
    let edges = file.edges(shell, &vertices)?;
    let faces = file.faces(shell, &edges)?;
    let components = shell.components();
    let is_solid = components.iter().all(|component| component.is_closed);
    let shells = file.shells(&components, &faces)?;
    let items = if is_solid {
        let solids = shells.iter();
        solids
            .map(|shell| file.to.add(format_args!("MANIFOLD_SOLID_BREP('',{shell})")))
            .collect::<io::Result<_>>()?
    } else {
        let shells = List(&shells);
        vec![
            file.to
                .add(format_args!("SHELL_BASED_SURFACE_MODEL('',{shells})"))?,
        ]
    };
    let context = file.context(accuracy(shell))?;
    let items = List(&items);
    let kind = if is_solid {
        "ADVANCED_BREP_SHAPE_REPRESENTATION"
    } else {
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION"
    };
    let representation = file.to.add(format_args!("{kind}('',{items},{context})"))?;
    file.product(representation)?;
    to.write_all(END.as_bytes())
}

/// Returns the accuracy that the file claims, which is positive.
fn accuracy(shell: &BezierShell) -> f64 {
    let points = shell.faces().iter().flat_map(|face| &face.points);
    let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
    let [low, high] = points.fold(start, |[low, high], p| {
        [low.inf(&p.coords), high.sup(&p.coords)]
    });
    // Half of each first: the difference of finite numbers may not be finite.
    let diagonal = (high / 2.0 - low / 2.0).norm() * 2.0;
    let least = (diagonal * ACCURACY).clamp(f64::MIN_POSITIVE, f64::MAX);
    shell.tolerance().max(least)
}

/// A file under way.
struct Writer<'a> {
    to: Entities<'a>,
    /// Points that are there, by their bits.
    points: BTreeMap<[u64; 3], Id>,
}

impl Writer<'_> {
    fn point(&mut self, point: &Point3<f64>) -> io::Result<Id> {
        let bits = [point.x, point.y, point.z].map(f64::to_bits);
        if let Some(&id) = self.points.get(&bits) {
            return Ok(id);
        }
        let place = List(&[point.x, point.y, point.z].map(Real));
        let id = self.to.add(format_args!("CARTESIAN_POINT('',{place})"))?;
        self.points.insert(bits, id);
        Ok(id)
    }

    fn points(&mut self, points: &[Point3<f64>]) -> io::Result<Vec<Id>> {
        points.iter().map(|point| self.point(point)).collect()
    }

    fn vertices(&mut self, shell: &BezierShell) -> io::Result<Vec<Id>> {
        let vertices = shell.vertices().iter();
        vertices
            .map(|vertex| {
                let point = self.point(vertex)?;
                self.to.add(format_args!("VERTEX_POINT('',{point})"))
            })
            .collect()
    }

    fn edges(&mut self, shell: &BezierShell, vertices: &[Id]) -> io::Result<Vec<Id>> {
        let edges = shell.edges().iter();
        edges
            .map(|edge| {
                let curve = self.curve(edge)?;
                let [start, end] = edge.ends.map(|vertex| vertices[vertex as usize]);
                self.to
                    .add(format_args!("EDGE_CURVE('',{start},{end},{curve},.T.)"))
            })
            .collect()
    }

    fn curve(&mut self, edge: &BezierEdge) -> io::Result<Id> {
        let points = self.points(&edge.curve.points)?;
        let degree = points.len() - 1;
        let (points, knots) = (List(&points), Knots(degree));
        let Some(weights) = &edge.curve.weights else {
            return self.to.add(format_args!(
                "B_SPLINE_CURVE_WITH_KNOTS('',{degree},{points},.UNSPECIFIED.,.U.,.U.,\
                 {knots},(0.,1.),.UNSPECIFIED.)"
            ));
        };
        let weights: Vec<Real> = weights.iter().copied().map(Real).collect();
        let weights = List(&weights);
        self.to.add(format_args!(
            "(BOUNDED_CURVE()\
             B_SPLINE_CURVE({degree},{points},.UNSPECIFIED.,.U.,.U.)\
             B_SPLINE_CURVE_WITH_KNOTS({knots},(0.,1.),.UNSPECIFIED.)\
             CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({weights})\
             REPRESENTATION_ITEM(''))"
        ))
    }

    fn faces(&mut self, shell: &BezierShell, edges: &[Id]) -> io::Result<Vec<Id>> {
        let faces = shell.faces().iter();
        faces.map(|face| self.face(face, edges)).collect()
    }

    fn face(&mut self, face: &BezierFace, edges: &[Id]) -> io::Result<Id> {
        let surface = self.surface(face)?;
        let around = face.boundary.iter();
        let around: Vec<Id> = around
            .map(|used| {
                let edge = edges[used.edge as usize];
                let along = if used.reversed { ".F." } else { ".T." };
                self.to
                    .add(format_args!("ORIENTED_EDGE('',*,*,{edge},{along})"))
            })
            .collect::<io::Result<_>>()?;
        let around = List(&around);
        let way = self.to.add(format_args!("EDGE_LOOP('',{around})"))?;
        let bound = self
            .to
            .add(format_args!("FACE_OUTER_BOUND('',{way},.T.)"))?;
        self.to
            .add(format_args!("ADVANCED_FACE('',({bound}),{surface},.T.)"))
    }

    fn surface(&mut self, face: &BezierFace) -> io::Result<Id> {
        let [a, b] = face.degree;
        // A row has one first index; the second one runs along it.
        let points = by_rows(&self.points(&face.points)?, face.degree);
        let points = Rows(&points, b + 1);
        let (first, second) = (Knots(a), Knots(b));
        let Some(weights) = &face.weights else {
            return self.to.add(format_args!(
                "B_SPLINE_SURFACE_WITH_KNOTS('',{a},{b},{points},.UNSPECIFIED.,.U.,.U.,.U.,\
                 {first},{second},(0.,1.),(0.,1.),.UNSPECIFIED.)"
            ));
        };
        let weights: Vec<Real> = weights.iter().copied().map(Real).collect();
        let weights = by_rows(&weights, face.degree);
        let weights = Rows(&weights, b + 1);
        self.to.add(format_args!(
            "(BOUNDED_SURFACE()\
             B_SPLINE_SURFACE({a},{b},{points},.UNSPECIFIED.,.U.,.U.,.U.)\
             B_SPLINE_SURFACE_WITH_KNOTS({first},{second},(0.,1.),(0.,1.),.UNSPECIFIED.)\
             GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE({weights})\
             REPRESENTATION_ITEM('')SURFACE())"
        ))
    }

    fn shells(&mut self, components: &[ShellComponent], faces: &[Id]) -> io::Result<Vec<Id>> {
        let components = components.iter();
        components
            .map(|component| {
                let own = component.faces.iter();
                let own: Vec<Id> = own.map(|&face| faces[face as usize]).collect();
                let faces = List(&own);
                let kind = if component.is_closed {
                    "CLOSED_SHELL"
                } else {
                    "OPEN_SHELL"
                };
                self.to.add(format_args!("{kind}('',{faces})"))
            })
            .collect()
    }

    /// Adds units and accuracy.
    fn context(&mut self, accuracy: f64) -> io::Result<Id> {
        let to = &mut self.to;
        let length = to.add(format_args!(
            "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"
        ))?;
        let angle = to.add(format_args!(
            "(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))"
        ))?;
        let solid_angle = to.add(format_args!(
            "(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())"
        ))?;
        let accuracy = Real(accuracy);
        let uncertainty = to.add(format_args!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({accuracy}),{length},\
             'distance_accuracy_value','greatest distance of vertices, edges and faces that meet')"
        ))?;
        to.add(format_args!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)\
             GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))\
             REPRESENTATION_CONTEXT('','3D'))"
        ))
    }

    /// Adds the product whose shape the representation is; readers start from it.
    fn product(&mut self, representation: Id) -> io::Result<()> {
        let to = &mut self.to;
        let application = to.add(format_args!(
            "APPLICATION_CONTEXT('core data for automotive mechanical design processes')"
        ))?;
        to.add(format_args!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,\
             {application})"
        ))?;
        let context = to.add(format_args!(
            "PRODUCT_CONTEXT('',{application},'mechanical')"
        ))?;
        let product = to.add(format_args!("PRODUCT('surface','surface','',({context}))"))?;
        to.add(format_args!(
            "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"
        ))?;
        let formation = to.add(format_args!(
            "PRODUCT_DEFINITION_FORMATION('','',{product})"
        ))?;
        let context = to.add(format_args!(
            "PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"
        ))?;
        let definition = to.add(format_args!(
            "PRODUCT_DEFINITION('design','',{formation},{context})"
        ))?;
        let shape = to.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',{definition})"))?;
        to.add(format_args!(
            "SHAPE_DEFINITION_REPRESENTATION({shape},{representation})"
        ))?;
        Ok(())
    }
}

/// Returns what stands at `i + (d0 + 1) j` at `(d1 + 1) i + j`.
fn by_rows<T: Copy>(values: &[T], [a, b]: [usize; 2]) -> Vec<T> {
    (0..=a)
        .flat_map(|i| (0..=b).map(move |j| values[i + (a + 1) * j]))
        .collect()
}
