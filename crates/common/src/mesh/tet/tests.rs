//! Laws of tetrahedral meshes, and what is refused.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::mesh::facts::Facts;
use crate::mesh::shapes::box_solid;
use crate::mesh::{NONE, Policy};

const CORNER: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

fn soup(positions: &[[f64; 3]], cells: &[[i64; 4]]) -> TetSoup {
    TetSoup {
        positions: positions.iter().map(|&p| Point3::from(p)).collect(),
        cells: cells.to_vec(),
    }
}

fn texts(soup: &TetSoup) -> Vec<String> {
    preflight(soup)
        .defects
        .iter()
        .map(TetDefect::to_string)
        .collect()
}

/// Two cubes of 2³ unit cubes, the second moved by `shift`, their coincident vertices joined.
fn two_boxes(shift: [i32; 3]) -> TetSoup {
    let one = box_solid([2, 2, 2]);
    let mut positions = one.positions().to_vec();
    let ids: Vec<i64> = one
        .positions()
        .iter()
        .map(|p| {
            let moved = p + nalgebra::Vector3::from(shift.map(f64::from));
            let found = positions[..27].iter().position(|&q| q == moved);
            found.unwrap_or_else(|| {
                positions.push(moved);
                positions.len() - 1
            }) as i64
        })
        .collect();
    let mut cells: Vec<[i64; 4]> = one.cells().iter().map(|c| c.map(i64::from)).collect();
    let second: Vec<[i64; 4]> = one
        .cells()
        .iter()
        .map(|c| c.map(|v| ids[v as usize]))
        .collect();
    cells.extend(second);
    TetSoup { positions, cells }
}

#[test]
fn a_box_has_the_facts_of_a_box() {
    for counts in [[1, 1, 1], [2, 3, 4], [5, 1, 2]] {
        let mesh = box_solid(counts);
        mesh.topology().sanity_check();
        let facts = TetFacts::measure(&mesh);
        let [x, y, z] = counts.map(f64::from);
        assert_eq!(facts.cells as f64, 6.0 * x * y * z);
        assert!((facts.volume - x * y * z).abs() < 1e-12);
        assert_eq!(facts.boundary_area, 2.0 * (x * y + y * z + z * x));
        assert_eq!((facts.components, facts.euler_characteristic), (1, 1));
        assert_eq!((facts.boundary_genus, facts.not_positive), (Some(0), 0));
        assert_eq!(
            (
                facts.boundary_euler_characteristic,
                facts.boundary_components
            ),
            (2, 1)
        );
        // Each tetrahedron of a cube has three right angles, and the smallest is 45 degrees.
        assert!((facts.dihedral_angle.min - FRAC_PI_2 / 2.0).abs() < 1e-12);
        assert!((facts.dihedral_angle.max - FRAC_PI_2).abs() < 1e-12);
        let boundary = Facts::measure(&mesh.boundary());
        assert!(
            (boundary.volume.unwrap() - facts.volume).abs() < 1e-12,
            "faces are outwards"
        );
        assert!(mesh.require_sphere().is_ok());
    }
}

#[test]
fn boundary_vertices_map_both_ways() {
    let mesh = box_solid([3, 3, 3]);
    let topology = mesh.topology();
    assert_eq!(topology.boundary_vertices().len(), 64 - 8);
    for (id, &vertex) in topology.boundary_vertices().iter().enumerate() {
        assert_eq!(topology.boundary_vertex(vertex), id as u32);
        assert_eq!(
            mesh.boundary().positions()[id],
            mesh.positions()[vertex as usize]
        );
    }
    let inside = (0..64).filter(|&v| topology.boundary_vertex(v) == NONE);
    assert_eq!(inside.count(), 8);
    for (face, &(cell, corner)) in topology.boundary_faces().iter().enumerate() {
        let of_boundary = mesh.boundary().faces()[face];
        let of_cell = topology.face(cell, corner.into());
        assert_eq!(
            of_boundary.map(|v| topology.boundary_vertices()[v as usize]),
            of_cell
        );
    }
}

