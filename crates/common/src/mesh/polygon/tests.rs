//! Laws of Catmull-Clark surfaces.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::mesh::shapes::{box_surface, jittered, quad_patch, slab_with_holes, trapezohedron};

/// Rounding of a few refinements.
const ROUNDING: f64 = 1e-13;

fn control_meshes() -> Vec<PolygonMesh> {
    let poles = [3, 5, 6, 9].map(trapezohedron);
    let others = [box_surface([1, 2, 3]), slab_with_holes(2), quad_patch(4)];
    poles
        .into_iter()
        .chain(others)
        .enumerate()
        .map(|(seed, mesh)| jittered(&mesh, 0.12, seed as u64))
        .collect()
}

/// Tags every so many edges and vertices.
fn tagged(topology: &PolygonTopology, every: usize, sharpness: f64, rules: Rules) -> Sharpness {
    let mut tags = Sharpness::smooth(topology, rules);
    for edge in (0..topology.edge_count() as u32).step_by(every) {
        if !topology.is_boundary_edge(edge) {
            tags.set_edge(edge, sharpness);
        }
    }
    for vertex in (0..topology.vertex_count() as u32).step_by(4 * every) {
        tags.set_vertex(vertex, sharpness);
    }
    tags
}

fn refined(mesh: &PolygonMesh, sharpness: &Sharpness, rules: Rules, levels: u32) -> Refined {
    (0..levels).fold(Refined::none(mesh.topology(), sharpness), |r, _| {
        r.again(rules)
    })
}

#[test]
fn the_limit_of_a_vertex_is_that_of_its_refinement() {
    for mesh in control_meshes() {
        for (every, sharpness) in [
            (100, 0.0),
            (3, f64::INFINITY),
            (7, f64::INFINITY),
            (3, 2.4),
            (5, 0.6),
        ] {
            for creases in [CreaseRule::Uniform, CreaseRule::Chaikin] {
                let rules = Rules {
                    creases,
                    ..Rules::default()
                };
                let tags = tagged(mesh.topology(), every, sharpness, rules);
                let limits = [1, 3].map(|levels| {
                    limit_stencils(&refined(&mesh, &tags, rules, levels), rules)
                        .apply(mesh.positions())
                });
                for (one, three) in limits[0].iter().zip(&limits[1]) {
                    assert!(
                        (one - three).norm() < ROUNDING,
                        "{one} {three} {sharpness} {every}"
                    );
                }
            }
        }
    }
}

