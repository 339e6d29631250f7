//! A solid as other programs take it: values and text, no files.
//!
//! Exact Bézier cells come from [`TrivariateSpline::bezier_cells`], and their order in VTK from
//! [`vtk_hexahedron_order`](msplines_common::bspline::vtk_hexahedron_order).

use std::fmt::Write;

use crate::spline::TrivariateSpline;

/// Returns a solid as a `TensorBSpline3` in the XML of G+Smo: an `<xml>` document with one geometry.
///
/// The knots go from `-3/n` to `1 + 3/n` in steps of `1/n`, so that the domain is the unit cube; the first
/// index of control points varies fastest. Numbers have as many digits as they need to be read back
/// exactly.
#[must_use]
pub fn gismo_xml(spline: &TrivariateSpline) -> String {
    let n = spline.spans();
    let knot = |i: usize| (i as f64 - 3.0) / n as f64;
    let knots: Vec<String> = (0..n + 7).map(|i| knot(i).to_string()).collect();
    let knots = knots.join(" ");
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n");
    out.push_str(" <Geometry type=\"TensorBSpline3\" id=\"0\">\n");
    out.push_str("  <Basis type=\"TensorBSplineBasis3\">\n");
    for direction in 0..3 {
        // Writing to a string never fails.
        let _ = writeln!(
            out,
            "   <Basis type=\"BSplineBasis\" index=\"{direction}\">"
        );
        let _ = writeln!(out, "    <KnotVector degree=\"3\">{knots}</KnotVector>");
        out.push_str("   </Basis>\n");
    }
    out.push_str("  </Basis>\n  <coefs geoDim=\"3\">\n");
    for point in spline.points() {
        let _ = writeln!(out, "{} {} {}", point.x, point.y, point.z);
    }
    out.push_str("  </coefs>\n </Geometry>\n</xml>\n");
    out
}
