//! Surfaces as plain numbers.

use msplines_common::evaluate::Order;
use msplines_common::mesh::shapes;

use super::{corners, fitted, samples};
use crate::surface::CapParts;
use crate::{Fill, PowellSabinSurface, SurfaceError};

#[test]
fn a_surface_comes_back_with_the_same_bits() {
    for fill in [Fill::Open, Fill::Smooth, Fill::Minimal] {
        for mesh in [shapes::genus(2, 2500), shapes::sphere(700)] {
            let (found, _) = fitted(&mesh, fill);
            let parts = found.spline.parts();
            let again = PowellSabinSurface::from_parts(found.spline.mesh().clone(), &parts);
            let again = again.expect("a surface");
            assert!(again.parts() == parts);
            assert_eq!(again.dofs(), found.spline.dofs());
            let mut points = corners(again.mesh());
            points.retain(|p| !again.is_open(p.face));
            for point in &mut points {
                point.at = point.at.map(|c| 0.25 * c + 0.25);
            }
            let [a, b] = [&found.spline, &again].map(|s| samples(s, &points, Order::Second));
            assert!(a == b);
        }
    }
}

#[test]
fn numbers_that_do_not_fit_are_refused() {
    let (found, _) = fitted(&shapes::genus(2, 2500), Fill::Smooth);
    let mesh = found.spline.mesh();
    let refused = |change: &dyn Fn(&mut crate::surface::SurfaceParts)| {
        let mut parts = found.spline.parts();
        change(&mut parts);
        let again = PowellSabinSurface::from_parts(mesh.clone(), &parts);
        again.expect_err("an error").to_string()
    };
    let text = refused(&|p| p.holes[0].faces.push(u32::MAX));
    assert!(
        text.contains("hole 0") && text.contains("write the file anew"),
        "{text}"
    );
    let text = refused(&|p| p.holes[1].order = 0);
    assert!(text.contains("hole 1"), "{text}");
    let text = refused(&|p| {
        let CapParts::Smooth { chart, .. } = &mut p.holes[0].cap else {
            panic!("a smooth cap");
        };
        chart.pop();
    });
    assert!(text.contains("hole 0"), "{text}");
    let text = refused(&|p| {
        let CapParts::Smooth { values, .. } = &mut p.holes[0].cap else {
            panic!("a smooth cap");
        };
        values[0][0] = f64::NAN;
    });
    assert!(
        text.contains("hole 0") && text.contains("not finite"),
        "{text}"
    );
    let text = refused(&|p| {
        p.holes[1].cap = CapParts::Minimal {
            points: vec![[0.0; 3]],
        };
    });
    assert!(text.contains("control points"), "{text}");
    let text = refused(&|p| p.edge_vectors.truncate(5));
    assert!(text.contains("5 edge vectors"), "{text}");
    let text = refused(&|p| p.values.truncate(2));
    assert!(text.contains("do not fit"), "{text}");
    let mut parts = found.spline.parts();
    parts.holes.clear();
    // Without holes the form has zeros in the domain.
    let whole = PowellSabinSurface::from_parts(mesh.clone(), &parts);
    assert!(matches!(
        whole.err(),
        Some(SurfaceError::Spline(_) | SurfaceError::Domain(_))
    ));
}
