//! Random faces: what is a mesh becomes one, and all else is refused with its place.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness, catmull_clark};
use msplines_common::mesh::{
    Policy, PolygonSoup, PreflightError, Topology, TopologyError, TriangleMesh, accept,
    double_cover, preflight,
};
use proptest::prelude::*;

use crate::oracle;

/// Returns triangles without order, some of which name vertices that do not exist.
fn triangles() -> impl Strategy<Value = (usize, Vec<[u32; 3]>)> {
    (1usize..8).prop_flat_map(|n| {
        let corner = 0..n as u32 + 1;
        let face = [corner.clone(), corner.clone(), corner];
        (Just(n), prop::collection::vec(face, 0..9))
    })
}

/// Returns triangles of which most sets are meshes: proposals, of which only those are kept that run
/// along no side in the direction of another, over the vertices that they use.
pub(crate) fn glued() -> impl Strategy<Value = (usize, Vec<[u32; 3]>)> {
    let face = [0u32..7, 0u32..7, 0u32..7];
    prop::collection::vec(face, 1..40).prop_map(|proposals| {
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for [a, b, c] in proposals {
            let mut with = faces.clone();
            with.push([a, b, c]);
            let used = compacted(&with);
            // A bow tie may be filled by a later face, so half of them stay.
            let bow_ties_stay = a % 2 == 0;
            let sides = with.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let sides: std::collections::BTreeSet<_> = sides.collect();
            let distinct = a != b && b != c && c != a && sides.len() == 3 * with.len();
            if distinct && (bow_ties_stay || oracle::is_manifold(used.0, &used.1)) {
                faces = with;
            }
        }
        compacted(&faces)
    })
}

/// Returns the faces over only those vertices that they use.
fn compacted(faces: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
    let used: std::collections::BTreeSet<u32> = faces.as_flattened().iter().copied().collect();
    let used: Vec<u32> = used.into_iter().collect();
    let new = |v: u32| used.binary_search(&v).expect("a used vertex") as u32;
    (used.len(), faces.iter().map(|face| face.map(new)).collect())
}

/// Returns meshes of few vertices, closed or not, in one piece or several, at random places.
pub(crate) fn meshes() -> impl Strategy<Value = TriangleMesh> {
    let place = prop::array::uniform3(-1.0..1.0f64);
    (glued(), prop::collection::vec(place, 7)).prop_filter_map("no mesh", |((n, faces), places)| {
        let positions = places[..n].iter().map(|&p| Point3::from(p)).collect();
        let is_mesh = n > 0 && oracle::is_manifold(n, &faces);
        is_mesh.then(|| TriangleMesh::build(positions, faces).expect("the oracle accepts it"))
    })
}

/// Whether the error names a place where the faces are really broken.
fn is_true(error: &TopologyError, vertices: usize, faces: &[[u32; 3]]) -> bool {
    let face = |face: u32| faces[face as usize];
    match *error {
        TopologyError::IndexOutOfRange {
            face: at, vertex, ..
        } => face(at).contains(&vertex) && vertex as usize >= vertices,
        TopologyError::RepeatedVertex { face: at, vertex } => {
            face(at).iter().filter(|&&v| v == vertex).count() > 1
        }
        TopologyError::EdgeNotManifold {
            from,
            to,
            first,
            second,
        } => first != second && [first, second].iter().all(|&f| joins(face(f), from, to)),
        TopologyError::VertexNotManifold { vertex } => faces.as_flattened().contains(&vertex),
        TopologyError::UnreferencedVertex { vertex } => !faces.as_flattened().contains(&vertex),
        _ => false,
    }
}

fn joins(face: [u32; 3], from: u32, to: u32) -> bool {
    face.contains(&from) && face.contains(&to)
}