#[test]
fn moved_vertices_share_the_topology_and_flips_are_counted() {
    let mesh = box_solid([2, 2, 2]);
    let mut positions = mesh.positions().to_vec();
    let centre = positions
        .iter()
        .position(|p| *p == Point3::new(1., 1., 1.))
        .unwrap();
    positions[centre].x = 2.5;
    let moved = mesh.with_positions(positions);
    assert!(std::ptr::eq(moved.topology(), mesh.topology()));
    assert!(!moved.not_positive().is_empty());
    let total: f64 = (0..48).map(|cell| moved.signed_volume(cell)).sum();
    assert!((total - 8.0).abs() < 1e-12, "the boundary did not move");
}

#[test]
fn angles_of_regular_and_corner_tetrahedra_are_exact() {
    let regular = [[1., 1., 1.], [-1., 1., -1.], [1., -1., -1.], [-1., -1., 1.]];
    let expected = (1f64 / 3.0).acos();
    for angle in dihedral_angles(&regular.map(Point3::from)) {
        assert!((angle - expected).abs() < 1e-14);
    }
    let angles = dihedral_angles(&CORNER.map(Point3::from));
    let slanted = (1.0 / 3f64.sqrt()).acos();
    for (angle, expected) in angles
        .into_iter()
        .zip([FRAC_PI_2, FRAC_PI_2, FRAC_PI_2, slanted, slanted, slanted])
    {
        assert!((angle - expected).abs() < 1e-14, "{angles:?}");
    }
}

#[test]
fn each_defect_is_named() {
    let far = [5.0, 5.0, 5.0];
    let five = [CORNER[0], CORNER[1], CORNER[2], CORNER[3], [0., 0., -1.]];
    let cases: [(TetSoup, &str); 9] = [
        (
            soup(&CORNER, &[]),
            "there is no tetrahedron among 4 vertices",
        ),
        (
            soup(&CORNER, &[[0, 1, 2, 3], [0, 1, 2, 9]]),
            "tetrahedron 1 names vertex 9, but there are 4",
        ),
        (
            soup(&CORNER, &[[0, 1, 2, 3], [0, 1, 2, -1]]),
            "tetrahedron 1 names vertex -1",
        ),
        (
            soup(&CORNER, &[[0, 1, 2, 3], [0, 1, 1, 3]]),
            "tetrahedron 1 names vertex 1 more than once",
        ),
        (
            soup(
                &[CORNER[0], CORNER[1], CORNER[2], [0., f64::NAN, 1.]],
                &[[0, 1, 2, 3]],
            ),
            "vertex 3 has a coordinate that is not finite: (0, NaN, 1)",
        ),
        (
            soup(
                &[CORNER[0], CORNER[1], CORNER[2], [0.3, 0.4, 0.0]],
                &[[0, 1, 2, 3]],
            ),
            "tetrahedron 0 is flat: its corners [0, 1, 2, 3] lie in one plane",
        ),
        (
            soup(&five, &[[0, 1, 2, 3], [0, 1, 2, 4]]),
            "1 tetrahedra are inverted: 1",
        ),
        (
            soup(&CORNER, &[[0, 1, 2, 3], [3, 2, 1, 0]]),
            "tetrahedron 1 has the same vertices as tetrahedron 0",
        ),
        (
            soup(
                &[CORNER[0], CORNER[1], CORNER[2], CORNER[3], far],
                &[[0, 1, 2, 3]],
            ),
            "vertex 4 belongs to no",
        ),
    ];
    for (soup, expected) in cases {
        let found = texts(&soup);
        assert!(
            found.iter().any(|text| text.contains(expected)),
            "{expected}: {found:?}"
        );
        assert!(accept(&soup, Policy::Refuse).is_err());
    }
}

