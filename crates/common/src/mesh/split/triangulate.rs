//! Triangles between points of one face.

use nalgebra::Point3;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::weights::{WHOLE, Weights, double_area};

/// Returns the triangles between distinct points of a face, as indices into `points`.
///
/// The first `outline` points run around the face, corners and points on its sides; the others lie
/// inside. The triangles are those of the constrained Delaunay triangulation of the face laid out
/// in the plane, whose constraints are the pieces of the sides. A layout rounds: points of a side
/// come to lie beside it, and in a needle even the order of points can change. So what comes out is
/// checked exactly, in integers. Where it fails, the Delaunay triangulation of the barycentric
/// coordinates is taken, which a double holds exactly: a worse shape, but always a triangulation.
///
/// # Panics
/// If two points are equal, or `outline` is less than three.
pub(super) fn triangulate(
    points: &[Weights],
    outline: usize,
    corners: &[Point3<f64>; 3],
) -> Vec<[usize; 3]> {
    const EXACT: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    [lay_out(corners), EXACT]
        .iter()
        .find_map(|plane| constrained_delaunay(points, outline, plane))
        .expect("distinct points have a triangulation, and its predicates are exact")
}

/// Returns the corners of a triangle moved into the plane and scaled to a longest side of one.
fn lay_out(corners: &[Point3<f64>; 3]) -> [[f64; 2]; 3] {
    let side = |i: usize| corners[(i + 1) % 3] - corners[i];
    let lengths = [0, 1, 2].map(|i| side(i).norm());
    // The longest side as base: the third corner stands above it, and rounds least.
    let base = (0..3).fold(
        0,
        |best, i| if lengths[i] > lengths[best] { i } else { best },
    );
    let (along, across) = (side(base) / lengths[base], -side((base + 2) % 3));
    let apex = [along.dot(&across), along.cross(&across).norm()].map(|x| x / lengths[base]);
    let mut plane = [[0.0; 2]; 3];
    plane[(base + 1) % 3] = [1.0, 0.0];
    plane[(base + 2) % 3] = apex;
    plane
}

/// Returns the triangulation of the points with these places of the corners, if it is one of the
/// face.
fn constrained_delaunay(
    points: &[Weights],
    outline: usize,
    plane: &[[f64; 2]; 3],
) -> Option<Vec<[usize; 3]>> {
    let place = |weights: &Weights| {
        let at = weights.to_coordinates();
        let sum = |axis: usize| (0..3).map(|i| at[i] * plane[i][axis]).sum();
        Point2::<f64>::new(sum(0), sum(1))
    };
    // One by one: loading them at once would make constraints in an order that differs from run
    // to run.
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        let handle = triangulation.insert(place(point)).ok()?;
        if handle.index() != index {
            return None;
        }
        handles.push(handle);
    }
    for index in 0..outline {
        triangulation.try_add_constraint(handles[index], handles[(index + 1) % outline]);
    }
    let triangles = triangulation.inner_faces();
    let triangles = triangles.map(|face| face.vertices().map(|vertex| vertex.fix().index()));
    covering(triangles, points, outline)
}

/// Returns the triangles that have an area, if they cover the face once.
///
/// A triangle outside of a side is one of three points of that side: it has no area.
fn covering(
    triangles: impl Iterator<Item = [usize; 3]>,
    points: &[Weights],
    outline: usize,
) -> Option<Vec<[usize; 3]>> {
    let area = |triangle: &[usize; 3]| double_area(triangle.map(|i| points[i]));
    let kept: Vec<[usize; 3]> = triangles.filter(|t| area(t) != 0).collect();
    // Euler: a triangulated disk has two triangles for each inner vertex, one for each outer one,
    // less two.
    let expected = 2 * (points.len() - outline) + outline - 2;
    let positive = kept.iter().all(|t| area(t) > 0);
    let whole = kept.iter().map(area).sum::<i128>() == WHOLE;
    (kept.len() == expected && positive && whole).then_some(kept)
}

#[cfg(test)]
mod tests {
    use super::super::weights::ONE;
    use super::*;

