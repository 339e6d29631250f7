//! Atlases: zeros, holes, and the kinds of surfaces.

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;

use super::shapes::hexagon;
use crate::{Atlas, AtlasOptions, FormChoice, Structure};

fn power(z: [f64; 2], exponent: u32) -> [f64; 2] {
    (1..exponent).fold(z, |[a, b], _| [a * z[0] - b * z[1], a * z[1] + b * z[0]])
}

#[test]
fn zeros_of_any_order_are_found_where_they_are() {
    for order in 1..=4 {
        let (mesh, points) = hexagon(8);
        // The zero lies inside of a face, beside vertex 0.
        let values: Vec<[f64; 2]> = points
            .iter()
            .map(|p| power([p[0] - 0.12, p[1] - 0.07], order + 1))
            .collect();
        let side = |f: &[u32; 3], i: usize| {
            let [a, b] = [f[i], f[(i + 1) % 3]].map(|v| values[v as usize]);
            [b[0] - a[0], b[1] - a[1]]
        };
        let form: Vec<[f64; 2]> = mesh
            .faces()
            .iter()
            .flat_map(|f| [0, 1, 2].map(|i| side(f, i)))
            .collect();
        let atlas = Atlas::of_form(&mesh, &form).unwrap();
        let orders: i32 = atlas.zeros().iter().map(|zero| zero.order).sum();
        assert_eq!(orders, order as i32);
        assert_eq!(atlas.folded_faces(), 0);
        if order == 1 {
            assert_eq!(atlas.zeros().len(), 1);
        }
        for vertex in atlas.zeros().iter().flat_map(|zero| &zero.vertices) {
            assert!(points[*vertex as usize][0].hypot(points[*vertex as usize][1]) < 2.0);
        }
    }
}

#[test]
fn closed_surfaces_have_2g_minus_2_zeros_and_nothing_folded() {
    for genus in [1, 2, 3, 6] {
        let mesh = shapes::genus(genus, 700 * genus as usize);
        let found = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved()).unwrap();
        let report = &found.report;
        assert_eq!(
            (report.genus, report.zeros, report.flips),
            (genus, 2 * genus - 2, 0)
        );
        assert!(report.closedness < 1e-12, "{}", report.closedness);
        assert!(report.distortion.angle_p50 < 1.2, "{:?}", report.distortion);
        let atlas = &found.atlas;
        let [mut flat, mut surface] = [0.0; 2];
        for face in 0..atlas.mesh().face_count() as u32 {
            if !atlas.zeros().iter().any(|zero| zero.faces.contains(&face)) {
                let [a, b] = [0, 1].map(|i| atlas.form()[(3 * face + i) as usize]);
                flat += a[0] * b[1] - a[1] * b[0];
                surface += atlas.mesh().face_normal(face).norm();
            }
        }
        assert!((flat / surface - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_mesh_too_coarse_for_its_handles_is_refined_and_says_so() {
    let mesh = shapes::genus(12, 150 * 12);
    let found = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved()).unwrap();
    assert_eq!((found.report.zeros, found.report.flips), (22, 0));
    let added = found.atlas.mesh().vertex_count() - mesh.vertex_count();
    assert_eq!(found.report.added_vertices, added);
    assert_eq!(
        found
            .origins
            .iter()
            .filter(|origin| origin.is_none())
            .count(),
        added
    );
    let kept = mesh.positions().iter().zip(found.atlas.mesh().positions());
    assert!(kept.into_iter().all(|(a, b)| a == b));
}

#[test]
fn every_kind_of_surface_has_its_atlas() {
    let of = |mesh: &TriangleMesh| {
        Atlas::of_surface(mesh, &AtlasOptions::default(), &mut unobserved()).unwrap()
    };
    let sphere = of(&zoo::closed());
    let Structure::Sphere { pole } = sphere.structure else {
        panic!("a sphere")
    };
    let [hole] = sphere.atlas.zeros() else {
        panic!("one pole")
    };
    assert_eq!(
        (hole.order, &hole.vertices[..], sphere.report.zeros),
        (-2, &[pole][..], 0)
    );
    assert!(sphere.report.closedness < 1e-12 && sphere.report.flips == 0);
    let disk = of(&zoo::with_boundary());
    assert!(matches!(disk.structure, Structure::Disk) && disk.atlas.zeros().is_empty());
    let tube = of(&zoo::with_two_boundaries());
    assert!(matches!(&tube.structure, Structure::Bounded { levels } if levels == &[0.0, 1.0]));
    assert_eq!((tube.report.zeros, tube.report.flips), (0, 0));
}

#[test]
fn punctures_open_a_surface_and_keep_its_names() {
    let sphere = shapes::sphere(600);
    let options = AtlasOptions {
        puncture: vec![5, 300],
        ..AtlasOptions::default()
    };
    let found = Atlas::of_surface(&sphere, &options, &mut unobserved()).unwrap();
    assert!(matches!(found.structure, Structure::Bounded { .. }));
    for (v, origin) in found.origins.iter().enumerate() {
        let origin = origin.unwrap();
        assert!(origin != 5 && origin != 300);
        assert_eq!(
            found.atlas.mesh().positions()[v],
            sphere.positions()[origin as usize]
        );
    }
}

#[test]
fn handles_with_a_boundary_have_the_zeros_of_the_filled_surface() {
    let options = AtlasOptions {
        form: FormChoice::default(),
        puncture: vec![10, 400],
    };
    let found = Atlas::of_surface(&shapes::genus(2, 1200), &options, &mut unobserved()).unwrap();
    assert!(matches!(found.structure, Structure::Filled { cones: 2 }));
    let report = &found.report;
    assert_eq!((report.genus, report.zeros, report.flips), (2, 2, 0));
    assert_eq!(found.atlas.mesh().topology().boundary_loops().len(), 2);
}
