//! Solids in the XML of G+Smo against SciPy's tensor product of B-splines.

use msplines_reference::python::Python;
use msplines_reference::record::Comparison;
use msplines_reference::{Library, splines};
use nalgebra::Point3;
use serde::Deserialize;
use serde_json::json;

/// Rounding: knots are rounded in the file, and weights are summed in another order.
const ROUNDING: f64 = 1e-12;
/// Points of each solid.
const POINTS: usize = 600;

/// What SciPy makes of a file.
#[derive(Deserialize)]
struct Evaluated {
    domain: [[f64; 2]; 3],
    points: Vec<[f64; 3]>,
}

#[test]
fn the_xml_of_gismo_is_the_solid() -> Result<(), Box<dyn std::error::Error>> {
    let why = "relative to the diagonal of the control points";
    let mut comparison = Comparison::new("G+Smo solid", Library::Scipy, ROUNDING, why);
    let mut python = Python::start()?;
    for (name, spline) in splines::all() {
        let folder = tempfile::tempdir()?;
        let [path] = &splines::write(&spline, folder.path(), &["solid.xml"], 1)[..] else {
            panic!("one file")
        };
        let parameters = splines::parameters(spline.spans(), POINTS, 7);
        let question = json!({"path": path, "parameters": parameters});
        let theirs: Evaluated = python.ask("gismo_points", &question)?;
        assert_eq!(theirs.domain, [[0.0, 1.0]; 3], "{name}");
        assert_eq!(theirs.points.len(), POINTS, "{name}");
        let size = splines::size(&spline);
        for (&parameter, theirs) in parameters.iter().zip(theirs.points) {
            let apart = spline.position(parameter) - Point3::from(theirs);
            comparison.add(&name, [apart.norm() / size]);
        }
    }
    comparison.finish();
    Ok(())
}