#[test]
fn dart_masks_are_those_worked_out_by_hand_for_valence_four() {
    let mesh = quad_patch(4);
    let mut tags = Sharpness::smooth(mesh.topology(), Rules::default());
    let centre = 12;
    let spoke = mesh.topology().outgoing(centre).next().expect("an edge");
    tags.set_edge(mesh.topology().edge(spoke), f64::INFINITY);
    let limit = limit_stencils(&Refined::none(mesh.topology(), &tags), Rules::default());
    let weight = |v: u32| {
        let (indices, weights) = limit.row(centre as usize);
        weights[indices.iter().position(|&i| i == v).expect("in the ring")]
    };
    // From the eigenvalue equation, to five digits.
    let spokes: Vec<u32> = mesh.topology().neighbours(centre).collect();
    for (found, expected) in [
        (weight(centre), 0.46766),
        (weight(spokes[0]), 0.13060),
        (weight(spokes[1]), 0.09950),
        (weight(spokes[2]), 0.11194),
        (weight(spokes[3]), 0.09950),
    ] {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
}

#[test]
fn tangents_span_what_a_refined_ring_becomes() {
    /// Where the next eigenvalue comes near, the steps leave this much of its vector.
    const REST: f64 = 1e-3;
    for mesh in control_meshes() {
        for (every, sharpness) in [(100, 0.0), (3, f64::INFINITY), (7, f64::INFINITY), (4, 1.7)] {
            let rules = Rules::default();
            let tags = tagged(mesh.topology(), every, sharpness, rules);
            let coarse = refined(&mesh, &tags, rules, 1);
            let positions = coarse.stencils.apply(mesh.positions());
            let half_edges: Vec<u32> = (0..coarse.topology.half_edge_count() as u32).collect();
            let tangents = limit_tangent_stencils(&coarse, &half_edges, rules);
            let tangents = tangents.apply(mesh.positions());
            for h in half_edges {
                let [a, b] = [2 * h, 2 * h + 1].map(|i| tangents[i as usize].coords);
                let normal = a.cross(&b).normalize();
                for direction in directions(&coarse, h, &positions) {
                    let sine = direction.dot(&normal).abs();
                    assert!(
                        sine < REST,
                        "{sine} at half-edge {h}, {sharpness} of every {every}"
                    );
                }
            }
        }
    }
}

/// More would leave only rounding of what a smaller eigenvalue scales.
const STEPS: usize = 70;

/// Returns the directions from a vertex to the edges of a face, after its ring has been refined many
/// times; none where no plane exists: at corners and in creased sectors of more than three faces.
fn directions(mesh: &Refined, h: u32, positions: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    let topology = &mesh.topology;
    let v = topology.origin(h);
    let mut ring = ring::Ring::of(topology, &mesh.sharpness, v, CreaseRule::Uniform);
    let n = ring.edges.len();
    let opposite = |h: u32| topology.origin(topology.next(topology.next(h)));
    let vertices = std::iter::once(v)
        .chain(topology.neighbours(v))
        .chain(topology.outgoing(v).map(opposite));
    let rows: Vec<_> = vertices
        .map(|v| positions[v as usize].coords.transpose())
        .collect();
    let mut points = nalgebra::OMatrix::<f64, nalgebra::Dyn, nalgebra::U3>::from_rows(&rows);
    for _ in 0..STEPS {
        let next = ring.refined(CreaseRule::Uniform);
        points = ring.matrix(&next) * points;
        ring = next;
        // Only directions matter, and small differences would drown in rounding.
        let here = points.row(0).clone_owned();
        points.row_iter_mut().for_each(|mut row| row -= &here);
        let size = points.norm();
        points /= size;
    }
    let place = topology
        .outgoing(v)
        .position(|x| x == h)
        .expect("it leaves");
    let wide = match ring.rule() {
        ring::Rule::Corner => true,
        ring::Rule::Crease([a, b]) => {
            let inside = if (a..b).contains(&place) {
                b - a
            } else {
                n + a - b
            };
            !(2..=3).contains(&inside)
        }
        ring::Rule::Smooth | ring::Rule::Dart => false,
    };
    if wide {
        return Vec::new();
    }
    [place, (place + 1) % n]
        .map(|j| points.row(1 + j).transpose().normalize())
        .to_vec()
}

#[test]
fn grids_meet_along_edges_and_have_the_corners_of_their_faces() {
    let mesh = slab_with_holes(1);
    let fine = refined(
        &mesh,
        &Sharpness::smooth(mesh.topology(), Rules::default()),
        Rules::default(),
        2,
    );
    let grids = face_grids(mesh.topology(), &fine.topology, 2);
    for (face, grid) in grids.iter().enumerate() {
        let corners = mesh.topology().face_vertices(face as u32);
        assert_eq!([grid[0], grid[4], grid[24], grid[20]], corners);
        for (h, cells) in [(0, [0, 1, 2, 3, 4]), (2, [24, 23, 22, 21, 20])] {
            let twin = mesh.topology().twin(4 * face as u32 + h);
            let other = &grids[(twin / 4) as usize];
            let side: Vec<u32> = cells.map(|c| grid[c]).to_vec();
            let sides = [
                [4, 3, 2, 1, 0],
                [24, 19, 14, 9, 4],
                [20, 21, 22, 23, 24],
                [0, 5, 10, 15, 20],
            ];
            let met: Vec<u32> = sides[(twin % 4) as usize].map(|c| other[c]).to_vec();
            assert_eq!(side, met);
        }
    }
}

#[test]
fn a_refined_topology_is_the_one_built_from_its_faces() {
    for mesh in control_meshes() {
        let fine = mesh.topology().cut_into_quads();
        let corners: Vec<u32> = fine.faces().flatten().copied().collect();
        let offsets = (0..=fine.face_count() as u32).map(|f| 4 * f).collect();
        let built = PolygonTopology::build(fine.vertex_count(), corners, offsets).expect("quads");
        assert_eq!(built.boundary_loops(), fine.boundary_loops());
        for h in 0..fine.half_edge_count() as u32 {
            assert_eq!([built.twin(h), built.edge(h)], [fine.twin(h), fine.edge(h)]);
        }
        for v in 0..fine.vertex_count() as u32 {
            assert_eq!(fine.origin(fine.vertex_half_edge(v)), v);
            assert_eq!(fine.outgoing(v).count(), built.outgoing(v).count());
        }
    }
}

#[test]
fn polygons_become_quads_in_one_step() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ]
    .map(Point3::from);
    let corners = vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];
    let mesh = PolygonMesh::build(positions.to_vec(), corners, vec![0, 3, 6, 9, 12])
        .expect("a tetrahedron");
    let error = mesh.check_quads().expect_err("triangles").to_string();
    assert_eq!(
        error,
        "face 0 of the control mesh has 3 corners, and 3 others are not quads either; refine them into quads first"
    );
    let fine = refined(
        &mesh,
        &Sharpness::smooth(mesh.topology(), Rules::default()),
        Rules::default(),
        1,
    );
    assert!(fine.topology.is_quad());
    assert_eq!(fine.topology.euler_characteristic(), 2);
}

