//! Surfaces over networks whose true surface is known.
//!
//! The network is made of curves on a Catmull-Clark surface; points of the fit are compared with the
//! nearest points of that surface, lengths in mean arc lengths.

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::polygon::{
    PolygonMesh, Refined, Rules, Sharpness, limit_stencils, limit_tangent_stencils,
};
use msplines_common::mesh::shapes::{
    box_surface, dome_network, jittered, limit_network, mushroom_network, slab_with_holes,
};
use msplines_common::mesh::{SurfacePoint, curves::CurveNetwork};
use msplines_common::metrics::SurfaceTree;
use msplines_common::progress::unobserved;
use nalgebra::Vector3;

use super::*;

/// Catmull-Clark steps of the true surface: its triangles are then about 1e-4 away from it.
const LEVELS: u32 = 5;

/// Cells along an edge of a face whose centres are compared.
const CELLS: u32 = 8;

/// A Catmull-Clark surface.
struct Truth {
    tree: SurfaceTree,
    /// Normals at the corners of the triangles.
    normals: Vec<[Vector3<f64>; 3]>,
}

/// How far a surface is from the truth.
#[derive(Debug)]
#[allow(dead_code, reason = "read through its text")]
struct Error {
    rms: f64,
    max: f64,
    normals: f64,
    normals_max: f64,
}

impl Truth {
    fn of(mesh: &PolygonMesh, sharpness: &Sharpness) -> Self {
        let rules = Rules::default();
        let start = Refined::none(mesh.topology(), sharpness);
        let refined = (0..LEVELS).fold(start, |r, _| r.again(rules));
        let points = limit_stencils(&refined, rules).apply(mesh.positions());
        let half_edges: Vec<u32> = (0..refined.topology.half_edge_count() as u32).collect();
        let tangents = limit_tangent_stencils(&refined, &half_edges, rules);
        let tangents = tangents.apply(mesh.positions());
        let normal = |h: usize| {
            let [u, v] = [2 * h, 2 * h + 1].map(|i| tangents[i].coords);
            u.cross(&v).normalize()
        };
        let (mut triangles, mut normals) = (Vec::new(), Vec::new());
        for (face, corners) in refined.topology.faces().enumerate() {
            for half in [[0, 1, 2], [0, 2, 3]] {
                triangles.push(half.map(|c| corners[c]));
                normals.push(half.map(|c| normal(4 * face + c)));
            }
        }
        let mesh = TriangleMesh::build(points, triangles).expect("a surface");
        Self {
            tree: SurfaceTree::build(&mesh),
            normals,
        }
    }

    fn error(&self, fit: &NetworkFit) -> Error {
        let step = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
        let faces = 0..fit.domain.mesh.face_count() as u32;
        let at = |face: u32, i: u32| SurfacePoint {
            face,
            at: [step(i % CELLS), step(i / CELLS), 0.0],
        };
        let points: Vec<SurfacePoint> = faces
            .flat_map(|face| (0..CELLS * CELLS).map(move |i| at(face, i)))
            .collect();
        let found = fit.spline.geometry(&points).expect("points of faces");
        let (mut squares, mut max, mut angles, mut steepest) = (0.0, 0.0f64, 0.0, 0.0f64);
        for geometry in &found {
            let Some(foot) = self.tree.closest(&geometry.position) else {
                return Error {
                    rms: f64::INFINITY,
                    max: f64::INFINITY,
                    normals: 180.0,
                    normals_max: 180.0,
                };
            };
            let corners = self.normals[foot.point.face as usize];
            let true_normal: Vector3<f64> =
                corners.iter().zip(foot.point.at).map(|(n, b)| n * b).sum();
            let angle = true_normal.angle(&geometry.normal).to_degrees();
            squares += foot.distance * foot.distance;
            max = max.max(foot.distance);
            angles += angle;
            steepest = steepest.max(angle);
        }
        let count = found.len() as f64;
        let unit = fit.report.unit;
        Error {
            rms: (squares / count).sqrt() / unit,
            max: max / unit,
            normals: angles / count,
            normals_max: steepest,
        }
    }
}

