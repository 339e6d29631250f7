//! Cylinders of generated surfaces.

use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes};
use msplines_common::progress::unobserved;

use msplines_conformal::poles::PoleChoice;

use crate::complex::{Beyond, Border, Point};
use crate::domain::{Domain, DomainOptions, End, SnapOptions};

use super::{distance, farthest_jump, farthest_vertex};

/// Rounding of places, in units of 2^-44: sums of some hundred differences of size one, each right to
/// about 2^-53, and lengths rounded to whole units.
const ROUNDING: f64 = 40.0;

/// Nothing is collapsed or turned.
const PLAIN: SnapOptions = SnapOptions {
    thin: 0.0,
    sliver: 0.0,
    twist: 0.0,
    hole: 0.0,
};

fn cut(mesh: &TriangleMesh, poles: &[u32], snap: SnapOptions) -> Domain {
    let options = DomainOptions {
        poles: poles.to_vec(),
        snap,
        ..DomainOptions::default()
    };
    Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain")
}

/// Checks what holds on every domain.
pub(super) fn check(domain: &Domain) {
    let (jump, vertex) = (farthest_jump(domain), farthest_vertex(domain));
    assert!(
        jump < ROUNDING && vertex < ROUNDING,
        "{jump}, {vertex} units"
    );
    let report = domain.report();
    assert!(report.closure < 1e-12 && report.area_defect.abs() < 1e-12);
    let (genus, ends) = (i64::from(report.genus), report.ends as i64);
    assert_eq!(i64::from(report.zeros), 2 * genus - 2 + ends);
    let cylinders = domain.complex().cylinders();
    assert_eq!(cylinders.len() + report.collapsed, report.cylinders);
    check_zeros(domain);
}

/// Every corner of a face at a zero lies where a table names that zero.
fn check_zeros(domain: &Domain) {
    let mut corners: Vec<(u32, Point)> = Vec::new();
    for (cylinder, own) in (0..).zip(domain.complex().cylinders()) {
        for (border, y) in [(Border::Bottom, 0), (Border::Top, own.height)] {
            let segments = domain.complex().border(cylinder, border).iter();
            corners.extend(segments.filter_map(|segment| {
                let (x, y) = (segment.start as f64, y as f64);
                segment.zero.map(|zero| (zero, Point { cylinder, x, y }))
            }));
        }
    }
    let topology = domain.mesh().topology();
    for (zero, own) in (0..).zip(domain.zeros()) {
        assert_eq!(corners.iter().filter(|corner| corner.0 == zero).count(), 4);
        for half_edge in topology.outgoing(own.vertex) {
            let mut at = [0.0; 3];
            at[half_edge as usize % 3] = 1.0;
            let face = half_edge / 3;
            let placed = domain.place(&SurfacePoint { face, at });
            let named = corners.iter().filter(|corner| corner.0 == zero);
            let apart = named.map(|corner| distance(domain, placed, corner.1));
            let nearest = apart.fold(f64::INFINITY, f64::min);
            assert!(
                nearest < ROUNDING,
                "zero {zero} is {nearest} units from the tables"
            );
        }
    }
}

#[test]
fn a_torus_is_one_cylinder_glued_to_itself() {
    let domain = cut(&shapes::torus(1.0, 0.4, 900), &[], SnapOptions::default());
    check(&domain);
    let [own] = domain.complex().cylinders() else {
        panic!("one cylinder")
    };
    // A period of one, in whole units exactly.
    assert_eq!(own.height, 1 << 44);
    assert_eq!((own.bottom[0].start, own.bottom.len()), (0, 1));
    let first = domain.vertex(0);
    assert!(
        distance(
            &domain,
            first,
            Point {
                cylinder: 0,
                x: 0.0,
                y: 0.0
            }
        ) < 1.0
    );
}

