//! Laws of maps to the cube.

use msplines_common::mesh::shapes::{self, box_solid};
use msplines_common::mesh::tet::NotSphere;
use msplines_common::progress::unobserved;
use nalgebra::Point3;

use super::*;
use crate::domain::boundary::{BoundaryError, BoundaryOptions, Frame, find_corners};
use crate::domain::cube::{corner_position, free_axes};
use crate::domain::mesher::{self, MesherOptions};

/// The unit cube in `n` steps along each side, moved by `place`.
fn cube(n: u32, place: impl Fn(Point3<f64>) -> Point3<f64>) -> (TetMesh, [u32; 8]) {
    let solid = box_solid([n; 3]);
    let unit: Vec<_> = solid.positions().iter().map(|p| p / f64::from(n)).collect();
    let corners = std::array::from_fn(|corner| {
        let at = Point3::from(corner_position(corner));
        unit.iter().position(|p| *p == at).unwrap() as u32
    });
    (
        solid.with_positions(unit.into_iter().map(place).collect()),
        corners,
    )
}

fn ball() -> TetMesh {
    let options = MesherOptions {
        spacing: mesher::Spacing::AlongDiagonal(18.0),
        ..MesherOptions::default()
    };
    mesher::fill(&shapes::sphere(1000), &options, &mut unobserved())
        .unwrap()
        .mesh
}

fn given(corners: [u32; 8], smoothing: Smoothing) -> VolumeOptions {
    VolumeOptions {
        corners: Corners::Given(corners),
        smoothing,
        ..VolumeOptions::default()
    }
}

fn mapped(mesh: &TetMesh, options: &VolumeOptions) -> CubeMap {
    let map = map(mesh, options, &mut unobserved()).unwrap();
    is_one_to_one(&map);
    map
}

/// No cell is inverted, no boundary triangle is, and the boundary is on that of the cube.
fn is_one_to_one(map: &CubeMap) {
    assert_eq!(
        (map.report.quality.flipped, map.report.folded),
        (0, 0),
        "{:?}",
        map.report
    );
    assert_eq!(map.report.outcome, Outcome::Converged);
    assert!(
        measure::image(&map.mesh, &map.parameters)
            .not_positive()
            .is_empty()
    );
    assert!(map.report.quality.smallest_determinant > 0.0);
    for (vertex, (parameter, &mask)) in map.parameters.iter().zip(&map.masks).enumerate() {
        let inside = map.mesh.topology().boundary_vertex(vertex as u32) == NONE;
        assert_eq!(inside, mask == 0);
        for axis in (0..3).filter(|&axis| !free_axes(mask)[axis]) {
            assert_eq!(parameter[axis], f64::from(mask >> (2 * axis + 1) & 1));
        }
        assert!(parameter.iter().all(|x| (0.0..=1.0).contains(x)));
    }
    assert!(map.labels.iter().all(|&label| label < 6));
}

/// The identity is harmonic, and of no distortion: only rounding differs.
const ROUNDING: f64 = 1e-12;

#[test]
fn a_cube_is_reproduced() {
    let (mesh, corners) = cube(5, |p| p);
    for smoothing in [Smoothing::NONE, Smoothing::default()] {
        let map = mapped(&mesh, &given(corners, smoothing));
        // Of where fair paths have moved its vertices to.
        for (p, q) in map.mesh.positions().iter().zip(&map.parameters) {
            assert!((p - Point3::from(*q)).norm() < ROUNDING);
        }
        assert!((map.report.quality.smallest_determinant - 1.0).abs() < ROUNDING);
        assert!(map.report.quality.distortion < ROUNDING);
        assert_eq!((map.report.split_edges, map.report.rounds), (0, 0));
    }
}

#[test]
fn a_box_is_stretched_linearly() {
    let (mesh, corners) = cube(4, |p| {
        Point3::new(3.0 * p.x + p.y, 0.5 * p.y, 7.0 - p.z + 2.0 * p.x)
    });
    // A reflection: corners along the third axis change places.
    let mirrored = std::array::from_fn(|corner| corners[corner ^ 4]);
    let cells = mesh
        .cells()
        .iter()
        .map(|&[a, b, c, d]| [b, a, c, d])
        .collect();
    let mesh = TetMesh::build(mesh.positions().to_vec(), cells).unwrap();
    let map = mapped(&mesh, &given(mirrored, Smoothing::NONE));
    assert!((map.report.quality.smallest_determinant - 1.0).abs() < 1e-10);
}

#[test]
fn the_papers_settings_reproduce_the_cube_as_well() {
    let (mesh, corners) = cube(4, |p| p);
    let map = mapped(&mesh, &VolumeOptions::paper(corners));
    for (p, q) in mesh.positions().iter().zip(&map.parameters) {
        assert!((p - Point3::from(*q)).norm() < ROUNDING);
    }
}