#[test]
fn overlaps_are_told_from_inverted_corners() {
    let above = [CORNER[0], CORNER[1], CORNER[2], CORNER[3], [0.2, 0.2, 2.0]];
    let folded = soup(&above, &[[0, 1, 2, 3], [0, 1, 2, 4]]);
    assert_eq!(
        texts(&folded),
        ["tetrahedra 0 and 1 lie on the same side of their face [0, 1, 2]: the mesh is folded"]
    );
    let error = accept(&folded, Policy::Repair).unwrap_err().to_string();
    assert!(
        error.ends_with("mesh the solid again without overlaps, or give its surface alone"),
        "{error}"
    );
    let mut three = above.to_vec();
    three.push([0.3, 0.3, -1.0]);
    let shared = soup(&three, &[[0, 1, 2, 3], [0, 1, 2, 4], [0, 2, 1, 5]]);
    let found = texts(&shared);
    assert!(
        found.contains(&"face [0, 1, 2] is shared by 3 tetrahedra: 0, 1, 2".to_owned()),
        "{found:?}"
    );
}

#[test]
fn solids_that_meet_in_an_edge_or_a_vertex_are_refused() {
    let edge = two_boxes([2, 2, 0]);
    let found = preflight(&edge).defects;
    let edges = found
        .iter()
        .filter(|d| matches!(d, TetDefect::NonManifoldEdge { faces: 4, .. }));
    assert_eq!(edges.count(), 2, "{found:?}");
    let vertex = two_boxes([2, 2, 2]);
    let found = preflight(&vertex).defects;
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(matches!(
        found[0],
        TetDefect::NonManifoldVertex { parts: 2, .. }
    ));
    assert!(matches!(found[1], TetDefect::SeveralComponents { .. }));
    for soup in [edge, vertex] {
        assert!(accept(&soup, Policy::Refuse).is_err());
        // Cells that share no face are apart, so that the larger part remains.
        let mended = accept(&soup, Policy::Repair).unwrap();
        assert_eq!(mended.mesh.cell_count(), 48);
        assert!(mended.mesh.require_sphere().is_ok());
        assert_eq!(mended.cell_origin[0], 0);
    }
    let joined = accept(&two_boxes([2, 0, 0]), Policy::Refuse).unwrap();
    assert_eq!(joined.mesh.cell_count(), 96);
}

#[test]
fn a_pinch_within_one_solid_is_refused() {
    // A ring of cubes in which the last meets the first in an edge only.
    let grid = box_solid([3, 3, 1]);
    let keep = [
        [0, 0],
        [1, 0],
        [2, 0],
        [2, 1],
        [2, 2],
        [1, 2],
        [0, 2],
        [0, 1],
    ];
    let pick = |cubes: &[[u32; 2]]| {
        let cells = grid.cells().chunks(6).enumerate().filter(|(cube, _)| {
            let (i, j) = (*cube as u32 % 3, *cube as u32 / 3);
            cubes.contains(&[i, j])
        });
        let cells: Vec<[u32; 4]> = cells.flat_map(|(_, six)| six.to_vec()).collect();
        TetSoup::from_cells(grid.positions().to_vec(), &cells)
    };
    let ring = accept(&pick(&keep), Policy::Refuse).unwrap().mesh;
    assert_eq!(ring.require_sphere(), Err(NotSphere::Genus { genus: 1 }));
    let pinched = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [1, 1]];
    let found = preflight(&pick(&pinched[..5])).defects;
    assert!(
        found.is_empty()
            || found
                .iter()
                .all(|d| matches!(d, TetDefect::UnreferencedVertex { .. }))
    );
    let mut cubes = pinched[..5].to_vec();
    cubes.extend([[1, 2], [0, 1]]);
    let found = texts(&pick(&cubes));
    assert!(
        found
            .iter()
            .any(|t| t.contains("has 4 boundary faces instead of two")),
        "{found:?}"
    );
    let error = TetMesh::build(
        grid.positions().to_vec(),
        pick(&cubes)
            .cells
            .iter()
            .map(|c| c.map(|v| v as u32))
            .collect(),
    );
    assert!(error.is_err());
}

#[test]
fn a_void_is_a_second_surface() {
    let grid = box_solid([3, 3, 3]);
    let mut cells = grid.cells().to_vec();
    cells.drain(6 * 13..6 * 14);
    let hollow = TetMesh::build(grid.positions().to_vec(), cells).unwrap();
    let facts = TetFacts::measure(&hollow);
    assert_eq!((facts.boundary_components, facts.boundary_genus), (2, None));
    assert_eq!(facts.boundary_euler_characteristic, 4);
    assert!(matches!(
        hollow.require_sphere(),
        Err(NotSphere::SeveralSurfaces { pieces: 2, .. })
    ));
}

