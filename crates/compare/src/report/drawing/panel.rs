//! One picture of a row.

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};
use msplines_picture::{
    Callout, Camera, ColourMap, ColourScale, Corner, Curves, Drawing, Image, Paint, PictureError,
    Radius, Rect, Rgb, Scene, Shading, Spheres, Surface, edges,
};

use super::camera::{camera, framed};
use super::lines::{EDGE, EDGE_WIDTHS, Lines};
use super::source::Source;
use super::t_spline::ControlNet;
use super::turnable::turnable;
use super::values::{SplitFaces, Subject, Values};
use super::{DrawingOptions, Views};
use crate::experiment::{Callout as Part, Corner as PartCorner, Panel, Show};
use crate::run::CHECKERS;

/// Smallest and largest radius of a knot in pixels of a picture of 1,000 pixels.
const KNOT_RADII: [f64; 2] = [2.5, 7.0];
/// Side of a picture over the distance of its knots, about: so many share it.
const KNOT_SHARE: f64 = 130.0;
/// Colours of the squares of a checkerboard.
const SQUARES: [Rgb; 2] = [Rgb::new(244, 241, 234), Rgb::new(64, 104, 150)];
/// Colour of control triangles, and how much of it hides what is behind.
const CONTROL: Rgb = Rgb::new(196, 58, 40);
const CONTROL_OPACITY: f64 = 0.4;
/// By how much they are nearer to the eye, over their distance from it.
const CONTROL_LIFT: f64 = 0.004;
/// About so many control triangles have thick sides.
const FEW_CONTROL: f64 = 300.0;
/// Pixels of the corner per pixel of a magnified part.
const MAGNIFICATION: usize = 3;
/// What numbers are painted with where their scale is not known: all errors are zero, which is good,
/// or nothing is a finite number, which is grey.
const UNKNOWN: ColourScale = ColourScale::linear(ColourMap::ColdWarm, [0.0, 1.0]);

/// A drawn panel.
pub(super) struct Picture {
    pub(super) image: Image,
    pub(super) payload: Option<String>,
}

/// What a panel shows, ready to be drawn.
pub(super) struct Stage<'a> {
    pub(super) mesh: &'a TriangleMesh,
    /// Exact normals of its vertices, where they are known.
    normals: Option<&'a [Vector3<f64>]>,
    /// Triangles that lie over the surface.
    control: Option<&'a TriangleMesh>,
    /// Control points, and what joins them where that is asked for.
    points: Option<ControlNet<'a>>,
    /// The surface that the camera is turned to.
    pub(super) framed: &'a TriangleMesh,
    /// The mesh cut along the borders of its cells, where those are painted.
    cells: Option<&'a SplitFaces>,
    paint: Paint<'a>,
    pub(super) colours: Vec<Rgb>,
    pub(super) lines: Lines,
    shading: Shading,
    pub(super) knots: &'a [Point3<f64>],
    knot_colour: Rgb,
    pub(super) camera: Camera,
}

/// Draws a panel, or says why it cannot be drawn.
pub(super) fn draw(
    panel: &Panel,
    subject: &Subject<'_>,
    scale: Option<&ColourScale>,
    options: DrawingOptions,
) -> Result<Picture, String> {
    let source = subject.source;
    // Errors are known at the vertices of the input only.
    let fitted = (panel.show == Show::Error).then(|| fitted_input(source));
    let own = source.beside_t_spline(panel)?;
    let mesh = match (&fitted, own) {
        (Some(fitted), _) => fitted,
        (None, Some(own)) => &own.field.mesh,
        (None, None) => shown(panel, source)?,
    };
    let stage = stage(panel, subject, mesh, scale)?;
    let image = still(&stage, panel, options.pixels).map_err(|e| e.to_string())?;
    // Views that can be turned have colours of vertices only, and hold one surface.
    let is_still = own.is_some()
        || matches!(
            panel.show,
            Show::Checkers | Show::ControlTriangles | Show::Isophotes
        );
    let is_turnable = options.views == Views::Turnable && !is_still;
    let payload = is_turnable.then(|| turnable(&stage, source, options.pixels));
    Ok(Picture { image, payload })
}