    fn face(third: [f64; 3]) -> [Point3<f64>; 3] {
        [[0.0; 3], [1.0, 0.0, 0.0], third].map(Point3::from)
    }

    #[test]
    fn a_layout_keeps_lengths_up_to_scale_and_orientation() {
        let corners = [[1.0, 2.0, 3.0], [4.0, 2.0, -1.0], [0.0, 9.0, 2.0]].map(Point3::from);
        let plane = lay_out(&corners);
        let length = |i: usize, j: usize| {
            let [p, q] = [plane[i], plane[j]];
            (p[0] - q[0]).hypot(p[1] - q[1]) / (corners[i] - corners[j]).norm()
        };
        assert!((length(0, 1) / length(1, 2) - 1.0).abs() < 1e-14);
        assert!((length(0, 1) / length(2, 0) - 1.0).abs() < 1e-14);
        let [a, b, c] = plane;
        assert!((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]));
    }

    #[test]
    fn a_point_inside_makes_three_triangles_and_one_on_a_side_two() {
        let corners = [0, 1, 2].map(Weights::corner);
        let mut points = corners.to_vec();
        points.push(Weights::round([0.2, 0.3, 0.5]));
        assert_eq!(triangulate(&points, 3, &face([0.0, 1.0, 0.0])).len(), 3);
        let points = [
            corners[0],
            corners[1],
            Weights::on_side(1, ONE / 3),
            corners[2],
        ];
        assert_eq!(triangulate(&points, 4, &face([0.3, 0.7, 0.1])).len(), 2);
    }

    #[test]
    fn no_circle_around_a_triangle_holds_a_point() {
        let inside = [
            [2.0, 3.0, 5.0],
            [6.0, 3.0, 1.0],
            [4.0, 4.0, 2.0],
            [1.0, 1.0, 8.0],
        ];
        let mut points = vec![
            Weights::corner(0),
            Weights::on_side(0, ONE / 3),
            Weights::corner(1),
            Weights::corner(2),
        ];
        points.extend(inside.map(|at| Weights::round(at.map(|x: f64| x / 10.0))));
        let corners = face([0.4, 2.0, 1.0]);
        let triangles = triangulate(&points, 4, &corners);
        assert_eq!(triangles.len(), 2 * 4 + 4 - 2);
        let plane = lay_out(&corners);
        let place = |i: usize| {
            let at = points[i].to_coordinates();
            [0, 1].map(|axis| (0..3).map(|k| at[k] * plane[k][axis]).sum::<f64>())
        };
        for triangle in triangles {
            for point in 0..points.len() {
                let [x, y] = place(point);
                // The rows of the in-circle determinant, relative to the point.
                let rows = triangle.map(|i| {
                    let [u, v] = [place(i)[0] - x, place(i)[1] - y];
                    nalgebra::RowVector3::new(u, v, u * u + v * v)
                });
                let inside = nalgebra::Matrix3::from_rows(&rows).determinant();
                assert!(inside < 1e-15, "{point} in {triangle:?}: {inside}");
            }
        }
    }

    #[test]
    fn faces_without_area_and_needles_are_triangulated_all_the_same() {
        let corners = [0, 1, 2].map(Weights::corner);
        let points = [
            corners[0],
            Weights::on_side(0, ONE / 7),
            Weights::on_side(0, ONE / 2),
            corners[1],
            Weights::on_side(1, ONE / 3),
            corners[2],
            Weights::on_side(2, ONE / 5),
            Weights::round([0.3, 0.3, 0.4]),
            Weights::round([0.3, 0.3 + 1e-8, 0.4 - 1e-8]),
        ];
        for third in [
            [0.5, 1e-9, 0.0],
            [0.5, 1e-17, 0.0],
            [0.3, 0.0, 0.0],
            [1e9, 1.0, 0.0],
            [0.0; 3],
        ] {
            assert_eq!(triangulate(&points, 7, &face(third)).len(), 9, "{third:?}");
        }
        assert_eq!(triangulate(&points, 7, &[Point3::origin(); 3]).len(), 9);
    }
}