#[test]
fn a_ball_is_mapped_with_corners_found() {
    let mesh = ball();
    let map = mapped(&mesh, &VolumeOptions::default());
    assert_eq!(map.report.trials, 8);
    assert!(map.report.quality.distortion < 0.25, "{:?}", map.report);
    // By symmetry the centre of the ball is near to that of the cube.
    let centre = (0..mesh.vertex_count())
        .min_by(|&a, &b| {
            let from_centre = |v: usize| mesh.positions()[v].coords.norm();
            from_centre(a).total_cmp(&from_centre(b))
        })
        .unwrap();
    assert!(map.parameters[centre].iter().all(|x| (x - 0.5).abs() < 0.1));
}

/// A bar turned by a half turn from end to end.
fn twisted_bar() -> (TetMesh, [u32; 8]) {
    cube(8, |p| {
        let (sine, cosine) = (std::f64::consts::PI * p.z).sin_cos();
        let (x, y) = (p.x - 0.5, p.y - 0.5);
        Point3::new(cosine * x - sine * y, sine * x + cosine * y, 4.0 * p.z)
    })
}

#[test]
fn a_twisted_bar_is_untwisted() {
    let (mesh, corners) = twisted_bar();
    assert!(mesh.not_positive().is_empty());
    let map = mapped(&mesh, &given(corners, Smoothing::default()));
    assert!(map.report.quality.distortion <= map.report.harmonic.distortion);
}

#[test]
fn folds_are_removed() {
    let (mesh, corners) = cube(5, |p| p);
    let map = mapped(&mesh, &given(corners, Smoothing::NONE));
    let mut parameters = map.parameters.clone();
    let inside: Vec<usize> = (0..parameters.len())
        .filter(|&v| map.masks[v] == 0)
        .collect();
    // Vertices inside are thrown far out of their places.
    for (k, &vertex) in inside.iter().enumerate() {
        for (d, x) in parameters[vertex].iter_mut().enumerate() {
            *x += 0.35 * ((7 * k + 3 * d) as f64).sin();
        }
    }
    assert!(measure(&mesh, &parameters).flipped > 50);
    let done = unfold(
        &mesh,
        &map.masks,
        &mut parameters,
        1e-6,
        [16, 500],
        &mut |_, _| true,
    );
    assert!(done.rounds > 0);
    let quality = measure(&mesh, &parameters);
    assert_eq!(quality.flipped, 0);
    assert!(quality.smallest_determinant > 1e-6);
}

/// A fold that no map with its boundary locked can mend is mended by sliding.
#[test]
fn boundary_vertices_slide() {
    let (mesh, corners) = cube(3, |p| p);
    let map = mapped(&mesh, &given(corners, Smoothing::NONE));
    let mut parameters = map.parameters.clone();
    let on_a_face = (0..parameters.len())
        .find(|&v| map.masks[v].count_ones() == 1)
        .unwrap();
    for axis in (0..3).filter(|&axis| free_axes(map.masks[on_a_face])[axis]) {
        parameters[on_a_face][axis] += 0.4;
    }
    assert!(measure(&mesh, &parameters).flipped > 0);
    unfold(
        &mesh,
        &map.masks,
        &mut parameters,
        1e-6,
        [16, 500],
        &mut |_, _| true,
    );
    assert_eq!(measure(&mesh, &parameters).flipped, 0);
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let mesh = ball();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| map(&mesh, &VolumeOptions::default(), &mut unobserved()).unwrap())
    };
    let one = run(1);
    for threads in [2, 3] {
        let other = run(threads);
        assert_eq!(one.parameters, other.parameters);
        assert_eq!(one.report, other.report);
    }
}

#[test]
fn a_score_of_the_caller_decides() {
    let mesh = ball();
    let mut seen = 0;
    let mut score = |trial: &Trial| {
        seen += 1;
        assert_eq!(trial.parameters.len(), mesh.vertex_count());
        if trial.frame.turn == 45.0 && trial.avoid_concave > 0.0 {
            0.0
        } else {
            1.0
        }
    };
    let map = map_scored(
        &mesh,
        &VolumeOptions::default(),
        &mut score,
        &mut unobserved(),
    )
    .unwrap();
    assert_eq!(seen, 8);
    assert_eq!(map.report.frame.unwrap().turn, 45.0);
    assert_eq!(map.report.avoid_concave, 4.0);
}

#[test]
fn corners_that_crowd_on_one_spot_split_cells() {
    let mesh = ball();
    let surface = mesh.boundary();
    let mut near = vec![0u32];
    for at in 0..3 {
        let vertex = near[at];
        near.extend(surface.topology().neighbours(vertex).collect::<Vec<_>>());
        near.sort_unstable();
        near.dedup();
    }
    let corners: [u32; 8] =
        std::array::from_fn(|corner| mesh.topology().boundary_vertices()[near[corner] as usize]);
    let options = VolumeOptions {
        folds: FoldOptions::Counted,
        ..given(corners, Smoothing::NONE)
    };
    let map = map(&mesh, &options, &mut unobserved()).unwrap();
    map.mesh.topology().sanity_check();
    assert!(map.report.boundary.corridor_splits > 0);
    assert!(map.mesh.not_positive().is_empty());
    assert_eq!(map.report.folded, 0);
}

