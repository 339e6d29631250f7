//! What is measured of a T-spline.

use std::collections::BTreeMap;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::Distance;
use msplines_t_spline::complex::{CylinderComplex, Point};
use msplines_t_spline::measure::{ContinuityOptions, Jumps, continuity, gram};
use msplines_t_spline::tmesh::Leaf;
use msplines_t_spline::{TMesh, TSpline, TSplineSpace, TSplineSurface};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Value, json};

use super::tessellation;
use super::write::AtVertices;
use crate::error::RunError;
use crate::measure::{Tessellated, settled_distance};

/// Random points at which the partition of unity is looked at.
const SAMPLES: usize = 20_000;
/// The distance is measured to a tessellation of at most so many triangles.
const MOST_TRIANGLES: usize = 2_000_000;

/// Returns what is known of a surface by name.
pub(super) fn surface(surface: &TSplineSurface, seed: u64) -> BTreeMap<String, Value> {
    let (domain, space) = (surface.domain(), surface.spline().space());
    let (report, mesh) = (domain.report(), space.mesh());
    let poles = domain.poles().len();
    let points = random_points(domain.complex(), seed);
    let named = [
        ("control_points", json!(space.unknowns())),
        ("cap_coefficients", json!(space.caps().coefficients())),
        ("genus", json!(report.genus)),
        ("zeros", json!(report.zeros)),
        ("poles", json!(poles)),
        ("extraordinary_points", json!(domain.zeros().len() + poles)),
        ("cylinders", json!(domain.complex().cylinders().len())),
        ("closed_holes", json!(report.closed_holes)),
        ("collapsed", json!(report.collapsed)),
        ("thin", json!(report.thin)),
        ("straightened", json!(report.straightened)),
        ("least_height", json!(report.least_height)),
        ("period_defect", json!(report.period_defect)),
        ("closure", json!(report.closure)),
        ("area_defect", json!(report.area_defect)),
        ("energy", json!(report.energy)),
        ("leaves", json!(mesh.leaves().len())),
        ("t_junctions", json!(mesh.t_junctions().len())),
        ("refinement_depth", json!(depth(mesh))),
        ("unity_max", json!(unity_max(space, &points))),
        ("basis_sum_min", json!(basis_sum_min(space, &points))),
        ("samples", json!(points.len())),
    ];
    let named = named.map(|(name, value)| (name.to_owned(), value));
    let mut checks = BTreeMap::from(named);
    checks.extend(smoothness(surface.spline(), seed));
    checks.extend(independence(space, seed));
    checks
}

/// How often a face of a base grid was halved at most, in one direction.
fn depth(mesh: &TMesh) -> u8 {
    let levels = |leaf: &Leaf| leaf.level[0].max(leaf.level[1]);
    mesh.leaves().iter().map(levels).max().unwrap_or(0)
}

