//! Bézier cells in VTU files. That VTK takes them for what they are, `tests/reference` tells.

use msplines_common::bspline::{BezierCells, CellShape};
use msplines_io::{Field, WriteError, write_cells};
use nalgebra::Point3;

use crate::common::scratch;
use crate::output::{Array, doubles, integers, parse};

/// Returns control points that can be told apart.
fn points(count: usize) -> Vec<Point3<f64>> {
    let point = |i: usize| Point3::new(i as f64, 0.1 * i as f64, (i * i) as f64);
    (0..count).map(point).collect()
}

fn field<'a>(name: &'a str, values: &'a [f64]) -> Field<'a> {
    Field {
        name,
        components: 1,
        values,
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

fn find<'a>(arrays: &'a [Array], name: &str) -> &'a [u8] {
    let array = arrays.iter().find(|array| array.name == name);
    &array.expect("an array of this name").bytes
}

#[test]
fn quadratic_triangles_keep_their_points_and_name_them_as_vtk_does() {
    let weights: Vec<f64> = (1..=12).map(|i| 1.0 / f64::from(i)).collect();
    let shape = CellShape::Triangles;
    let cells = BezierCells::build(shape, [2, 0, 0], points(12), Some(weights.clone())).unwrap();
    let heights: Vec<f64> = (0..12).map(|i| 0.3 * f64::from(i)).collect();
    let (_directory, path) = scratch("a.vtu");
    let (point_data, cell_data) = ([field("height", &heights)], [field("face", &[7.0, 3.0])]);
    write_cells(&path, &cells, &point_data, &cell_data).unwrap();
    let file = std::fs::read(&path).unwrap();
    let (_, arrays) = parse(&file);
    let coordinates: Vec<f64> = points(12).iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    assert_eq!(doubles(find(&arrays, "Points")), bits(&coordinates));
    let connectivity = [0, 2, 5, 1, 4, 3, 6, 8, 11, 7, 10, 9];
    assert_eq!(integers(find(&arrays, "connectivity")), connectivity);
    assert_eq!(integers(find(&arrays, "offsets")), [6, 12]);
    assert_eq!(find(&arrays, "types"), [76, 76]);
    assert_eq!(doubles(find(&arrays, "RationalWeights")), bits(&weights));
    assert_eq!(doubles(find(&arrays, "height")), bits(&heights));
    assert_eq!(doubles(find(&arrays, "face")), bits(&[7.0, 3.0]));
    let text = String::from_utf8_lossy(&file);
    assert!(text.contains("<PointData RationalWeights=\"RationalWeights\">"));
    // Without weights no array is taken for them, and the same cells give the same bytes.
    let plain = BezierCells::build(shape, [2, 0, 0], points(12), None).unwrap();
    write_cells(&path, &plain, &[], &[]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("RationalWeights"));
    write_cells(&path, &plain, &[], &[]).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}

#[test]
fn degrees_that_differ_are_told() {
    for (shape, degree, kind) in [
        (CellShape::Quads, [2, 3, 0], 77),
        (CellShape::Hexahedra, [1, 2, 1], 79),
        (CellShape::Quads, [3, 3, 0], 77),
    ] {
        let per_cell = (degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1);
        let cells = BezierCells::build(shape, degree, points(2 * per_cell), None).unwrap();
        let (_directory, path) = scratch("a.vtu");
        write_cells(&path, &cells, &[], &[]).unwrap();
        let (_, arrays) = parse(&std::fs::read(&path).unwrap());
        assert_eq!(find(&arrays, "types"), [kind; 2]);
        let told = arrays.iter().find(|a| a.name == "HigherOrderDegrees");
        let expected = degree.map(|d| d as f64).repeat(2);
        match told {
            Some(told) => assert_eq!(doubles(&told.bytes), bits(&expected)),
            None => assert_eq!(degree, [3, 3, 0]),
        }
    }
}

#[test]
fn triangles_of_different_degrees_are_one_grid() {
    let build = |degree: usize, count: usize| {
        BezierCells::build(CellShape::Triangles, [degree, 0, 0], points(count), None).unwrap()
    };
    let cells = build(2, 6).joined(build(3, 20)).unwrap();
    let (_directory, path) = scratch("a.vtu");
    let faces = field("face", &[4.0, 5.0, 6.0]);
    write_cells(&path, &cells, &[], &[faces]).unwrap();
    let file = std::fs::read(&path).unwrap();
    let (_, arrays) = parse(&file);
    assert_eq!(integers(find(&arrays, "offsets")), [6, 16, 26]);
    assert_eq!(find(&arrays, "types"), [76; 3]);
    // Corners, edges along their way, the point inside, after those of the cells before.
    let cubic = [0, 3, 9, 1, 2, 6, 8, 7, 4, 5];
    let rows = [6, 16].map(|first| cubic.map(|place| first + place));
    let connectivity: Vec<i64> = [0, 2, 5, 1, 4, 3]
        .into_iter()
        .chain(rows.concat())
        .collect();
    assert_eq!(integers(find(&arrays, "connectivity")), connectivity);
    assert!(arrays.iter().all(|a| a.name != "HigherOrderDegrees"));
}

#[test]
fn unfit_cells_are_not_written() {
    let shape = CellShape::Triangles;
    let build = |degree, points, weights| {
        BezierCells::build(shape, [degree, 0, 0], points, weights).unwrap()
    };
    let plain = build(2, points(6), None);
    let (_directory, path) = scratch("a.vtu");
    let refuse = |cells: &BezierCells, point_data: &[Field<'_>], cell_data: &[Field<'_>]| {
        let error = write_cells(&path, cells, point_data, cell_data).unwrap_err();
        assert!(!path.exists());
        error.to_string()
    };
    let text = refuse(&build(0, points(1), None), &[], &[]);
    assert!(text.contains("degree 0"), "{text}");
    for weight in [0.0, -1.0, f64::NAN] {
        let weights = vec![1.0, weight, 1.0, 1.0, 1.0, 1.0];
        let text = refuse(&build(2, points(6), Some(weights)), &[], &[]);
        assert!(text.contains("the weight of control point 1 is"), "{text}");
    }
    let mut broken = points(6);
    broken[4].z = f64::INFINITY;
    let text = refuse(&build(2, broken, None), &[], &[]);
    assert!(text.contains("`position` of vertex 4"), "{text}");
    let text = refuse(&plain, &[field("height", &[1.0; 3])], &[]);
    assert!(text.contains("`height` has 3 values for 6"), "{text}");
    let text = refuse(&plain, &[], &[field("face", &[1.0; 3])]);
    assert!(text.contains("`face` has 3 values for 1"), "{text}");
    let rational = build(2, points(6), Some(vec![1.0; 6]));
    let text = refuse(&rational, &[field("RationalWeights", &[1.0; 6])], &[]);
    assert!(text.contains("attribute `RationalWeights`"), "{text}");
    let error = write_cells("a.msh".as_ref(), &plain, &[], &[]).unwrap_err();
    assert!(matches!(error, WriteError::BezierFormat { .. }));
}
