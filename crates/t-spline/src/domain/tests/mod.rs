//! Domains of surfaces whose structure is known.

mod flat;
mod open;
mod refusals;
mod snapping;
mod surfaces;

use msplines_common::mesh::{NONE, SurfacePoint, Topology};

use crate::complex::Point;

use super::Domain;

/// Distance of two points that lie on the same cylinder after a small step up or down, in units.
fn distance(domain: &Domain, a: Point, b: Point) -> f64 {
    let complex = domain.complex();
    let mut least = f64::INFINITY;
    for step in [0.0, 1e4, -1e4] {
        let [a, b] = [a, b].map(|p| complex.walk(p, [0.0, step]).0);
        if a.cylinder == b.cylinder {
            let size = complex.cylinders()[a.cylinder as usize].circumference as f64;
            let across = (a.x - b.x + 0.5 * size).rem_euclid(size) - 0.5 * size;
            least = least.min(across.abs().max((a.y - b.y).abs()));
        }
    }
    least
}

/// The farthest that points of an edge lie apart as points of its two faces, in units.
fn farthest_jump(domain: &Domain) -> f64 {
    let topology: &Topology = domain.mesh().topology();
    let mut farthest = 0.0_f64;
    for half_edge in 0..3 * topology.face_count() as u32 {
        let twin = topology.twin(half_edge);
        if twin == NONE || twin < half_edge {
            continue;
        }
        for share in [0.03, 0.31, 0.5, 0.77] {
            let on = |half_edge: u32, share: f64| {
                let mut at = [0.0; 3];
                at[half_edge as usize % 3] = 1.0 - share;
                at[Topology::next(half_edge) as usize % 3] = share;
                let face = half_edge / 3;
                domain.place(&SurfacePoint { face, at })
            };
            let [a, b] = [on(half_edge, share), on(twin, 1.0 - share)];
            let apart = distance(domain, a, b);
            assert!(
                apart.is_finite(),
                "edge of half-edge {half_edge}: {a:?} and {b:?}"
            );
            farthest = farthest.max(apart);
        }
    }
    farthest
}

/// The farthest that a vertex lies from the corners of its faces, in units; zeros lie on several borders.
fn farthest_vertex(domain: &Domain) -> f64 {
    let corners = domain.mesh().faces().iter().enumerate();
    let is_zero = |vertex| domain.zeros().iter().any(|zero| zero.vertex == vertex);
    let apart = corners.flat_map(|(face, corners)| {
        let inner = (0..3).filter(move |&i| !is_zero(corners[i]));
        inner.map(move |i| {
            let mut at = [0.0; 3];
            at[i] = 1.0;
            let face = face as u32;
            let corner = domain.place(&SurfacePoint { face, at });
            distance(domain, corner, domain.vertex(corners[i]))
        })
    });
    apart.fold(0.0, f64::max)
}