/// Returns relative jumps over lines of all kinds; nothing for caps where there are none.
fn smoothness(spline: &TSpline, seed: u64) -> BTreeMap<String, Value> {
    let options = ContinuityOptions {
        seed,
        ..ContinuityOptions::default()
    };
    let found = continuity(spline, &options);
    let outside = [found.borders, found.edges, found.rays, found.t_junctions];
    let caps = [found.cap_borders, found.core_borders, found.centres];
    let looked = |lines: &[Jumps]| lines.iter().map(|jumps| jumps.crossings).sum::<usize>();
    let capped = |jump: f64| (looked(&caps) > 0).then_some(jump);
    let named = [
        ("c2_jump_max", json!(found.c2_jump())),
        ("c1_jump_cap_max", json!(capped(found.cap_c1_jump()))),
        ("c2_jump_cap_max", json!(capped(found.cap_c2_jump()))),
        ("crossings", json!(looked(&outside) + looked(&caps))),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Returns how independent the functions are; no condition where rounding hides it.
fn independence(space: &TSplineSpace, seed: u64) -> BTreeMap<String, Value> {
    let found = gram(space, seed).ok();
    let named = [
        ("gram_condition", json!(found.and_then(|g| g.condition))),
        ("gram_independent", json!(found.map(|g| g.independent))),
        ("gram_idle", json!(found.map(|g| g.idle))),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Returns the errors at the boundary of a mesh over the longest side of its bounding box, and how many faces
/// there are turned over; nothing of a closed one.
pub(super) fn boundary(mesh: &TriangleMesh, at_vertices: &AtVertices) -> BTreeMap<String, Value> {
    let topology = mesh.topology();
    let [low, high] = mesh.bounding_box();
    let found = at_vertices.mesh.positions();
    let known = at_vertices.known.iter().copied();
    let squares: Vec<f64> = known
        .filter(|&v| topology.is_boundary_vertex(v))
        .map(|v| (found[v as usize] - mesh.positions()[v as usize]).norm_squared())
        .collect();
    if squares.is_empty() {
        return BTreeMap::new();
    }
    let side = (high - low).max();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    let max = squares.iter().copied().fold(0.0, f64::max);
    let is_turned = |face: &u32| {
        let [given, now] = [mesh, &at_vertices.mesh].map(|mesh| mesh.face_normal(*face));
        let corners = mesh.faces()[*face as usize];
        corners.iter().any(|&v| topology.is_boundary_vertex(v)) && given.dot(&now) <= 0.0
    };
    let turned = (0..mesh.face_count() as u32).filter(is_turned).count();
    let named = [
        ("boundary_vertices", json!(squares.len())),
        ("boundary_rms_unit_cube", json!(mean.sqrt() / side)),
        ("boundary_max_unit_cube", json!(max.sqrt() / side)),
        ("boundary_faces_turned", json!(turned)),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Points as dense everywhere on the cylinders.
fn random_points(complex: &CylinderComplex, seed: u64) -> Vec<Point> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let area = complex.area() as f64;
    let mut points = Vec::with_capacity(SAMPLES);
    let mut before = 0.0;
    for (cylinder, own) in (0..).zip(complex.cylinders()) {
        let size = [own.circumference, own.height].map(|n| n as f64);
        let share = |area_below: f64| (SAMPLES as f64 * area_below / area).round() as usize;
        let after = before + size[0] * size[1];
        for _ in share(before)..share(after) {
            let [x, y] = size.map(|side| side * random.random::<f64>());
            points.push(Point { cylinder, x, y });
        }
        before = after;
    }
    points
}

/// Returns by how much the spline of constant 1 differs from it at most.
fn unity_max(space: &std::sync::Arc<TSplineSpace>, points: &[Point]) -> f64 {
    let functions = space.functions().len();
    let mut control = vec![Vector3::zeros(); space.unknowns()];
    control[..functions].fill(Vector3::new(1.0, 0.0, 0.0));
    for cap in space.caps().caps() {
        // The first monomial of a cap is constant.
        control[functions + cap.offset as usize].x = 1.0;
    }
    let one = TSpline::new(std::sync::Arc::clone(space), control);
    let values = one.evaluate(points, Order::Value).positions;
    values.iter().map(|p| (p.x - 1.0).abs()).fold(0.0, f64::max)
}

/// Returns the least sum of the blending functions where it matters: outside of the cores of caps.
fn basis_sum_min(space: &TSplineSpace, points: &[Point]) -> f64 {
    let counts = |p: &&Point| space.caps().at(**p).is_none_or(|cap| cap.rest.0[0] > 0.0);
    let outside: Vec<Point> = points.iter().filter(counts).copied().collect();
    space
        .sums(&outside)
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// Returns the two-sided distance between the surface and a mesh.
pub(super) fn distance_to(
    surface: &TSplineSurface,
    mesh: &TriangleMesh,
    seed: u64,
) -> Result<Distance, RunError> {
    settled_distance(mesh, seed, |rounds| {
        let mesh = tessellation(surface, 1 << rounds)?;
        let is_finest = 4 * mesh.face_count() > MOST_TRIANGLES;
        Ok(Tessellated { mesh, is_finest })
    })
}
