//! Writes a page with turnable surfaces and a table, to look at the viewer without running a report.
//!
//! `cargo run -p msplines-compare --example viewer_page -- FOLDER` writes `FOLDER/index.html`. The stills
//! are drawn here by the painter's algorithm, so that the viewer's framing can be held against another's.

#![allow(clippy::print_stderr, reason = "a command says what it misses")]

use std::fmt::Write as _;
use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use msplines_common::mesh::TriangleMesh;
use msplines_compare::generated::{GeneratedSurface, colour_pattern};
use msplines_compare::report::surface_payload::{CLAY, Camera, Lines, Points, SurfaceView, encode};
use msplines_compare::report::viewer::{Viewer, bundle};

type Vec3 = [f64; 3];

/// Width and height of a still in pixels.
const SIZE: [f64; 2] = [960.0, 720.0];
const STYLE: &str = "body { font: 16px/1.5 system-ui, sans-serif; margin: 1rem auto; max-width: 60rem; \
    padding: 0 1rem } :root { color-scheme: light dark } img { max-width: 100%; height: auto; \
    display: block } figure { margin: 1rem 0 } .scroll { overflow-x: auto } \
    th button { font: inherit; background: none; border: 0; color: inherit; cursor: pointer } \
    td, th { padding: .2em .6em; text-align: right }";

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: viewer_page FOLDER");
        return Ok(());
    };
    std::fs::create_dir_all(&folder)?;
    let mut figures = String::new();
    let mut rows = String::new();
    for surface in GeneratedSurface::ALL {
        let mesh = surface.mesh();
        let (still, payload) = pictures(&mesh, surface);
        let (name, size) = (surface.name(), payload.len());
        let _ = write!(
            figures,
            "<figure><div data-surface=\"{name}\"><img alt=\"{name}\" width=960 height=720 \
             src=\"data:image/svg+xml;base64,{}\"></div><figcaption>{name}</figcaption></figure>\n\
             <script type=\"application/octet-stream\" id=\"surface-{name}\">{payload}</script>\n",
            STANDARD.encode(still)
        );
        let count = mesh.vertex_count();
        let _ = writeln!(
            rows,
            "<tr><td>{name}</td><td data-value=\"{count}\">{count}</td><td data-value=\"{size}\">\
             {:.1} KB</td></tr>",
            size as f64 / 1e3
        );
    }
    let script = match bundle(&folder) {
        Viewer::Script(script) => format!("<script id=\"viewer\">{script}</script>"),
        Viewer::Absent(reason) => format!("<p>Still pictures only: {reason}.</p>"),
    };
    let tables = include_str!("../src/report/tables.js");
    let page = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>Viewer</title><style>{STYLE}</style>\n\
         <h1>Viewer</h1><label>Filter <input type=\"search\" class=\"filter\" data-table=\"sizes\">\
         </label><div class=\"scroll\"><table class=\"sortable\" id=\"sizes\"><thead><tr>\
         <th><button>surface</button></th><th><button>vertices</button></th>\
         <th><button>payload</button></th></tr></thead><tbody>\n{rows}</tbody></table></div>\n\
         {figures}<script>{tables}</script>\n{script}\n</html>\n"
    );
    std::fs::write(folder.join("index.html"), page)
}

