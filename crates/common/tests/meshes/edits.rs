//! Edits of random meshes keep what they must.

use std::collections::BTreeSet;

use msplines_common::Point3;
use msplines_common::mesh::{
    DecimateError, FlipComplex, NONE, SplitError, SurfacePoint, Topology, TriangleMesh, decimate,
    shapes, split_at, subdivide_butterfly, subdivide_loop, subdivide_midpoint,
};
use proptest::prelude::*;

use crate::oracle::{check, kind};
use crate::soups::meshes;

/// A face, and barycentric coordinates before they are divided by their sum.
type Draft = (u32, [u32; 3]);

/// Returns points inside, on sides and at corners of faces.
fn points(mesh: &TriangleMesh, drafts: &[Draft]) -> Vec<SurfacePoint> {
    let point = |&(face, at): &Draft| {
        let sum = f64::from(at.iter().sum::<u32>().max(1));
        let [a, b, c] = if at == [0; 3] { [1, 0, 0] } else { at };
        SurfacePoint {
            face: face % mesh.face_count() as u32,
            at: [a, b, c].map(|x| f64::from(x) / sum),
        }
    };
    drafts.iter().map(point).collect()
}

fn is_finite(mesh: &TriangleMesh) -> bool {
    let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    mesh.positions().iter().all(finite)
}

/// Whether two faces have the same corners, which subdivision does not take.
fn has_twin_faces(mesh: &TriangleMesh) -> bool {
    let sorted = |face: &[u32; 3]| {
        let mut corners = *face;
        corners.sort_unstable();
        corners
    };
    let distinct: BTreeSet<[u32; 3]> = mesh.faces().iter().map(sorted).collect();
    distinct.len() < mesh.face_count()
}

/// Checks one round of a scheme that cuts every face into four.
fn check_subdivided(coarse: &Topology, fine: &TriangleMesh) {
    check(fine.topology());
    assert!(is_finite(fine));
    assert_eq!(
        fine.vertex_count(),
        coarse.vertex_count() + coarse.edge_count()
    );
    assert_eq!(fine.face_count(), 4 * coarse.face_count());
    assert_eq!(kind(fine.topology()), kind(coarse));
}

fn check_decimated(mesh: &TriangleMesh, target: usize) {
    match decimate(mesh, target) {
        Ok(decimated) => {
            check(decimated.mesh.topology());
            assert!(is_finite(&decimated.mesh));
            assert_eq!(decimated.mesh.vertex_count(), target);
            assert_eq!(kind(decimated.mesh.topology()), kind(mesh.topology()));
        }
        Err(DecimateError::Stalled { reached, .. }) => {
            assert!(target < reached && reached <= mesh.vertex_count());
        }
        Err(error) => assert!(target > mesh.vertex_count() || target == 0, "{error}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 500, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn flips_keep_the_mesh_and_four_of_an_edge_are_none(
        mesh in meshes(),
        half_edges in prop::collection::vec(any::<u32>(), 1..30),
    ) {
        let topology = mesh.topology();
        let mut complex = FlipComplex::of(topology);
        let mut is_mesh = true;
        for h in half_edges {
            let h = h % (3 * topology.face_count() as u32);
            let twin = complex.twin(h);
            // The two sides of the diagonal must be two faces.
            if twin == NONE || twin / 3 == h / 3 {
                continue;
            }
            let mut turned = complex.clone();
            for _ in 0..4 {
                turned.flip(h);
            }
            prop_assert_eq!(&turned, &complex);
            is_mesh &= complex.stays_simplicial(h);
            complex.flip(h);
            let glued = (0..complex.twins().len() as u32).filter(|&h| complex.twin(h) != NONE);
            for h in glued {
                let twin = complex.twin(h);
                prop_assert_eq!(complex.twin(twin), h);
                prop_assert_eq!(complex.origin(twin), complex.origin(Topology::next(h)));
            }
            if is_mesh {
                let flipped = Topology::build(mesh.vertex_count(), complex.faces().to_vec());
                let flipped = flipped.expect("a mesh stays one");
                check(&flipped);
                prop_assert_eq!(kind(&flipped), kind(topology));
                let twins: Vec<u32> = (0..complex.twins().len() as u32)
                    .map(|h| flipped.twin(h))
                    .collect();
                prop_assert_eq!(complex.twins(), twins.as_slice());
            }
        }
    }

    #[test]
    fn subdivision_keeps_the_kind_of_a_surface(mesh in meshes()) {
        prop_assume!(!has_twin_faces(&mesh));
        let coarse = mesh.topology();
        check_subdivided(coarse, &subdivide_midpoint(&mesh, 1).0);
        check_subdivided(coarse, &subdivide_loop(&mesh, 1));
        check_subdivided(coarse, &subdivide_butterfly(&mesh, 1));
    }

    #[test]
    fn splits_keep_the_kind_of_a_surface(
        mesh in meshes(),
        drafts in prop::collection::vec((any::<u32>(), [0u32..4, 0u32..4, 0u32..4]), 1..12),
    ) {
        match split_at(&mesh, &points(&mesh, &drafts)) {
            Ok(split) => {
                check(split.mesh.topology());
                prop_assert_eq!(kind(split.mesh.topology()), kind(mesh.topology()));
                prop_assert_eq!(split.parents.len(), split.mesh.face_count());
                prop_assert_eq!(split.vertices.len(), drafts.len());
            }
            Err(error) => prop_assert!(matches!(error, SplitError::Topology(_)), "{error}"),
        }
    }

    #[test]
    fn decimation_of_few_vertices_keeps_the_kind_of_a_surface(mesh in meshes(), target in 0usize..8) {
        check_decimated(&mesh, target);
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 60, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn decimation_keeps_the_kind_of_a_surface(
        which in 0usize..4,
        target in 3usize..150,
        flatten in prop::sample::select(vec![1.0, 1e-9, 0.0]),
    ) {
        let mesh = match which {
            0 => shapes::sphere(162),
            1 => shapes::torus(2.0, 1.0, 160),
            2 => shapes::height_field(144),
            _ => shapes::cylinder(150),
        };
        let flat = |p: &Point3<f64>| Point3::new(p.x, p.y, p.z * flatten);
        let flat = mesh.positions().iter().map(flat).collect();
        check_decimated(&mesh.with_positions(flat), target);
    }
}
