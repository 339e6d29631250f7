//! Darts and creased sectors, where OpenSubdiv's masks are not the limits of its refinements.

use msplines_common::mesh::polygon::{PolygonMesh, Refined, Rules, Sharpness, limit_stencils};
use msplines_reference::Library;
use msplines_reference::polygon::opensubdiv;
use msplines_reference::record::Comparison;
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::cases::ROUNDING;
use crate::limits::our_normals;

/// A vertex and its faces, which OpenSubdiv refines again and again: only the ring stays.
struct Ring {
    mesh: PolygonMesh,
    sharpness: Sharpness,
}

impl Ring {
    /// Returns the closed ring of quads of random points, with some spokes sharp for ever.
    fn random(valence: u32, sharp: &[u32], seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut jitter = || random.random_range(-0.2..0.2);
        let turn = std::f64::consts::TAU / f64::from(valence);
        let mut place = |radius: f64, angle: f64| {
            let (x, y) = (radius * angle.cos(), radius * angle.sin());
            Point3::new(x + jitter(), y + jitter(), jitter())
        };
        let mut points = vec![place(0.0, 0.0)];
        for (radius, shift) in [(1.0, 0.0), (1.4, 0.5)] {
            points.extend((0..valence).map(|j| place(radius, turn * (f64::from(j) + shift))));
        }
        let faces: Vec<[u32; 4]> = (0..valence)
            .map(|j| [0, 1 + j, 1 + valence + j, 1 + (j + 1) % valence])
            .collect();
        let mesh = PolygonMesh::from_quads(points, &faces).expect("a disk");
        let mut sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
        for &j in sharp {
            let edge = mesh.topology().edge_between(0, 1 + j).expect("a spoke");
            sharpness.set_edge(edge, f64::INFINITY);
        }
        Self { mesh, sharpness }
    }

    fn valence(&self) -> u32 {
        self.mesh.face_count() as u32
    }

    /// Returns the ring after one refinement by OpenSubdiv.
    fn refined(&self) -> Self {
        let topology = self.mesh.topology();
        let (levels, _) = opensubdiv(&self.mesh, &self.sharpness, Rules::default(), 1);
        let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
        let spoke = |j: u32| topology.edge_between(0, 1 + j).expect("a spoke") as usize;
        let mut points = vec![levels[0][0]];
        points.extend((0..self.valence()).map(|j| levels[0][vertices + spoke(j)]));
        points.extend((0..self.valence() as usize).map(|j| levels[0][vertices + edges + j]));
        Self {
            mesh: self.mesh.with_positions(points),
            sharpness: self.sharpness.clone(),
        }
    }

    /// Returns the ring with its vertex at the origin and the farthest neighbour at distance one.
    fn scaled(&self) -> Self {
        let points = self.mesh.positions();
        let here = points[0].coords;
        let size = points.iter().map(|p| (p.coords - here).norm());
        let size = size.fold(0.0, f64::max);
        let scaled = points
            .iter()
            .map(|p| Point3::from((p.coords - here) / size));
        Self {
            mesh: self.mesh.with_positions(scaled.collect()),
            sharpness: self.sharpness.clone(),
        }
    }

    fn as_refined(&self) -> Refined {
        Refined::none(self.mesh.topology(), &self.sharpness)
    }

    /// Returns the limit and the normal that OpenSubdiv's masks give after one refinement.
    fn their_limit(&self) -> (Point3<f64>, Vector3<f64>) {
        let (_, limits) = opensubdiv(&self.mesh, &self.sharpness, Rules::default(), 1);
        let [a, b] = limits.tangents[0];
        (limits.positions[0], a.cross(&b).normalize())
    }
}

/// Valences of darts that are looked at.
const DARTS: [u32; 6] = [3, 4, 5, 6, 8, 12];
/// Refinements after which a dart is where it goes: the slowest eigenvalue is below 0.8.
const MANY: usize = 200;