/// Returns a still as SVG and the payload of the same view.
fn pictures(mesh: &TriangleMesh, surface: GeneratedSurface) -> (String, String) {
    let positions: Vec<Vec3> = mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect();
    let [low, high] = mesh.bounding_box();
    let diagonal = (high - low).norm();
    let target = low + (high - low) / 2.0;
    let is_coloured = surface == GeneratedSurface::Genus8;
    let byte = |c: &f64| (c * 255.0).round() as u8;
    let colours: Vec<[u8; 3]> = colour_pattern(mesh)
        .chunks_exact(3)
        .map(|c| [byte(&c[0]), byte(&c[1]), byte(&c[2])])
        .filter(|_| is_coloured)
        .collect();
    let heights: Vec<f64> = (1..12)
        .map(|i| low.z + (high.z - low.z) * f64::from(i) / 12.0)
        .filter(|_| !is_coloured)
        .collect();
    let segments = level_lines(mesh, &heights);
    let step = if is_coloured { positions.len() } else { 97 };
    let points: Vec<Vec3> = positions.iter().copied().skip(1).step_by(step).collect();
    let view = SurfaceView {
        positions: &positions,
        triangles: mesh.faces(),
        colours: &colours,
        lines: Lines {
            segments: &segments,
            colour: [40, 70, 120],
            width: 2.0,
        },
        points: Points {
            positions: &points,
            colour: [190, 40, 30],
            radius: 0.005 * diagonal,
        },
        camera: Camera {
            eye: std::array::from_fn(|i| target[i] + diagonal * [0.7, -1.6, 1.1][i]),
            target: target.into(),
            up: [0.0, 0.0, 1.0],
            field_of_view: 0.5,
        },
    };
    (paint(&view), encode(&view))
}

/// Returns where the faces of a mesh cross the planes of these heights.
fn level_lines(mesh: &TriangleMesh, heights: &[f64]) -> Vec<[Vec3; 2]> {
    let mut segments = Vec::new();
    for face in 0..mesh.face_count() as u32 {
        let corners = mesh.triangle(face);
        for &height in heights {
            let crossings: Vec<Vec3> = (0..3)
                .map(|i| (corners[i], corners[(i + 1) % 3]))
                .filter(|(a, b)| (a.z < height) != (b.z < height))
                .map(|(a, b)| (a + (b - a) * ((height - a.z) / (b.z - a.z))).into())
                .collect();
            if let [a, b] = crossings[..] {
                segments.push([a, b]);
            }
        }
    }
    segments
}

/// Returns the surface as SVG, the farthest triangle first; lines and points are left out.
fn paint(view: &SurfaceView) -> String {
    let camera = &view.camera;
    let back = unit(minus(camera.eye, camera.target));
    let right = unit(cross(camera.up, back));
    let up = cross(back, right);
    let light = unit(std::array::from_fn(|i| {
        back[i] + 0.7 * up[i] - 0.5 * right[i]
    }));
    let focal = SIZE[1] / 2.0 / (camera.field_of_view / 2.0).tan();
    let mut polygons = Vec::new();
    for triangle in view.triangles {
        let corners = triangle.map(|v| view.positions[v as usize]);
        let normal = unit(cross(
            minus(corners[1], corners[0]),
            minus(corners[2], corners[0]),
        ));
        if dot(normal, minus(camera.eye, corners[0])) < 0.0 {
            continue;
        }
        let mut points = String::new();
        let mut depth = 0.0;
        for corner in corners {
            let seen = minus(corner, camera.eye);
            let away = -dot(seen, back);
            depth += away;
            let x = SIZE[0] / 2.0 + focal * dot(seen, right) / away;
            let y = SIZE[1] / 2.0 - focal * dot(seen, up) / away;
            let _ = write!(points, "{x:.1},{y:.1} ");
        }
        let bright = 0.45 + 0.5 * dot(normal, light).max(0.0);
        let colour = *view.colours.get(triangle[0] as usize).unwrap_or(&CLAY);
        let [r, g, b] = colour.map(|c| (f64::from(c) * bright) as u8);
        polygons.push((
            depth,
            format!("<path d=\"M{points}z\" style=\"--c:#{r:02x}{g:02x}{b:02x}\"/>"),
        ));
    }
    polygons.sort_by(|a, b| b.0.total_cmp(&a.0));
    let paths: String = polygons.into_iter().map(|(_, path)| path).collect();
    let [width, height] = SIZE;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\">\
         <style>path{{fill:var(--c);stroke:var(--c);stroke-width:.7}}</style>\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{paths}</svg>"
    )
}

fn minus(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn unit(a: Vec3) -> Vec3 {
    a.map(|x| x / dot(a, a).sqrt())
}
