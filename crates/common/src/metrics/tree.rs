//! Closest points on a triangle mesh, by a tree of bounding boxes.

use nalgebra::Point3;

use crate::mesh::{SurfacePoint, TriangleMesh};

/// Triangles in a leaf: fewer make the tree deeper than the boxes are worth.
const LEAF: usize = 4;

/// A point of a surface and how far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The closest point.
    pub point: SurfacePoint,
    /// Its distance.
    pub distance: f64,
}

/// A tree over the faces of a mesh that answers closest-point queries.
///
/// Built in O(n log n); a query takes about O(log n).
#[derive(Clone, Debug)]
pub struct SurfaceTree {
    nodes: Vec<Node>,
    triangles: Vec<[Point3<f64>; 3]>,
    faces: Vec<u32>,
}

/// A box over `count` triangles from `first`; or, with no triangles, over its left child, which
/// follows it, and its right child at `first`.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Point3<f64>,
    high: Point3<f64>,
    first: u32,
    count: u32,
}

impl Node {
    fn squared_distance(&self, point: &Point3<f64>) -> f64 {
        let outside = (self.low - point).sup(&(point - self.high));
        outside.map(|x| x.max(0.0)).norm_squared()
    }
}

impl SurfaceTree {
    /// Returns the tree of a mesh.
    #[must_use]
    pub fn build(mesh: &TriangleMesh) -> Self {
        let centres: Vec<Point3<f64>> = (0..mesh.face_count() as u32)
            .map(|f| {
                let [a, b, c] = mesh.triangle(f);
                a + ((b - a) + (c - a)) / 3.0
            })
            .collect();
        let mut faces: Vec<u32> = (0..mesh.face_count() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * faces.len() / LEAF + 1);
        split(mesh, &centres, &mut faces, 0, &mut nodes);
        let triangles = faces.iter().map(|&f| mesh.triangle(f)).collect();
        Self {
            nodes,
            triangles,
            faces,
        }
    }

    /// Returns the point of the surface that is closest to `point`; `None` without faces.
    #[must_use]
    pub fn closest(&self, point: &Point3<f64>) -> Option<Closest> {
        let (slot, squared) = self.search(point, None)?;
        let (at, _) = closest_on_triangle(&self.triangles[slot as usize], point);
        let point = SurfacePoint {
            face: self.faces[slot as usize],
            at,
        };
        Some(Closest {
            point,
            distance: squared.sqrt(),
        })
    }

    /// Returns the place in the tree of the closest triangle and the squared distance to it.
    /// `hint`, a place that is likely near, makes the search shorter.
    pub(super) fn search(&self, point: &Point3<f64>, hint: Option<u32>) -> Option<(u32, f64)> {
        let distance = |slot: u32| closest_on_triangle(&self.triangles[slot as usize], point).1;
        let root = self.nodes.first()?;
        let mut best = hint.map_or((u32::MAX, f64::INFINITY), |slot| (slot, distance(slot)));
        // Halving the triangles at each step keeps the tree less than 32 deep.
        let mut stack = [(0.0, 0u32); 64];
        stack[0] = (root.squared_distance(point), 0);
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (bound, index) = stack[height];
            if bound >= best.1 {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for slot in node.first..node.first + node.count {
                    let squared = distance(slot);
                    if squared < best.1 {
                        best = (slot, squared);
                    }
                }
                continue;
            }
            let children = [index + 1, node.first]
                .map(|child| (self.nodes[child as usize].squared_distance(point), child));
            let nearer = usize::from(children[1].0 < children[0].0);
            stack[height] = children[1 - nearer];
            stack[height + 1] = children[nearer];
            height += 2;
        }
        (best.0 != u32::MAX).then_some(best)
    }
}

fn split(
    mesh: &TriangleMesh,
    centres: &[Point3<f64>],
    faces: &mut [u32],
    first: u32,
    nodes: &mut Vec<Node>,
) {
    let infinity = [f64::INFINITY; 3];
    let (mut low, mut high) = (Point3::from(infinity), -Point3::from(infinity));
    let (mut inner_low, mut inner_high) = (low, high);
    for &face in faces.iter() {
        for corner in mesh.triangle(face) {
            (low, high) = (low.inf(&corner), high.sup(&corner));
        }
        let centre = centres[face as usize];
        (inner_low, inner_high) = (inner_low.inf(&centre), inner_high.sup(&centre));
    }
    let here = nodes.len();
    nodes.push(Node {
        low,
        high,
        first,
        count: faces.len() as u32,
    });
    if faces.len() <= LEAF {
        return;
    }
    let axis = (inner_high - inner_low).imax();
    let key = |face: &u32| centres[*face as usize][axis];
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let (left, right) = faces.split_at_mut(middle);
    split(mesh, centres, left, first, nodes);
    nodes[here].first = nodes.len() as u32;
    nodes[here].count = 0;
    split(mesh, centres, right, first + middle as u32, nodes);
}

/// Returns the barycentric coordinates of the point of a triangle closest to `point`, and its
/// squared distance.
fn closest_on_triangle([a, b, c]: &[Point3<f64>; 3], point: &Point3<f64>) -> ([f64; 3], f64) {
    let (ab, ac) = (b - a, c - a);
    let (from_a, from_b, from_c) = (point - a, point - b, point - c);
    let (d1, d2) = (ab.dot(&from_a), ac.dot(&from_a));
    let (d3, d4) = (ab.dot(&from_b), ac.dot(&from_b));
    let (d5, d6) = (ab.dot(&from_c), ac.dot(&from_c));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let at = if d1 <= 0.0 && d2 <= 0.0 {
        [1.0, 0.0, 0.0]
    } else if d3 >= 0.0 && d4 <= d3 {
        [0.0, 1.0, 0.0]
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        [1.0 - t, t, 0.0]
    } else if d6 >= 0.0 && d5 <= d6 {
        [0.0, 0.0, 1.0]
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        [1.0 - t, 0.0, t]
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        [0.0, 1.0 - t, t]
    } else {
        let sum = va + vb + vc;
        [1.0 - (vb + vc) / sum, vb / sum, vc / sum]
    };
    let offset = from_a - ab * at[1] - ac * at[2];
    (at, offset.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::zoo;

    #[test]
    fn the_tree_finds_what_a_search_of_all_triangles_finds() {
        for mesh in [zoo::closed(), zoo::with_boundary(), zoo::knotted()] {
            let tree = SurfaceTree::build(&mesh);
            for i in 0..300 {
                let [x, y, z] = [0.7, 1.3, 2.9].map(|w| 2.5 * (w * f64::from(i)).sin());
                let point = Point3::new(x, y, z);
                let all = (0..mesh.face_count() as u32)
                    .map(|f| closest_on_triangle(&mesh.triangle(f), &point).1)
                    .fold(f64::INFINITY, f64::min);
                let found = tree.closest(&point).unwrap();
                assert_eq!(found.distance, all.sqrt());
                let reached = (mesh.position(found.point) - point).norm();
                assert!((reached - found.distance).abs() < 1e-12);
                assert_eq!(tree.search(&point, Some(7)).unwrap().1, all);
            }
        }
    }
}