#[test]
fn what_tags_cannot_mean_is_refused_with_its_number() {
    let mesh = box_surface([1, 1, 1]);
    let build = |vertices, sharpness| {
        let good = CreaseTag {
            vertices: [0, 1],
            sharpness: 1.0,
        };
        let tags = [
            good,
            CreaseTag {
                vertices,
                sharpness,
            },
        ];
        Sharpness::build(mesh.topology(), Rules::default(), &tags)
    };
    assert!(build([0, 0], 3.0).is_ok());
    for (vertices, sharpness, text) in [
        ([0, 8], 1.0, "vertex 8"),
        ([0, 6], 1.0, "no edge joins"),
        ([0, 1], -1.0, "-1"),
        ([0, 1], f64::NAN, "NaN"),
    ] {
        let error = build(vertices, sharpness).expect_err("refused");
        assert_eq!(error.tag(), 1);
        assert!(error.to_string().contains(text), "{error}");
    }
}

#[test]
fn chaikins_rule_averages_semi_sharp_edges_and_no_others() {
    let mesh = quad_patch(4);
    let topology = mesh.topology();
    let rules = Rules {
        creases: CreaseRule::Chaikin,
        ..Rules::default()
    };
    let mut tags = Sharpness::smooth(topology, rules);
    let ends: Vec<u32> = topology.neighbours(12).collect();
    let spoke = |end: u32| topology.edge_between(12, end).expect("a spoke");
    for (&end, sharpness) in ends.iter().zip([2.0, 0.5, 3.5, f64::INFINITY]) {
        tags.set_edge(spoke(end), sharpness);
    }
    let fine = catmull_clark(topology, &tags, rules);
    let piece = |end: u32, at: u32| {
        let middle = topology.vertex_count() as u32 + spoke(end);
        let edge = fine.topology.edge_between(at, middle).expect("a piece");
        fine.sharpness.edge(edge)
    };
    assert_eq!([0, 1, 2].map(|i| piece(ends[i], 12)), [1.0, 0.0625, 1.9375]);
    assert_eq!(piece(ends[3], 12), f64::INFINITY);
    // At their far ends nothing else is sharp.
    assert_eq!([0, 1, 2].map(|i| piece(ends[i], ends[i])), [1.0, 0.0, 2.5]);
}

#[test]
fn an_edge_that_stays_sharp_on_both_sides_has_its_midpoint() {
    let mesh = jittered(&quad_patch(4), 0.1, 3);
    let topology = mesh.topology();
    let rules = Rules {
        creases: CreaseRule::Chaikin,
        ..Rules::default()
    };
    let mut tags = Sharpness::smooth(topology, rules);
    let edge = |a: u32, b: u32| topology.edge_between(a, b).expect("an edge");
    for [a, b] in [[6, 11], [11, 12], [12, 13], [13, 8]] {
        tags.set_edge(edge(a, b), 4.0);
    }
    tags.set_edge(edge(11, 12), 0.5);
    let fine = catmull_clark(topology, &tags, rules);
    let middle = fine
        .stencils
        .row(topology.vertex_count() + edge(11, 12) as usize);
    assert_eq!(middle, (&[11, 12][..], &[0.5, 0.5][..]));
}

#[test]
fn a_tag_does_not_soften_a_sharp_corner_of_the_boundary() {
    let mesh = quad_patch(2);
    for (corners, expected) in [
        (BoundaryCorners::Sharp, f64::INFINITY),
        (BoundaryCorners::Smooth, 1.5),
    ] {
        let rules = Rules {
            corners,
            ..Rules::default()
        };
        let tag = CreaseTag {
            vertices: [0, 0],
            sharpness: 1.5,
        };
        let tags = Sharpness::build(mesh.topology(), rules, &[tag]).expect("tags fit");
        assert_eq!(tags.vertex(0), expected);
    }
}

proptest! {
    #[test]
    fn stencils_sum_to_one_and_a_plane_stays_one(every in 1usize..9, sharpness in 0.0f64..4.0) {
        let mesh = jittered(&box_surface([1, 2, 2]), 0.1, 5);
        let rules = Rules::default();
        let tags = tagged(mesh.topology(), every, sharpness, rules);
        let limit = limit_stencils(&refined(&mesh, &tags, rules, 2), rules);
        for row in 0..limit.len() {
            let sum: f64 = limit.row(row).1.iter().sum();
            prop_assert!((sum - 1.0).abs() < ROUNDING);
        }
    }
}
