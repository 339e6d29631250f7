//! What pictures of a T-spline show beside it: the form as squares, the cylinders, the T-mesh on the
//! surface, control points, and surfaces on the way.

use std::collections::BTreeMap;

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_picture::category_colours;
use msplines_t_spline::caps::CapKind;
use msplines_t_spline::complex::{Beyond, CylinderComplex, Node};
use msplines_t_spline::fit::Level;
use msplines_t_spline::{TSpline, TSplineSurface};
use serde_json::{Value, json};

use super::net;
use super::tiles::{Lines, Tiled};
use crate::run::{Companion, RunOutput};

/// Sides of triangles along the diagonal of the surface.
const ALONG_DIAGONAL: f64 = 250.0;
/// The surface that is tiled by its T-mesh, the one that is tiled by the first T-mesh, its cylinders in
/// the plane, the mesh that the form lies on, and the control points.
pub(crate) const SURFACE: &str = "t-mesh";
pub(crate) const CYLINDERS: &str = "cylinders";
pub(crate) const RECTANGLES: &str = "rectangles";
pub(crate) const NET: &str = "net";
pub(crate) const CONTROL: &str = "control";
/// Surfaces on the way, from the first to the last.
pub(crate) const LEVELS: [&str; 6] = [
    "level-0", "level-1", "level-2", "level-3", "level-4", "level-5",
];
/// Names of the attributes that are colours.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Adds everything that pictures show to the output of a run.
pub(super) fn add(
    output: &mut RunOutput,
    surface: &TSplineSurface,
    levels: &[Level],
    input: &TriangleMesh,
) {
    let (domain, spline) = (surface.domain(), surface.spline());
    let [low, high] = input.bounding_box();
    let reach = (high - low).norm() / ALONG_DIAGONAL;
    output
        .record
        .checks
        .extend(checks(levels, (high - low).max()));
    let first = levels.first().map_or(spline, |level| &level.spline);
    let base = first.space().mesh();
    let tiled = Tiled::on_surface(spline, Lines::All, reach);
    // Between the vertices nothing else bounds the surface.
    let beyond = tiled.beyond([low, high]) / (high - low).norm();
    let checks = &mut output.record.checks;
    checks.insert("beyond_box".to_owned(), json!(beyond));
    output.companions.push(tiled.companion(SURFACE, Vec::new()));
    let palette = palette(domain.complex());
    let on_surface = (
        CYLINDERS,
        Tiled::on_surface(spline, Lines::Grid(base), reach),
    );
    for (name, tiled) in [on_surface, (RECTANGLES, Tiled::flat(base))] {
        let colours = colours(&tiled.cylinders, &palette);
        output.companions.push(tiled.companion(name, colours));
    }
    let (net, squares) = net::net(domain);
    output.companions.push(net);
    output.texture = Some(squares);
    output.companions.push(control(spline));
    for (name, level) in LEVELS.into_iter().zip(chosen(levels)) {
        let tiled = Tiled::on_surface(&level.spline, Lines::All, reach);
        output.companions.push(tiled.companion(name, Vec::new()));
    }
}

/// Returns control points and largest errors of the surfaces on the way that pictures show, the errors
/// over the longest side of the bounding box.
fn checks(levels: &[Level], longest: f64) -> BTreeMap<String, Value> {
    let mut checks = BTreeMap::new();
    for (name, level) in LEVELS.into_iter().zip(chosen(levels)) {
        let name = name.replace('-', "_");
        let count = level.spline.space().unknowns();
        checks.insert(format!("{name}_control_points"), json!(count));
        checks.insert(format!("{name}_max"), json!(level.errors.max / longest));
    }
    checks
}

/// Returns levels from the first to the last, each with about as many times more control points.
fn chosen(levels: &[Level]) -> Vec<&Level> {
    let count = |level: &Level| (level.spline.space().unknowns() as f64).ln();
    let ends = levels.first().map(count).zip(levels.last().map(count));
    let Some((low, high)) = ends else {
        return Vec::new();
    };
    let mut chosen: Vec<&Level> = Vec::new();
    for step in 0..LEVELS.len() {
        let wanted = low + (high - low) * step as f64 / (LEVELS.len() - 1) as f64;
        let away = |level: &&Level| (count(level) - wanted).abs();
        let nearest = levels.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let before = chosen
            .last()
            .map_or(0, |level| level.spline.space().unknowns());
        chosen.extend(nearest.filter(|level| level.spline.space().unknowns() > before));
    }
    chosen
}

/// Returns a colour for every cylinder, different where two touch.
fn palette(complex: &CylinderComplex) -> Vec<[u8; 3]> {
    let mut touching = Vec::new();
    for (index, own) in (0..).zip(complex.cylinders()) {
        for segment in own.bottom.iter().chain(&own.top) {
            if let Beyond::Cylinder { cylinder, .. } = segment.beyond
                && cylinder != index
            {
                touching.push([index, cylinder]);
            }
        }
    }
    let colours = category_colours(complex.cylinders().len(), &touching);
    colours.into_iter().map(|c| c.channels()).collect()
}

/// Returns the colours of the cylinders of points, each channel in 0..=1.
fn colours(cylinders: &[u32], palette: &[[u8; 3]]) -> Vec<VertexAttribute> {
    let channel = |(name, channel): (&str, usize)| VertexAttribute {
        name: name.to_owned(),
        values: {
            let value = |&cylinder: &u32| f64::from(palette[cylinder as usize][channel]) / 255.0;
            cylinders.iter().map(value).collect()
        },
    };
    CHANNELS.into_iter().zip(0..).map(channel).collect()
}

/// Returns the control points, joined as the T-mesh joins their anchors. At zeros it has the surface
/// itself, which has no function there.
fn control(spline: &TSpline) -> Companion {
    let (space, mesh) = (spline.space(), spline.quad_mesh());
    let functions = space.functions();
    let anchors = functions.iter().zip(spline.control());
    // Of two functions on an open border the second, which the border is interpolated by.
    let anchors: BTreeMap<Node, _> = anchors.map(|(function, at)| (function.node, *at)).collect();
    let caps = space.caps().caps().iter();
    let at_zero = |cap: &msplines_t_spline::caps::Cap| match cap.kind {
        CapKind::Zero { index, .. } => Some((
            index,
            spline.control()[functions.len() + cap.offset as usize],
        )),
        CapKind::Pole { .. } => None,
    };
    let zeros: BTreeMap<u32, _> = caps.filter_map(at_zero).collect();
    let position = |vertex: &msplines_t_spline::cells::Vertex| {
        let point = vertex.point;
        let [x, y] = [point.x, point.y].map(|c| c as i64);
        let node = Node {
            cylinder: point.cylinder,
            x,
            y,
        };
        let found = match vertex.zero {
            Some(zero) => zeros.get(&zero),
            None => anchors.get(&node),
        };
        found.map(|at| Point3::from(*at))
    };
    let positions: Option<Vec<_>> = mesh.vertices().iter().map(position).collect();
    let mut faces = Vec::new();
    for face in 0..mesh.faces().len() as u32 {
        let around = mesh.around(face);
        faces.extend(
            around[1..]
                .windows(2)
                .map(|pair| [around[0], pair[0], pair[1]]),
        );
    }
    Companion {
        mesh: positions.and_then(|positions| TriangleMesh::build(positions, faces).ok()),
        edges: mesh.edges().iter().map(|edge| edge.ends).collect(),
        ..Companion::bare(CONTROL)
    }
}
