//! What pictures of a T-spline show beside it: the form as squares, the cylinders, the T-mesh on the
//! surface, control points, and surfaces on the way.

use std::collections::BTreeMap;

use msplines_common::Point3;
use msplines_common::mesh::{SurfacePoint, TriangleMesh, VertexAttribute};
use msplines_picture::category_colours;
use msplines_t_spline::caps::CapKind;
use msplines_t_spline::complex::{Beyond, CylinderComplex, Node};
use msplines_t_spline::fit::Level;
use msplines_t_spline::{Domain, TSpline, TSplineSurface};
use serde_json::{Value, json};

use super::tiles::Tiled;
use crate::run::{CHECKERS, Companion, RunOutput};

/// Sides of triangles along the diagonal of the surface.
const ALONG_DIAGONAL: f64 = 250.0;
/// Squares of the form along the diagonal, where the form has its median scale.
const SQUARES: f64 = 40.0;
/// Rows are stretched by at most this share to be a whole number of pairs.
const STRETCHED: f64 = 0.08;
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
    let own = spline.space().mesh();
    let first = levels.first().map_or(spline, |level| &level.spline);
    let base = first.space().mesh();
    let tiled = Tiled::on_surface(spline, own, reach);
    output.companions.push(tiled.companion(SURFACE, Vec::new()));
    let palette = palette(domain.complex());
    let on_surface = (CYLINDERS, Tiled::on_surface(spline, base, reach));
    for (name, tiled) in [on_surface, (RECTANGLES, Tiled::flat(base))] {
        let colours = colours(&tiled.cylinders, &palette);
        output.companions.push(tiled.companion(name, colours));
    }
    output.companions.push(Companion {
        mesh: Some(domain.mesh().clone()),
        ..bare(NET)
    });
    output.texture = Some(squares(domain));
    output.companions.push(control(spline));
    for (name, level) in LEVELS.into_iter().zip(chosen(levels)) {
        let mesh = level.spline.space().mesh();
        let tiled = Tiled::on_surface(&level.spline, mesh, reach);
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

fn bare(name: &'static str) -> Companion {
    Companion {
        name,
        mesh: None,
        edges: Vec::new(),
        creases: Vec::new(),
        fields: Vec::new(),
    }
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

/// Returns the texture coordinates of the corners of every face: squares of the form, a whole number of
/// pairs around every cylinder. Where rows fit nearly, they are made to.
fn squares(domain: &Domain) -> Vec<[[f64; 2]; 3]> {
    let side = median_scale(domain) * domain.mesh().diagonal() / SQUARES;
    let pairs = |length: f64, side: f64| 2.0 * (length / (2.0 * side)).round().max(1.0);
    let scale = |own: &msplines_t_spline::complex::Cylinder| {
        let [size, height] = [own.circumference, own.height].map(|n| n as f64);
        let x = pairs(size, side) / size;
        let y = pairs(height, 1.0 / x) / height;
        [
            x,
            if (y / x - 1.0).abs() < STRETCHED {
                y
            } else {
                x
            },
        ]
    };
    let scales: Vec<[f64; 2]> = domain.complex().cylinders().iter().map(scale).collect();
    let corners = |face| {
        let patch = domain.patch(&middle(face));
        let scale = scales[patch.cylinder as usize];
        patch
            .corners
            .map(|at| [0, 1].map(|k| at[k] * scale[k] / CHECKERS))
    };
    (0..domain.mesh().face_count() as u32)
        .map(corners)
        .collect()
}

fn middle(face: u32) -> SurfacePoint {
    SurfacePoint {
        face,
        at: [1.0 / 3.0; 3],
    }
}

/// The median over the surface of lengths on the cylinders over lengths on the surface.
fn median_scale(domain: &Domain) -> f64 {
    let mesh = domain.mesh();
    let of_face = |face: u32| {
        let [a, b, c] = domain.patch(&middle(face)).corners;
        let flat = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let area = mesh.face_normal(face).norm();
        ((flat.max(0.0) / area).sqrt(), area)
    };
    let faces = (0..mesh.face_count() as u32).map(of_face);
    let mut scales: Vec<(f64, f64)> = faces.filter(|(scale, _)| scale.is_normal()).collect();
    scales.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = scales.iter().map(|(_, area)| area).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let median = scales.iter().find(|(_, area)| {
        sum += area;
        sum >= half
    });
    median.map_or(1.0, |found| found.0)
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
        ..bare(CONTROL)
    }
}
