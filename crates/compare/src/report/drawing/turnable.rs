//! The lighter mesh that can be turned in place of a picture.

use msplines_common::Point3;
use msplines_common::mesh::Decimated;
use msplines_picture::Rgb;

use super::super::surface_payload::{self, Lines, Points, SurfaceView};
use super::panel::{Stage, knot_radius};
use super::source::Source;

/// Pieces of edges in a view that can be turned, at most.
const TURNED_EDGES: usize = 60_000;
/// Faces of a finer surface than its input in such a view, at most.
const TURNED_FACES: usize = 100_000;

/// Returns the mesh of a panel as text for the page, on the lighter faces of its domain where it is
/// large.
pub(super) fn turnable(stage: &Stage<'_>, source: &Source, pixels: usize) -> String {
    let own = stage.mesh.positions();
    let (faces, chosen, colours) = lighter(stage, source);
    let array = |p: &Point3<f64>| [p.x, p.y, p.z];
    let positions: Vec<[f64; 3]> = chosen.iter().map(array).collect();
    let colours: Vec<[u8; 3]> = colours.into_iter().map(Rgb::channels).collect();
    let segments: Vec<[[f64; 3]; 2]> = if stage.lines.edges.len() <= TURNED_EDGES {
        let ends = stage.lines.edges.iter();
        ends.map(|edge| edge.map(|v| array(&own[v as usize])))
            .collect()
    } else {
        Vec::new()
    };
    let knots: Vec<[f64; 3]> = stage.knots.iter().map(array).collect();
    let camera = stage.camera;
    let [low, high] = stage.framed.bounding_box();
    let target = camera.target(&(low + (high - low) * 0.5));
    let distance = (target - camera.eye()).norm();
    let pixel = 2.0 * distance * (camera.field_of_view() / 2.0).tan() / pixels as f64;
    surface_payload::encode(&SurfaceView {
        positions: &positions,
        triangles: faces,
        colours: &colours,
        lines: Lines {
            segments: &segments,
            colour: stage.lines.colour.channels(),
            width: stage.lines.width * pixels as f64 / 1000.0,
        },
        points: Points {
            positions: &knots,
            colour: Rgb::RED.channels(),
            radius: knot_radius(knots.len()) * pixel * pixels as f64 / 1000.0,
        },
        camera: surface_payload::Camera {
            eye: array(&camera.eye()),
            target: array(&target),
            up: camera.up().into(),
            field_of_view: camera.field_of_view(),
        },
    })
}

/// Faces with the positions and colours of their vertices.
type Painted<'a> = (&'a [[u32; 3]], Vec<Point3<f64>>, Vec<Rgb>);

/// Returns the surface of a panel with fewer faces where it has many.
fn lighter<'a>(stage: &Stage<'a>, source: &'a Source) -> Painted<'a> {
    let own = stage.mesh.positions();
    // The vertices of an interpolant are those of its domain, and then others.
    let at_vertices = source.normals().is_some() && stage.mesh.face_count() > TURNED_FACES;
    let faces = if at_vertices {
        source.input().faces()
    } else {
        stage.mesh.faces()
    };
    let light = source.domain.light();
    let light = light.filter(|_| faces == source.input().faces());
    match light {
        Some(Decimated {
            mesh,
            vertex_origin,
        }) => {
            let at = |&v: &u32| own[v as usize];
            let colour = |&v: &u32| stage.colours.get(v as usize).copied();
            let colours = vertex_origin.iter().filter_map(colour).collect();
            (
                mesh.faces(),
                vertex_origin.iter().map(at).collect(),
                colours,
            )
        }
        None => {
            let count = if at_vertices {
                source.input().vertex_count()
            } else {
                own.len()
            };
            (faces, own[..count].to_vec(), stage.colours.clone())
        }
    }
}