/// Returns polygons of up to five corners whose points lie on a coarse lattice, so that points coincide,
/// corners are flat and faces have no area; some coordinates are no numbers.
fn polygons() -> impl Strategy<Value = PolygonSoup> {
    let at =
        prop_oneof![40 => (0..3i32).prop_map(f64::from), 1 => Just(f64::NAN), 1 => Just(1e300)];
    let points = prop::collection::vec([at.clone(), at.clone(), at], 1..9);
    let face = prop::collection::vec(-1i64..9, 0..6);
    (points, prop::collection::vec(face, 0..12)).prop_map(|(points, faces)| {
        let positions = points.into_iter().map(Point3::from).collect();
        let mut soup = PolygonSoup {
            positions,
            ..PolygonSoup::default()
        };
        faces.into_iter().for_each(|face| soup.push_face(face));
        soup
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn faces_are_a_mesh_or_refused_with_a_true_place((n, faces) in triangles()) {
        match Topology::build(n, faces.clone()) {
            Ok(topology) => {
                prop_assert!(oracle::is_manifold(n, &faces));
                oracle::check(&topology);
            }
            Err(error) => {
                prop_assert!(!oracle::is_manifold(n, &faces), "refused: {error}");
                prop_assert!(is_true(&error, n, &faces), "not true: {error}");
            }
        }
    }

    #[test]
    fn glued_faces_are_a_mesh_or_refused_with_a_true_place((n, faces) in glued()) {
        match Topology::build(n, faces.clone()) {
            Ok(topology) => {
                prop_assert!(oracle::is_manifold(n, &faces));
                oracle::check(&topology);
            }
            Err(error) => {
                prop_assert!(!oracle::is_manifold(n, &faces), "refused: {error}");
                prop_assert!(is_true(&error, n, &faces), "not true: {error}");
            }
        }
    }

    #[test]
    fn the_double_cover_is_closed_and_has_twice_the_characteristic(mesh in meshes()) {
        let topology = mesh.topology();
        if let Ok((cover, _)) = double_cover(&mesh) {
            oracle::check(cover.topology());
            prop_assert!(cover.topology().boundary_loops().is_empty());
            // The boundary, whose characteristic is zero, is not doubled.
            let euler = cover.topology().euler_characteristic();
            prop_assert_eq!(euler, 2 * topology.euler_characteristic());
        }
    }

    #[test]
    fn any_polygons_are_refused_or_accepted_and_repair_leaves_nothing_to_do(soup in polygons()) {
        let clean = preflight(&soup).defects.is_empty();
        let refused = accept(&soup, Policy::Refuse);
        prop_assert_eq!(clean, !matches!(refused, Err(PreflightError::Defects { .. })));
        if let Ok(accepted) = refused {
            oracle::check(accepted.mesh.topology());
            prop_assert_eq!(accepted.mesh.vertex_count(), soup.positions.len());
        }
        match accept(&soup, Policy::Repair) {
            Ok(accepted) => {
                oracle::check(accepted.mesh.topology());
                let mesh = &accepted.mesh;
                let again = PolygonSoup::from_triangles(mesh.positions().to_vec(), mesh.faces());
                prop_assert_eq!(preflight(&again).defects, vec![]);
                let twice = accept(&again, Policy::Repair).expect("repaired before");
                prop_assert_eq!(twice.mesh.faces(), mesh.faces());
                prop_assert_eq!(twice.repairs, vec![]);
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn any_polygons_are_a_control_mesh_or_refused(soup in polygons()) {
        if let Ok(mesh) = PolygonMesh::accept(&soup) {
            let topology = mesh.topology();
            let euler = topology.vertex_count() as i64 - topology.edge_count() as i64
                + topology.face_count() as i64;
            prop_assert_eq!(topology.euler_characteristic(), euler);
            let rules = Rules::default();
            let fine = catmull_clark(topology, &Sharpness::smooth(topology, rules), rules).topology;
            prop_assert!(fine.is_quad());
            prop_assert_eq!(fine.face_count(), topology.half_edge_count());
            prop_assert_eq!(fine.euler_characteristic(), euler);
            prop_assert_eq!(fine.boundary_loops().len(), topology.boundary_loops().len());
        }
    }
}