/// Returns the surface that a panel shows, of what several methods have.
fn shown<'a>(panel: &Panel, source: &'a Source) -> Result<&'a TriangleMesh, String> {
    Ok(match panel.show {
        Show::Spline | Show::Checkers | Show::ControlTriangles | Show::Isophotes => &source.spline,
        Show::Refinement => &source.refinement()?.mesh,
        Show::Charts => &source.charts()?.mesh,
        Show::Field => source.shown(panel.on.unwrap_or_default())?.0,
        Show::Target => &source.target()?.0,
        Show::Input | Show::Knots | Show::Error => framed(panel, source)?,
        Show::Cylinders | Show::Rectangles | Show::ControlPoints | Show::Level => {
            &source.of_t_spline(panel)?.field.mesh
        }
    })
}

/// Returns the input mesh with its vertices moved to the spline.
fn fitted_input(source: &Source) -> TriangleMesh {
    let count = source.input().vertex_count();
    let positions = source.spline.positions()[..count].to_vec();
    source.input().with_positions(positions)
}

fn stage<'a>(
    panel: &Panel,
    subject: &'a Subject<'_>,
    mesh: &'a TriangleMesh,
    scale: Option<&ColourScale>,
) -> Result<Stage<'a>, String> {
    let source = subject.source;
    let own = source.beside_t_spline(panel)?;
    let (paint, colours) = paint(&subject.values, scale);
    let lines = Lines::of(panel, source, mesh)?;
    let own_normals = own.map(|own| own.normals.as_deref());
    let normals = own_normals.unwrap_or_else(|| source.normals());
    Ok(Stage {
        mesh,
        normals: normals.filter(|n| n.len() == mesh.vertex_count()),
        control: match panel.show {
            Show::ControlTriangles => Some(&source.control()?.mesh),
            _ => None,
        },
        points: match panel.show {
            Show::ControlPoints => Some(source.control_points(panel)?),
            _ => None,
        },
        framed: framed(panel, source)?,
        cells: match &subject.values {
            Values::Cells { split, .. } => Some(split),
            _ => None,
        },
        paint,
        colours,
        // A coarse mesh is shown as the facets that it is.
        shading: if has_facets(panel, !lines.is_own) && lines.is_coarse(panel) {
            Shading::Flat
        } else {
            Shading::Smooth
        },
        knots: if panel.knots || panel.show == Show::Knots {
            &source.knots
        } else {
            &[]
        },
        knot_colour: lines.knot_colour(panel, own.is_some()),
        lines,
        camera: camera(panel, source)?,
    })
}

/// Returns whether the surface of a panel may be shown as facets.
fn has_facets(panel: &Panel, has_no_lines: bool) -> bool {
    match panel.show {
        Show::Field => has_no_lines,
        Show::Input | Show::Knots | Show::Error | Show::Refinement | Show::Charts => true,
        _ => false,
    }
}

/// Returns how the surface is painted, and the colour of each of its vertices.
fn paint<'a>(values: &'a Values, scale: Option<&ColourScale>) -> (Paint<'a>, Vec<Rgb>) {
    match values {
        Values::Bare => (Paint::Uniform(Rgb::CLAY), Vec::new()),
        Values::Colours(colours) => (Paint::Colours(colours), colours.clone()),
        Values::Checkers(corners) => (
            Paint::Checkers {
                corners,
                squares: CHECKERS,
                colours: SQUARES,
            },
            Vec::new(),
        ),
        Values::Cells { colours, split } => (Paint::FaceColours(&split.colours), colours.clone()),
        Values::Scalars { values, .. } => {
            let scale = scale.copied().unwrap_or(UNKNOWN);
            let colours = values.iter().map(|&value| scale.colour(value)).collect();
            (Paint::Scalars { values, scale }, colours)
        }
    }
}

/// Returns the radius of so many knots in pixels of a picture of 1,000 pixels.
pub(super) fn knot_radius(count: usize) -> f64 {
    let [smallest, largest] = KNOT_RADII;
    (KNOT_SHARE / (count.max(1) as f64).sqrt()).clamp(smallest, largest)
}

/// Control triangles as they are drawn.
struct Control {
    lifted: Vec<Point3<f64>>,
    sides: Vec<[u32; 2]>,
}