#[test]
fn the_other_convention_is_turned_under_either_policy() {
    let mesh = box_solid([2, 1, 1]);
    let mut soup = TetSoup::from_cells(mesh.positions().to_vec(), mesh.cells());
    soup.cells.iter_mut().for_each(|cell| cell.swap(0, 1));
    for policy in [Policy::Refuse, Policy::Repair] {
        let accepted = accept(&soup, policy).unwrap();
        assert_eq!(accepted.repairs, [TetRepair::TurnedAll { cells: 12 }]);
        assert!(accepted.mesh.not_positive().is_empty());
    }
    soup.cells[3].swap(0, 1);
    assert!(accept(&soup, Policy::Refuse).is_err());
    let mended = accept(&soup, Policy::Repair).unwrap();
    assert_eq!(
        mended.repairs,
        [TetRepair::TurnedSome {
            cells: 11,
            first: 0
        }]
    );
}

#[test]
fn repair_says_what_it_dropped() {
    let mesh = box_solid([1, 1, 1]);
    let mut soup = TetSoup::from_cells(mesh.positions().to_vec(), mesh.cells());
    soup.cells.insert(0, [0, 1, 2, 99]);
    soup.cells.push(soup.cells[1]);
    soup.positions.insert(0, Point3::new(9., 9., 9.));
    soup.cells.iter_mut().flatten().for_each(|v| *v += 1);
    let mended = accept(&soup, Policy::Repair).unwrap();
    let said: Vec<String> = mended.repairs.iter().map(TetRepair::to_string).collect();
    assert_eq!(
        said,
        [
            "1 tetrahedra with unusable vertices were dropped, first tetrahedron 0",
            "1 duplicate tetrahedra were dropped, first tetrahedron 7",
            "1 vertices of no tetrahedron were dropped, first vertex 0",
        ]
    );
    assert_eq!(mended.vertex_origin, [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(mended.cell_origin, [1, 2, 3, 4, 5, 6]);
    let none = self::soup(&CORNER, &[[0, 0, 0, 0]]);
    assert!(
        accept(&none, Policy::Repair)
            .unwrap_err()
            .to_string()
            .contains("no tetrahedron")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_indices_are_refused_or_make_a_sound_mesh(
        cells in prop::collection::vec(prop::array::uniform4(-1i64..9), 1..12),
        repair in any::<bool>(),
    ) {
        let cube = box_solid([1, 1, 1]);
        let soup = TetSoup { positions: cube.positions().to_vec(), cells };
        let policy = if repair { Policy::Repair } else { Policy::Refuse };
        if let Ok(accepted) = accept(&soup, policy) {
            accepted.mesh.topology().sanity_check();
            prop_assert!(accepted.mesh.not_positive().is_empty());
            prop_assert_eq!(accepted.mesh.topology().components().1, 1);
        }
    }

    #[test]
    fn relabelled_vertices_change_no_fact(seed in any::<u64>()) {
        let mesh = box_solid([2, 2, 1]);
        let n = mesh.vertex_count();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&v| (v as u64 + 1).wrapping_mul(seed | 1));
        let mut id = vec![0; n];
        order.iter().enumerate().for_each(|(new, &old)| id[old] = new as u32);
        let positions = order.iter().map(|&old| mesh.positions()[old]).collect();
        let cells = mesh.cells().iter().map(|c| c.map(|v| id[v as usize])).collect();
        let other = TetMesh::build(positions, cells).unwrap();
        other.topology().sanity_check();
        let (one, two) = (TetFacts::measure(&mesh), TetFacts::measure(&other));
        prop_assert_eq!((one.edges, one.faces, one.boundary_faces), (two.edges, two.faces, two.boundary_faces));
        prop_assert!((one.volume - two.volume).abs() < 1e-12);
    }
}