fn smooth(mesh: &PolygonMesh) -> Sharpness {
    Sharpness::smooth(mesh.topology(), Rules::default())
}

fn fitted(network: &CurveNetwork, options: &NetworkOptions) -> NetworkFit {
    surface_network(network, options, &mut unobserved()).expect("a surface")
}

#[test]
fn explore() {
    let say = |name: &str,
               truth: Option<&Truth>,
               network: &CurveNetwork,
               options: &NetworkOptions| {
        let start = std::time::Instant::now();
        let fit = fitted(network, options);
        let time = start.elapsed().as_secs_f64();
        let r = &fit.report;
        println!(
            "{name}: curve {:.2e}/{:.2e} kink {:.2}/{:.2} turn {:.2}/{:.2} bend {:.3} c0 {:.1}/{:.1} rounds {} {:?} {:.2}s {:?} {:?}",
            r.curve_rms,
            r.curve_max,
            r.kink_mean_degrees,
            r.kink_max_degrees,
            r.turn_mean_degrees,
            r.turn_max_degrees,
            r.bending,
            r.c0_atoms_crease,
            r.c0_atoms_smooth,
            r.fill_rounds,
            r.outcome,
            time,
            truth.map(|t| t.error(&fit)),
            r.warnings
        );
    };
    let default = NetworkOptions::default();
    let two = |fill| NetworkOptions {
        method: SurfaceMethod::TwoStep,
        fill,
        ..NetworkOptions::default()
    };
    let paper = NetworkOptions::PAPER;
    let mesh = slab_with_holes(2);
    let s = smooth(&mesh);
    let truth = Truth::of(&mesh, &s);
    let network = limit_network(&mesh, &s, 3, 0.0, 1).network;
    say("genus2 one", Some(&truth), &network, &default);
    for b in [0.1, 0.01, 16.0] {
        say(
            &format!("genus2 one {b}"),
            Some(&truth),
            &network,
            &NetworkOptions {
                bending: Some(b),
                ..default.clone()
            },
        );
    }
    say(
        "genus2 biuni",
        Some(&truth),
        &network,
        &two(FillEnergy::Uniform),
    );
    say(
        "genus2 bi",
        Some(&truth),
        &network,
        &two(FillEnergy::Cotangent),
    );
    say("genus2 paper", Some(&truth), &network, &paper);
    for seed in [1, 2] {
        let network = limit_network(&mesh, &s, 3, 0.3, seed).network;
        say("genus2 30%", Some(&truth), &network, &default);
        say(
            "genus2 30% one",
            Some(&truth),
            &network,
            &NetworkOptions {
                method: SurfaceMethod::OneStep,
                ..default.clone()
            },
        );
    }
    let mesh = jittered(&box_surface([1, 2, 3]), 0.12, 3);
    let s = crate::tests::creased(&mesh);
    let truth = Truth::of(&mesh, &s);
    let network = limit_network(&mesh, &s, 3, 0.0, 1).network;
    for c0_atoms in [C0Atoms::Gated, C0Atoms::With, C0Atoms::Without] {
        for method in [SurfaceMethod::OneStep, SurfaceMethod::TwoStep] {
            say(
                &format!("creased {c0_atoms:?} {method:?}"),
                Some(&truth),
                &network,
                &NetworkOptions {
                    c0_atoms,
                    method,
                    ..default.clone()
                },
            );
        }
    }
    let s = smooth(&mesh);
    let truth = Truth::of(&mesh, &s);
    let network = limit_network(&mesh, &s, 3, 0.0, 1).network;
    say("box one", Some(&truth), &network, &default);
    say(
        "box bi",
        Some(&truth),
        &network,
        &two(FillEnergy::Cotangent),
    );
    say("box paper", Some(&truth), &network, &paper);
    say("dome", None, &dome_network(4).network, &default);
    say(
        "mushroom",
        None,
        &mushroom_network(12, msplines_common::mesh::shapes::Opening::Open).network,
        &default,
    );
}