impl Control {
    /// Moves triangles a little towards the eye: they touch the surface, which would hide half of them.
    fn new(mesh: &TriangleMesh, camera: &Camera) -> Self {
        Self {
            lifted: lifted(mesh, camera),
            sides: edges(mesh.faces()),
        }
    }

    /// Adds them to a scene.
    fn add_to<'a>(&'a self, scene: &mut Scene<'a>, mesh: &'a TriangleMesh, per_thousand: f64) {
        let width = EDGE_WIDTHS[0] + FEW_CONTROL / mesh.face_count() as f64;
        let width = width.min(EDGE_WIDTHS[1]) * per_thousand;
        let triangles = Surface::new(&self.lifted, mesh.faces());
        let triangles = triangles.paint(Paint::Uniform(CONTROL));
        scene.add(triangles.shading(Shading::Flat).opacity(CONTROL_OPACITY));
        let sides = Curves::new(&self.lifted, &self.sides);
        scene.add(sides.colour(CONTROL).width(width));
    }
}

/// Returns the vertices of a mesh a little nearer to the eye.
fn lifted(mesh: &TriangleMesh, camera: &Camera) -> Vec<Point3<f64>> {
    let eye = camera.eye();
    let vertices = mesh.positions().iter();
    vertices.map(|p| p + CONTROL_LIFT * (eye - p)).collect()
}

fn still(stage: &Stage<'_>, panel: &Panel, pixels: usize) -> Result<Image, PictureError> {
    let per_thousand = pixels as f64 / 1000.0;
    let mut scene = Scene::new(stage.camera);
    let positions = stage.mesh.positions();
    let surface = match stage.cells {
        Some(split) => Surface::new(&split.positions, &split.faces),
        None => Surface::new(positions, stage.mesh.faces()),
    };
    let surface = match stage.normals {
        Some(normals) if stage.cells.is_none() => surface.normals(normals),
        _ => surface,
    };
    scene.add(surface.paint(stage.paint).shading(stage.shading));
    let control = stage.control.map(|mesh| Control::new(mesh, &stage.camera));
    if let (Some(control), Some(mesh)) = (&control, stage.control) {
        control.add_to(&mut scene, mesh, per_thousand);
    }
    let [curves, creases] = stage.lines.curves(positions, per_thousand);
    scene.add(curves).add(creases);
    let points = stage
        .points
        .map(|(mesh, sides)| (lifted(mesh, &stage.camera), sides));
    if let Some((points, sides)) = &points {
        let radius = Radius::Pixels(knot_radius(points.len()) * per_thousand);
        let sides = Curves::new(points, sides).colour(EDGE);
        scene.add(Spheres::new(points).radius(radius));
        scene.add(sides.width(EDGE_WIDTHS[0] * per_thousand));
    }
    if !stage.knots.is_empty() {
        let radius = Radius::Pixels(knot_radius(stage.knots.len()) * per_thousand);
        let spheres = Spheres::new(stage.knots).radius(radius);
        scene.add(spheres.colour(stage.knot_colour));
    }
    let drawing = Drawing {
        width: pixels,
        height: pixels,
        ..Drawing::default()
    };
    let image = scene.draw(&drawing)?;
    match panel.callout {
        Some(part) => magnified(part, &scene, &drawing, &image),
        None => Ok(image),
    }
}

/// Returns a picture with a magnified part in a corner.
fn magnified(
    Part { at, size, corner }: Part,
    scene: &Scene<'_>,
    drawing: &Drawing,
    image: &Image,
) -> Result<Image, PictureError> {
    let pixels = drawing.width as f64;
    let place = |at: f64| ((at - size / 2.0).max(0.0) * pixels) as usize;
    let side = (size * pixels) as usize;
    let mut callout = Callout::new(Rect {
        x: place(at[0]),
        y: place(at[1]),
        width: side,
        height: side,
    });
    callout.magnification = MAGNIFICATION;
    callout.corner = match corner {
        PartCorner::TopLeft => Corner::TopLeft,
        PartCorner::TopRight => Corner::TopRight,
        PartCorner::BottomLeft => Corner::BottomLeft,
        PartCorner::BottomRight => Corner::BottomRight,
    };
    let detail = Some(callout.detail());
    let inset = scene.draw(&Drawing { detail, ..*drawing })?;
    callout.place(image, &inset)
}
