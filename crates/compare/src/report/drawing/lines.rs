//! The lines of a panel: edges of a mesh, curves on a surface, creases.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_picture::{Curves, Rgb, edges};

use super::companions::Lines as OwnLines;
use super::source::Source;
use crate::experiment::{Edges, Panel, Show};

/// Meshes of more edges have theirs drawn finer, so that the surface stays visible.
const FEW_EDGES: f64 = 3_000.0;
/// Thinnest and thickest edge in pixels of a picture of 1,000 pixels.
pub(super) const EDGE_WIDTHS: [f64; 2] = [0.6, 2.0];
/// Width of a crease, in widths of an edge.
const CREASE_WIDTH: f64 = 2.0;
/// Colour of edges on a mesh.
pub(super) const EDGE: Rgb = Rgb::new(92, 98, 108);
/// Width of the coarse grids on cylinders, likewise.
const GRAPH_WIDTH: f64 = 2.6;
/// Pieces of an edge of a T-mesh, about.
const PIECES: f64 = 8.0;

/// Lines of a panel, as pairs of vertices of its surface.
pub(super) struct Lines {
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) colour: Rgb,
    pub(super) width: f64,
    /// Drawn red, or black where the edges are red.
    creases: Vec<[u32; 2]>,
    /// Whether the run left them.
    pub(super) is_own: bool,
    /// Edges that these are pieces of, about.
    count: f64,
}

impl Lines {
    /// Returns the lines of a panel that shows `mesh`.
    pub(super) fn of(panel: &Panel, source: &Source, mesh: &TriangleMesh) -> Result<Self, String> {
        let lines = own(panel, source)?;
        let is_domain = panel.edges == Edges::Domain;
        let edges = match (panel.edges, panel.show) {
            (Edges::None, _) | (_, Show::ControlPoints) => Vec::new(),
            (Edges::Domain, _) if lines.is_some() => {
                lines.map_or_else(Vec::new, |l| l.edges.clone())
            }
            (Edges::Domain, Show::Spline | Show::Field) => source.domain_edges(),
            (Edges::Domain, _) => edges(mesh.faces()),
        };
        let creases = lines.filter(|_| is_domain || is_graph(panel));
        // The images of edges come in pieces.
        let pieces = match panel.show {
            _ if source.beside_t_spline(panel)?.is_some() => PIECES,
            Show::Spline | Show::Field | Show::ControlTriangles => source.pieces_per_edge(),
            _ => 1.0,
        };
        let count = edges.len() as f64 / pieces;
        let [thinnest, thickest] = EDGE_WIDTHS;
        Ok(Self {
            colour: edge_colour(panel, source, lines.is_some()),
            creases: creases.map_or_else(Vec::new, |lines| lines.creases.clone()),
            width: if is_graph(panel) {
                GRAPH_WIDTH
            } else {
                (thickest * (FEW_EDGES / count).sqrt()).clamp(thinnest, thickest)
            },
            is_own: lines.is_some(),
            edges,
            count,
        })
    }

    /// Returns whether these are the edges of a mesh of few faces.
    pub(super) fn is_coarse(&self, panel: &Panel) -> bool {
        self.count <= FEW_EDGES && panel.edges == Edges::Domain
    }

    /// Returns the colour of marks: red, but where that would not be seen, on the red curves of a T-mesh and
    /// on a critical graph.
    pub(super) fn knot_colour(&self, panel: &Panel, is_t_spline: bool) -> Rgb {
        if is_graph(panel) {
            return Rgb::INK;
        }
        let is_red = self.colour == Rgb::RED && panel.edges == Edges::Domain;
        if is_t_spline && is_red {
            Rgb::BLUE
        } else {
            Rgb::RED
        }
    }

    /// Returns edges and creases over the vertices of their surface.
    pub(super) fn curves<'a>(
        &'a self,
        positions: &'a [Point3<f64>],
        per_thousand: f64,
    ) -> [Curves<'a>; 2] {
        let edges = Curves::new(positions, &self.edges).colour(self.colour);
        let creases = Curves::new(positions, &self.creases).colour(if self.colour == Rgb::RED {
            Rgb::INK
        } else {
            Rgb::RED
        });
        [
            edges.width(self.width * per_thousand),
            creases.width(CREASE_WIDTH * self.width * per_thousand),
        ]
    }
}

/// Returns whether a panel shows the critical graph of a T-spline.
fn is_graph(panel: &Panel) -> bool {
    matches!(panel.show, Show::Cylinders | Show::Rectangles)
}

/// Returns the colour of edges: creases are red where there are any to tell.
fn edge_colour(panel: &Panel, source: &Source, has_lines: bool) -> Rgb {
    let is_red = match panel.show {
        Show::Spline => !has_lines || source.normals().is_some() || source.t_spline.is_some(),
        Show::Level => true,
        _ => false,
    };
    if is_red { Rgb::RED } else { EDGE }
}

/// Returns the lines on the surface of a panel, where a run left them.
fn own<'a>(panel: &Panel, source: &'a Source) -> Result<Option<&'a OwnLines>, String> {
    if panel.show == Show::ControlPoints {
        return Ok(None);
    }
    if let Some(own) = source.beside_t_spline(panel)? {
        return Ok(Some(&own.field.lines));
    }
    Ok(match panel.show {
        Show::Input => source.lines().map(|[control, _]| control),
        Show::Spline | Show::ControlTriangles => source.lines().map(|[_, spline]| spline),
        Show::Refinement => source.refinement().ok().map(|split| &split.lines),
        Show::Charts => source.charts().ok().map(|charts| &charts.lines),
        Show::Field => source.field_lines(panel.on.unwrap_or_default()),
        Show::Target => source.target().ok().map(|target| &target.1),
        _ => None,
    })
}