#[test]
fn handles_make_pairs_of_pants() {
    for (handles, vertices) in [(2, 2400), (3, 4800), (5, 6000)] {
        let mesh = shapes::genus(handles, vertices);
        let plain = cut(&mesh, &[], PLAIN);
        check(&plain);
        assert_eq!(plain.complex().cylinders().len() as u32, 3 * handles - 3);
        let snapped = cut(&mesh, &[], SnapOptions::default());
        check(&snapped);
        // What hangs on a graph that moves grows and shrinks alike.
        assert_eq!(plain.complex().area(), snapped.complex().area());
        let vertices = 0..mesh.vertex_count();
        assert!(
            vertices
                .clone()
                .all(|v| snapped.origins()[v] == Some(v as u32))
        );
    }
}

#[test]
fn two_poles_of_a_sphere_leave_one_cylinder_and_three_a_zero() {
    let mesh = shapes::bumpy_sphere(2562);
    let far = |axis: [f64; 3]| {
        let height = |v: &u32| {
            let p = mesh.positions()[*v as usize];
            p.x * axis[0] + p.y * axis[1] + p.z * axis[2]
        };
        let vertices = 0..mesh.vertex_count() as u32;
        vertices
            .max_by(|a, b| height(a).total_cmp(&height(b)))
            .unwrap()
    };
    let poles = [
        far([0.0, 0.0, 1.0]),
        far([0.0, 0.0, -1.0]),
        far([1.0, 0.1, 0.0]),
    ];
    let domain = cut(&mesh, &poles[..2], SnapOptions::default());
    check(&domain);
    assert_eq!(domain.complex().cylinders().len(), 1);
    let named: Vec<End> = [Border::Bottom, Border::Top]
        .map(|border| match domain.complex().border(0, border) {
            // A table that starts within the loop names it twice.
            [one, ..] => match one.beyond {
                Beyond::Pole { index } => domain.ends()[index as usize],
                _ => End::Boundary,
            },
            [] => End::Boundary,
        })
        .to_vec();
    assert!(
        poles[..2]
            .iter()
            .all(|&pole| named.contains(&End::Pole(pole))),
        "{named:?}"
    );
    let domain = cut(&mesh, &poles, PLAIN);
    check(&domain);
    assert_eq!(
        (domain.complex().cylinders().len(), domain.zeros().len()),
        (3, 1)
    );
}

#[test]
fn boundaries_are_borders() {
    let domain = cut(&shapes::cylinder(900), &[], SnapOptions::default());
    check(&domain);
    let [own] = domain.complex().cylinders() else {
        panic!("one cylinder")
    };
    assert!(matches!(own.top[0].beyond, Beyond::Boundary { .. }));
    assert!(matches!(own.bottom[0].beyond, Beyond::Boundary { .. }));
    let topology = domain.mesh().topology();
    for half_edge in topology.boundary_loops().into_iter().flatten() {
        let y = domain.vertex(topology.origin(half_edge)).y;
        assert!(
            y == 0.0 || y == own.height as f64,
            "exactly on the border: {y}"
        );
    }
}

#[test]
fn handles_and_poles_go_together() {
    let mesh = shapes::genus(2, 4800);
    let x = |v: &u32| mesh.positions()[*v as usize].x;
    let vertices = 0..mesh.vertex_count() as u32;
    let left = vertices.clone().min_by(|a, b| x(a).total_cmp(&x(b)));
    let right = vertices.max_by(|a, b| x(a).total_cmp(&x(b)));
    let poles = [left.unwrap(), right.unwrap()];
    let options = DomainOptions {
        poles: poles.to_vec(),
        pole_form: PoleChoice::Given {
            class: vec![1, 1, 0, 0],
            fluxes: vec![0.5, -0.5],
        },
        snap: PLAIN,
        ..DomainOptions::default()
    };
    let domain = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
    check(&domain);
    // 2g - 2 + b and 3g - 3 + 2b.
    let counts = (domain.zeros().len(), domain.complex().cylinders().len());
    assert_eq!(counts, (4, 7));
    assert_eq!(domain.ends().len(), 2);
    assert!((poles.iter()).all(|&pole| domain.ends().contains(&End::Pole(pole))));
}