#[test]
fn solids_that_are_no_ball_are_refused() {
    // A ring of boxes.
    let (full, _) = cube(3, |p| p);
    let centre = |cell: &[u32; 4]| {
        let sum = cell
            .iter()
            .map(|&v| full.positions()[v as usize].coords)
            .sum::<nalgebra::Vector3<f64>>();
        sum / 4.0
    };
    let hole = |c: &nalgebra::Vector3<f64>| {
        (1.0 / 3.0..2.0 / 3.0).contains(&c.x) && (1.0 / 3.0..2.0 / 3.0).contains(&c.y)
    };
    let cells = full
        .cells()
        .iter()
        .copied()
        .filter(|cell| !hole(&centre(cell)))
        .collect();
    let ring = TetMesh::build(full.positions().to_vec(), cells).unwrap();
    let error = map(&ring, &VolumeOptions::default(), &mut unobserved()).unwrap_err();
    assert_eq!(error, VolumeError::NotSphere(NotSphere::Genus { genus: 1 }));
    assert!(error.to_string().contains("without tunnels"), "{error}");
}

#[test]
fn inverted_cells_are_refused_by_number() {
    let (mesh, corners) = cube(3, |p| p);
    let mut positions = mesh.positions().to_vec();
    let inside = (0..positions.len()).find(|&v| mesh.topology().boundary_vertex(v as u32) == NONE);
    positions[inside.unwrap()].x += 1.0;
    let folded = mesh.with_positions(positions);
    let error = map(&folded, &given(corners, Smoothing::NONE), &mut unobserved()).unwrap_err();
    let bad = folded.not_positive();
    assert_eq!(
        error,
        VolumeError::NotPositive {
            count: bad.len(),
            first: bad[0]
        }
    );
    assert!(
        error
            .to_string()
            .starts_with(&format!("{} tetrahedra are inverted", bad.len()))
    );
}

#[test]
fn bad_corners_are_refused_by_name() {
    let (mesh, mut corners) = cube(3, |p| p);
    corners[3] = 21;
    let error = map(&mesh, &given(corners, Smoothing::NONE), &mut unobserved()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "corner 3 is vertex 21, which is not on the boundary; choose one that is"
    );
    corners[3] = corners[0];
    let error = map(&mesh, &given(corners, Smoothing::NONE), &mut unobserved()).unwrap_err();
    assert!(
        matches!(
            error,
            VolumeError::Boundary(BoundaryError::SameSpot {
                corners: [0, 3],
                ..
            })
        ),
        "{error}"
    );
}

#[test]
fn options_without_meaning_are_refused() {
    let (mesh, _) = cube(3, |p| p);
    let search = Search {
        turns: Vec::new(),
        ..Search::default()
    };
    let options = VolumeOptions {
        corners: Corners::Found(search),
        ..VolumeOptions::default()
    };
    let error = map(&mesh, &options, &mut unobserved()).unwrap_err();
    assert!(
        matches!(error, VolumeError::Number { name: "turns", .. }),
        "{error}"
    );
    let search = Search {
        evenness: vec![0.1, -1.0],
        ..Search::default()
    };
    let options = VolumeOptions {
        corners: Corners::Found(search),
        ..VolumeOptions::default()
    };
    let error = map(&mesh, &options, &mut unobserved()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`evenness` is -1; give a number that is finite and not negative"
    );
}

#[test]
fn the_observer_can_stop() {
    let (mesh, _) = cube(3, |p| p);
    let mut stop = |_: &Progress| ControlFlow::Break(());
    let error = map(&mesh, &VolumeOptions::default(), &mut stop).unwrap_err();
    assert_eq!(error, VolumeError::Stopped);
}

#[test]
fn a_boundary_with_free_borders_counts_its_folds() {
    let mesh = ball();
    let surface = mesh.boundary();
    let frame = Frame {
        turn: 0.0,
        evenness: 0.15,
    };
    let corners =
        find_corners(&surface, frame).map(|v| mesh.topology().boundary_vertices()[v as usize]);
    let options = VolumeOptions {
        boundary: BoundaryOptions::PAPER,
        folds: FoldOptions::Counted,
        ..given(corners, Smoothing::NONE)
    };
    let map = map(&mesh, &options, &mut unobserved()).unwrap();
    assert_eq!(map.report.boundary.folded, 0);
    assert_eq!(map.report.boundary.energy, None);
    assert_eq!(map.mesh.cell_count(), mesh.cell_count());
}