#[test]
fn darts_tend_to_our_limit_and_not_to_opensubdivs() {
    let mut comparison = Comparison::new(
        "limits of darts refined many times",
        Library::OpenSubdiv,
        ROUNDING,
        "in lengths of an edge: refined until nothing moves any more",
    );
    for valence in DARTS {
        let (mut mask, mut few) = (0.0_f64, 0.0_f64);
        for seed in 0..5 {
            let start = Ring::random(valence, &[1], seed);
            let ours = limit_stencils(&start.as_refined(), Rules::default());
            let ours = ours.point(0, start.mesh.positions());
            let mut ring = start.refined();
            (1..8).for_each(|_| ring = ring.refined());
            few = few.max((ours - ring.mesh.positions()[0]).norm());
            (8..MANY).for_each(|_| ring = ring.refined());
            let limit = ring.mesh.positions()[0];
            comparison.add(&format!("valence {valence}"), [(ours - limit).norm()]);
            mask = mask.max((start.their_limit().0 - limit).norm());
        }
        println!("dart of valence {valence}: 8 levels {few:.1e}, OpenSubdiv's mask {mask:.1e} off");
        assert!(mask > 1e-4, "its mask at darts has become the limit");
    }
    comparison.finish();
}

/// Returns the largest sine between a plane and the directions of a sector's first edges.
fn sine(normal: &Vector3<f64>, ring: &Ring, edges: std::ops::RangeInclusive<u32>) -> f64 {
    let points = ring.mesh.positions();
    let direction = |j: u32| {
        let place = 1 + j % ring.valence();
        (points[place as usize] - points[0]).normalize()
    };
    edges
        .map(|j| direction(j).dot(normal).abs())
        .fold(0.0, f64::max)
}

#[test]
fn tangent_planes_of_darts_and_irregular_sectors_are_ours_and_not_opensubdivs() {
    /// Where the next eigenvalue comes near, the steps leave this much of its vector.
    const REST: f64 = 1e-5;
    let mut comparison = Comparison::new(
        "tangent planes of darts and creased sectors",
        Library::OpenSubdiv,
        REST,
        "sine of the angle to the edges of a ring after 60 refinements",
    );
    // Sharp spokes, and the first and last edge of the sector that is looked at: a crease has a
    // tangent plane up to three faces.
    let cases: [(&str, u32, &[u32], u32); 7] = [
        ("dart", 3, &[0], 3),
        ("dart", 4, &[0], 4),
        ("dart", 5, &[0], 5),
        ("dart", 7, &[0], 7),
        ("crease, 2 faces", 4, &[0, 2], 2),
        ("crease, 2 faces", 5, &[0, 2], 2),
        ("crease, 3 faces", 5, &[0, 3], 3),
    ];
    for (name, valence, sharp, last) in cases {
        let name = format!("{name}, valence {valence}");
        let (mut ours_off, mut theirs_off) = (0.0_f64, 0.0_f64);
        for seed in 0..5 {
            let start = Ring::random(valence, sharp, seed);
            let mesh = start.as_refined();
            let mut outgoing = mesh.topology.outgoing(0);
            let half_edge = outgoing.find(|&h| mesh.topology.target(h) == 1);
            let half_edge = half_edge.expect("the first spoke");
            let points = start.mesh.positions();
            let ours = our_normals(&mesh, &[half_edge], Rules::default(), points)[0];
            let mut ring = start.refined();
            (1..60).for_each(|_| ring = ring.scaled().refined());
            let (_, theirs) = start.their_limit();
            let off = sine(&ours, &ring, 0..=last);
            comparison.add(&name, [off]);
            ours_off = ours_off.max(off);
            theirs_off = theirs_off.max(sine(&theirs, &ring, 0..=last));
        }
        println!("{name}: ours {ours_off:.1e}, OpenSubdiv's {theirs_off:.1e} off");
    }
    comparison.finish();
}
