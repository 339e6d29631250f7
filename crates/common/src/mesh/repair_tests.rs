//! Laws of preflight and repair, on surfaces broken by hand and at random.

use nalgebra::Point3;
use proptest::prelude::*;

use super::{
    Accepted, Defect, Facts, Policy, PolygonSoup, PreflightError, Repair, TriangleMesh, accept,
    preflight, shapes, zoo,
};

fn soup(mesh: &TriangleMesh) -> PolygonSoup {
    PolygonSoup::from_triangles(mesh.positions().to_vec(), mesh.faces())
}

fn points(list: &[[f64; 3]]) -> Vec<Point3<f64>> {
    list.iter().map(|&p| Point3::from(p)).collect()
}

fn repaired(soup: &PolygonSoup) -> Accepted {
    accept(soup, Policy::Repair).unwrap_or_else(|error| panic!("{error}"))
}

/// Checks what every accepted mesh promises, and that a second repair does nothing.
fn check_repaired(soup: &PolygonSoup) -> Accepted {
    let once = repaired(soup);
    let again = self::soup(&once.mesh);
    assert_eq!(preflight(&again).defects, Vec::new());
    for (vertex, &origin) in once.vertex_origin.iter().enumerate() {
        assert_eq!(
            once.mesh.positions()[vertex],
            soup.positions[origin as usize]
        );
    }
    let twice = repaired(&again);
    assert_eq!(twice.repairs, Vec::new());
    assert_eq!(twice.mesh.faces(), once.mesh.faces());
    assert_eq!(twice.mesh.positions(), once.mesh.positions());
    once
}

fn defect_texts(soup: &PolygonSoup) -> Vec<String> {
    preflight(soup)
        .defects
        .iter()
        .map(Defect::to_string)
        .collect()
}

#[test]
fn clean_surfaces_pass_and_keep_their_ids_under_both_policies() {
    for mesh in [
        zoo::closed(),
        zoo::with_boundary(),
        zoo::with_two_boundaries(),
        zoo::knotted(),
    ] {
        let input = soup(&mesh);
        for policy in [Policy::Refuse, Policy::Repair] {
            let accepted = accept(&input, policy).unwrap();
            assert_eq!(accepted.repairs, Vec::new());
            assert_eq!(accepted.mesh.faces(), mesh.faces());
            assert!(
                accepted
                    .vertex_origin
                    .iter()
                    .copied()
                    .eq(0..mesh.vertex_count() as u32)
            );
        }
    }
}

#[test]
fn every_unusable_face_is_named() {
    let positions = points(&[
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [f64::NAN, 0.0, 0.0],
        [2.0; 3],
    ]);
    let mut soup = PolygonSoup {
        positions,
        ..PolygonSoup::default()
    };
    for face in [
        &[0, 1, 2][..],
        &[0, 1, 9],
        &[0, -1, 2],
        &[0, 1],
        &[0, 1, 1],
        &[0, 1, 3],
    ] {
        soup.push_face(face.iter().copied());
    }
    assert_eq!(
        defect_texts(&soup),
        [
            "face 1 names vertex 9, but there are 5 vertices",
            "face 2 names the negative vertex index -1",
            "face 3 has 2 corners; a face needs at least 3",
            "face 4 names vertex 1 more than once",
            "vertex 3 has a coordinate that is not finite: (NaN, 0, 0)",
            "vertex 4 belongs to no face",
        ]
    );
    assert_eq!(
        accept(&soup, Policy::Refuse).unwrap_err().to_string(),
        "the mesh is broken: face 1 names vertex 9, but there are 5 vertices; face 2 names the \
         negative vertex index -1; face 3 has 2 corners; a face needs at least 3; face 4 names \
         vertex 1 more than once; vertex 3 has a coordinate that is not finite: (NaN, 0, 0); and \
         1 more defects; mend them with --repair"
    );
    let accepted = check_repaired(&soup);
    let texts: Vec<String> = accepted.repairs.iter().map(Repair::to_string).collect();
    assert_eq!(
        texts,
        [
            "dropped unusable faces: 4 (1, 2, 3, 5)",
            "removed faces of no area: 1 (4)",
            "dropped unused vertices: 2 (3, 4)"
        ]
    );
}

