//! Two overlapping charts of the domain, laid out in the plane.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::Point3;
use msplines_common::mesh::{NONE, TriangleMesh};
use msplines_powell_sabin::{PowellSabinSurface, Tessellation};
use serde_json::json;

use super::edits::{nearest, place};
use super::pictures::edges_on_surface;
use crate::record::{Checks, named};
use crate::run::{Companion, RunOutput};

/// Rings of faces around the middle of a chart.
const RINGS: usize = 3;
/// Room between two charts, over the width of the first.
const ROOM: f64 = 0.25;

/// A chart: some faces, and their vertices in the plane.
struct Chart {
    faces: BTreeSet<u32>,
    places: BTreeMap<u32, [f64; 2]>,
}

/// Two charts beside each other, and their outlines on the domain and on the spline.
pub(super) struct Charts {
    charts: [Chart; 2],
    flat: Companion,
    on_domain: Vec<[u32; 2]>,
    on_spline: Vec<[u32; 2]>,
}

impl Charts {
    /// Lays out the faces around two places of a surface away from its holes.
    pub(super) fn around(
        spline: &PowellSabinSurface,
        shown: &Tessellation,
        at: [[f64; 3]; 2],
    ) -> Self {
        let mesh = spline.mesh();
        let middle = |at| nearest(mesh.positions(), &place(mesh, at));
        let charts = at.map(|at| Chart::around(spline, middle(at)));
        let outlines = charts.iter().flat_map(|chart| outline(mesh, &chart.faces));
        let on_domain: BTreeSet<[u32; 2]> = outlines.collect();
        let along = |point: u32| {
            let point = &shown.points[point as usize];
            let corners = mesh.faces()[point.face as usize];
            let used = corners.into_iter().zip(point.at).filter(|(_, w)| *w != 0.0);
            used.map(|(vertex, _)| vertex).collect::<Vec<u32>>()
        };
        let on_spline = edges_on_surface(shown).into_iter().filter(|&[a, b]| {
            let ends: BTreeSet<u32> = along(a).into_iter().chain(along(b)).collect();
            let ends: Vec<u32> = ends.into_iter().collect();
            ends.len() == 2 && on_domain.contains(&[ends[0], ends[1]])
        });
        Self {
            flat: flat(mesh, &charts),
            on_spline: on_spline.collect(),
            on_domain: on_domain.into_iter().collect(),
            charts,
        }
    }

    /// Returns how many faces the charts share, and how far their transition is from a translation,
    /// over the width of the first.
    pub(super) fn checks(&self) -> Checks {
        let [first, second] = &self.charts;
        let shifts: Vec<[f64; 2]> = first
            .places
            .iter()
            .filter_map(|(vertex, a)| second.places.get(vertex).map(|b| sub(*a, *b)))
            .collect();
        let spread = shifts.iter().map(|shift| {
            let apart = sub(*shift, shifts[0]);
            apart[0].hypot(apart[1])
        });
        let spread = spread.fold(0.0, f64::max) / first.width();
        let shared = first.faces.intersection(&second.faces).count();
        named([
            ("shared_faces", json!(shared)),
            ("transition_spread", json!(spread)),
        ])
    }

    /// Adds the charts to what pictures of a run show.
    pub(super) fn show(self, output: &mut RunOutput) {
        for companion in &mut output.companions {
            match companion.name {
                "input" => companion.creases.clone_from(&self.on_domain),
                "spline" => companion.creases.clone_from(&self.on_spline),
                _ => {}
            }
        }
        output.companions.push(self.flat);
    }
}

impl Chart {
    /// Returns the faces around a vertex with its integrals of the form from there.
    fn around(spline: &PowellSabinSurface, middle: u32) -> Self {
        let (mesh, form) = (spline.mesh(), spline.edge_vectors());
        let topology = mesh.topology();
        let usable: BTreeSet<u32> = spline.regular_faces().iter().copied().collect();
        let mut places = BTreeMap::from([(middle, [0.0; 2])]);
        let mut faces = BTreeSet::new();
        let mut ring = vec![middle];
        for _ in 0..RINGS {
            let mut next = Vec::new();
            for vertex in ring {
                let from = places[&vertex];
                for half_edge in topology.outgoing(vertex) {
                    let face = half_edge / 3;
                    if !usable.contains(&face) {
                        continue;
                    }
                    faces.insert(face);
                    // Along the side out of the vertex, and back along the one into it.
                    let back = 3 * face + (half_edge + 2) % 3;
                    let out = form[half_edge as usize];
                    let into = form[back as usize];
                    for (to, shift) in [
                        (topology.target(half_edge), out),
                        (topology.origin(back), [-into[0], -into[1]]),
                    ] {
                        places.entry(to).or_insert_with(|| {
                            next.push(to);
                            [from[0] + shift[0], from[1] + shift[1]]
                        });
                    }
                }
            }
            ring = next;
        }
        Self { faces, places }
    }

    fn width(&self) -> f64 {
        let [low, high] = self.range();
        high - low
    }

    fn range(&self) -> [f64; 2] {
        let along = self.places.values().map(|p| p[0]);
        let low = along.clone().fold(f64::INFINITY, f64::min);
        [low, along.fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// Returns both charts side by side; the outline of what they share is sharp.
fn flat(mesh: &TriangleMesh, charts: &[Chart; 2]) -> Companion {
    let shared: BTreeSet<u32> = charts[0]
        .faces
        .intersection(&charts[1].faces)
        .copied()
        .collect();
    let outline = outline(mesh, &shared);
    let (mut positions, mut faces, mut creases) = (Vec::new(), Vec::new(), Vec::new());
    let mut left = 0.0;
    for chart in charts {
        let [low, high] = chart.range();
        let first = positions.len() as u32;
        let numbers: BTreeMap<u32, u32> = chart.places.keys().copied().zip(first..).collect();
        let moved = |p: &[f64; 2]| Point3::new(left + p[0] - low, p[1], 0.0);
        positions.extend(chart.places.values().map(moved));
        let corners = |face: &u32| mesh.faces()[*face as usize].map(|v| numbers[&v]);
        faces.extend(chart.faces.iter().map(corners));
        creases.extend(outline.iter().map(|edge| edge.map(|v| numbers[&v])));
        left += (high - low) * (1.0 + ROOM);
    }
    Companion {
        edges: msplines_picture::edges(&faces),
        mesh: TriangleMesh::build(positions, faces).ok(),
        creases,
        ..Companion::bare("charts")
    }
}

/// Returns the edges between some faces and all others.
fn outline(mesh: &TriangleMesh, faces: &BTreeSet<u32>) -> Vec<[u32; 2]> {
    let topology = mesh.topology();
    let half_edges = faces.iter().flat_map(|face| 3 * face..3 * face + 3);
    let outer = half_edges.filter(|&h| {
        let across = topology.twin(h);
        across == NONE || !faces.contains(&(across / 3))
    });
    let ends = outer.map(|h| [topology.origin(h), topology.target(h)]);
    ends.map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