#[test]
fn no_face_at_all_is_refused_by_name() {
    let soup = PolygonSoup {
        positions: points(&[[0.0; 3]]),
        ..PolygonSoup::default()
    };
    for policy in [Policy::Refuse, Policy::Repair] {
        assert_eq!(
            accept(&soup, policy).unwrap_err().to_string(),
            "the mesh is broken: there is no face among 1 vertices; give a file that has faces"
        );
    }
    let mut unusable = PolygonSoup {
        positions: points(&[[0.0; 3]]),
        ..PolygonSoup::default()
    };
    unusable.push_face([0, 0, 0]);
    assert_eq!(
        accept(&unusable, Policy::Repair).unwrap_err(),
        PreflightError::NothingLeft { faces: 1 }
    );
}

#[test]
fn a_fin_is_cut_off_along_its_edge() {
    let mesh = shapes::sphere(162);
    let mut input = soup(&mesh);
    let [a, b, _] = mesh.faces()[7].map(i64::from);
    input.positions.push(Point3::new(3.0, 3.0, 3.0));
    input.push_face([a, b, 162]);
    let found = preflight(&input);
    let [Defect::NonManifoldEdge { faces, .. }] = &found.defects[..] else {
        panic!("{:?}", found.defects)
    };
    assert!(faces.contains(&7) && faces.contains(&320) && faces.len() == 3);
    assert!(
        check_repaired(&input)
            .repairs
            .iter()
            .any(|r| matches!(r, Repair::CutAtFaces(_)))
    );
}

#[test]
fn two_tetrahedra_in_one_vertex_are_a_bow_tie_of_two_components() {
    let positions = points(&[
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ]);
    let faces = [
        [0, 2, 1],
        [0, 1, 3],
        [0, 3, 2],
        [1, 2, 3],
        [0, 4, 5],
        [0, 6, 4],
        [0, 5, 6],
        [4, 6, 5],
    ];
    let input = PolygonSoup::from_triangles(positions, &faces);
    assert_eq!(
        defect_texts(&input),
        [
            "vertex 0 is a bow tie: its faces form 2 separate fans",
            "there are 2 components, of 4, 4 faces"
        ]
    );
    let accepted = check_repaired(&input);
    assert_eq!(accepted.mesh.vertex_count(), 4);
    assert!(Facts::measure(&accepted.mesh).volume.unwrap() > 0.0);
}

#[test]
fn a_triangle_soup_is_joined_to_the_surface_it_came_from() {
    for mesh in [zoo::closed(), zoo::with_boundary(), zoo::knotted()] {
        let positions = mesh
            .faces()
            .iter()
            .flatten()
            .map(|&v| mesh.positions()[v as usize]);
        let faces: Vec<[u32; 3]> = (0..mesh.face_count() as u32)
            .map(|f| [3 * f, 3 * f + 1, 3 * f + 2])
            .collect();
        let input = PolygonSoup::from_triangles(positions.collect(), &faces);
        let found = preflight(&input);
        assert_eq!(found.components.len(), mesh.face_count());
        assert_eq!(
            found.coincident.len(),
            3 * mesh.face_count() - mesh.vertex_count()
        );
        let joined = check_repaired(&input).mesh;
        assert_eq!(joined.vertex_count(), mesh.vertex_count());
        assert_eq!(Facts::measure(&joined).genus, Facts::measure(&mesh).genus);
    }
}

#[test]
fn a_surface_that_only_touches_itself_is_left_alone() {
    // A square torus pinched so that two rings of vertices coincide.
    let mesh = shapes::torus(2.0, 1.0, 400);
    let mut positions = mesh.positions().to_vec();
    positions[200] = positions[10];
    positions[201] = positions[11];
    let touching = mesh.with_positions(positions);
    let accepted = accept(&soup(&touching), Policy::Repair).unwrap();
    assert_eq!(accepted.repairs, Vec::new());
    assert_eq!(accepted.mesh.faces(), mesh.faces());
}

#[test]
fn a_moebius_strip_is_refused_by_both_policies() {
    let n = 12i64;
    let place = |i: i64, side: f64| {
        let angle = std::f64::consts::TAU * i as f64 / n as f64;
        let across = 1.0 + side * (0.5 * angle).cos();
        Point3::new(
            across * angle.cos(),
            across * angle.sin(),
            side * (0.5 * angle).sin(),
        )
    };
    let mut input = PolygonSoup::default();
    for i in 0..n {
        input.positions.extend([place(i, -0.3), place(i, 0.3)]);
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
        input.push_face([a, b, c]);
        input.push_face([b, d, c]);
    }
    for policy in [Policy::Refuse, Policy::Repair] {
        let text = accept(&input, policy).unwrap_err().to_string();
        assert!(text.contains("the surface has only one side"), "{text}");
        assert!(
            text.ends_with("cut the surface open so that it has two sides"),
            "{text}"
        );
    }
}

#[test]
fn a_flat_corner_leaves_no_slit() {
    // Vertex 4 lies on the side (1, 2) of face 0 and between three faces; face 3 has no area.
    let positions = points(&[
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.5, 0.5, 0.0],
    ]);
    let faces = [[0, 1, 2], [4, 1, 3], [2, 4, 3], [1, 4, 2]];
    let input = PolygonSoup::from_triangles(positions, &faces);
    assert!(matches!(
        preflight(&input).defects[..],
        [Defect::ZeroArea { face: 3 }]
    ));
    let facts = Facts::measure(&check_repaired(&input).mesh);
    assert_eq!((facts.faces, facts.boundary_loops, facts.area), (4, 1, 1.0));
}

#[test]
fn closed_surfaces_turn_outwards_and_quads_are_cut() {
    let mut input = PolygonSoup::default();
    for i in 0..8 {
        let bit = |k: u32| f64::from((i >> k) & 1);
        input.positions.push(Point3::new(bit(0), bit(1), bit(2)));
    }
    let inwards = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    inwards
        .iter()
        .for_each(|face| input.push_face(face.iter().copied()));
    let as_is = accept(&input, Policy::Refuse).unwrap();
    assert!(matches!(&as_is.repairs[..], [Repair::Triangulated(faces)] if faces.count == 6));
    assert_eq!(Facts::measure(&as_is.mesh).volume, Some(-1.0));
    assert_eq!(
        Facts::measure(&check_repaired(&input).mesh).volume,
        Some(1.0)
    );
}

#[derive(Clone, Debug)]
enum Damage {
    Duplicate(usize),
    Flip(usize),
    Drop(usize),
    Index(usize, usize, i64),
    Merge(usize, usize),
    Coincide(usize, usize),
    NotANumber(usize),
    Fin(usize, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    let any = || 0usize..10_000;
    prop_oneof![
        any().prop_map(Damage::Duplicate),
        any().prop_map(Damage::Flip),
        any().prop_map(Damage::Drop),
        (any(), 0usize..3, -3i64..2000).prop_map(|(f, i, v)| Damage::Index(f, i, v)),
        (any(), any()).prop_map(|(a, b)| Damage::Merge(a, b)),
        (any(), any()).prop_map(|(a, b)| Damage::Coincide(a, b)),
        any().prop_map(Damage::NotANumber),
        (any(), any()).prop_map(|(f, v)| Damage::Fin(f, v)),
    ]
}

fn apply(damage: &Damage, positions: &mut [Point3<f64>], faces: &mut Vec<Vec<i64>>) {
    let (vertices, count) = (positions.len(), faces.len());
    match *damage {
        Damage::Duplicate(face) => faces.push(faces[face % count].clone()),
        Damage::Flip(face) => faces[face % count].reverse(),
        Damage::Drop(face) => drop(faces.swap_remove(face % count)),
        Damage::Index(face, corner, index) => faces[face % count][corner] = index,
        Damage::Merge(from, to) => {
            let (from, to) = ((from % vertices) as i64, (to % vertices) as i64);
            faces
                .iter_mut()
                .flatten()
                .filter(|v| **v == from)
                .for_each(|v| *v = to);
        }
        Damage::Coincide(from, to) => positions[from % vertices] = positions[to % vertices],
        Damage::NotANumber(vertex) => positions[vertex % vertices].y = f64::NAN,
        Damage::Fin(face, vertex) => {
            let [a, b, _] = faces[face % count][..] else {
                return;
            };
            faces.push(vec![a, b, (vertex % vertices) as i64]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_repaired_soup_passes_preflight_and_repair_is_idempotent(
        which in 0usize..3,
        damages in prop::collection::vec(damage(), 1..30),
    ) {
        let mesh = [shapes::sphere(92), shapes::torus(2.0, 1.0, 120), shapes::height_field(100)];
        let mesh = &mesh[which];
        let mut positions = mesh.positions().to_vec();
        let mut faces: Vec<Vec<i64>> =
            mesh.faces().iter().map(|f| f.iter().map(|&v| i64::from(v)).collect()).collect();
        damages.iter().for_each(|damage| apply(damage, &mut positions, &mut faces));
        let mut input = PolygonSoup { positions, ..PolygonSoup::default() };
        faces.into_iter().for_each(|face| input.push_face(face));
        match accept(&input, Policy::Repair) {
            Ok(_) => drop(check_repaired(&input)),
            Err(PreflightError::NotOrientable { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
}
