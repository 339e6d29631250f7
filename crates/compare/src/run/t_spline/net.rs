//! The form of a T-spline as squares on the mesh that it lies on, cut along the borders of cylinders.

use msplines_common::mesh::{SurfacePoint, TriangleMesh, VertexAttribute};
use msplines_common::{Point3, Vector3};
use msplines_t_spline::Domain;
use msplines_t_spline::complex::Cylinder;
use msplines_t_spline::domain::Patch;

use super::pictures::NET;
use crate::output::NORMALS;
use crate::run::{CHECKERS, Companion};

/// Squares of the form along the diagonal, where the form has its median scale.
const SQUARES: f64 = 40.0;
/// Rows are stretched by at most this share to be a whole number of pairs.
const STRETCHED: f64 = 0.08;
/// Pieces that a face is cut into at most: it may reach over several cylinders.
const PIECES: usize = 16;
/// Pieces lower than this share of their cylinder are left out.
const SLIVER: f64 = 1e-9;

/// Texture coordinates of the corners of every face.
type Texture = Vec<[[f64; 2]; 3]>;

/// A part of a face, by barycentric coordinates.
type Polygon = Vec<[f64; 3]>;

/// Returns the mesh of a form cut along the borders of cylinders, and squares of the form as the texture
/// of its faces: a whole number of pairs around every cylinder.
pub(super) fn net(domain: &Domain) -> (Companion, Texture) {
    let mesh = domain.mesh();
    let scales = scales(domain);
    let smooth = normals(mesh);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let mut texture = Texture::new();
    for face in 0..mesh.face_count() as u32 {
        let [a, b, c] = mesh.faces()[face as usize].map(|v| smooth[v as usize]);
        for (polygon, patch) in pieces(domain, face) {
            let scale = scales[patch.cylinder as usize];
            for i in 2..polygon.len() {
                let corners = [polygon[0], polygon[i - 1], polygon[i]];
                let square = |at| {
                    let [x, y] = place(&patch, at);
                    [x * scale[0] / CHECKERS, y * scale[1] / CHECKERS]
                };
                texture.push(corners.map(square));
                positions.extend(corners.map(|at| mesh.position(SurfacePoint { face, at })));
                normals.extend(corners.map(|[p, q, r]| (a * p + b * q + c * r).normalize()));
            }
        }
    }
    (companion(positions, &normals), texture)
}

/// Returns triangles that share no vertex, so that a cut needs no care.
fn companion(positions: Vec<Point3<f64>>, normals: &[Vector3<f64>]) -> Companion {
    let component = |(name, axis): (&str, usize)| VertexAttribute {
        name: name.to_owned(),
        values: normals.iter().map(|n| n[axis]).collect(),
    };
    let faces = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Companion {
        mesh: TriangleMesh::build(positions, faces.collect()).ok(),
        fields: NORMALS.into_iter().zip(0..).map(component).collect(),
        ..Companion::bare(NET)
    }
}

/// Returns the parts of a face on different cylinders, each laid out on its own.
fn pieces(domain: &Domain, face: u32) -> Vec<(Polygon, Patch)> {
    let mut found = Vec::new();
    let mut left: Vec<Polygon> = vec![vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
    while let Some(polygon) = left.pop() {
        let mean = |k: usize| polygon.iter().map(|at| at[k]).sum::<f64>() / polygon.len() as f64;
        let at = [0, 1, 2].map(mean);
        let patch = domain.patch(&SurfacePoint { face, at });
        let height = domain.complex().cylinders()[patch.cylinder as usize].height as f64;
        let [below, rest] = split(&polygon, |at| place(&patch, at)[1] / height);
        let [inside, above] = split(&rest, |at| place(&patch, at)[1] / height - 1.0);
        if inside.len() < 3 || found.len() + left.len() + 2 > PIECES {
            found.push((polygon, patch));
            continue;
        }
        found.push((inside, patch));
        left.extend([below, above].into_iter().filter(|rest| rest.len() > 2));
    }
    found
}

/// Returns the parts of a convex polygon where a linear function is negative, and where it is not.
fn split(polygon: &Polygon, value: impl Fn([f64; 3]) -> f64) -> [Polygon; 2] {
    let values: Vec<f64> = polygon.iter().map(|&at| value(at)).collect();
    if values.iter().all(|&v| v > -SLIVER) {
        return [Vec::new(), polygon.clone()];
    }
    if values.iter().all(|&v| v < SLIVER) {
        return [polygon.clone(), Vec::new()];
    }
    let mut parts = [Vec::new(), Vec::new()];
    for i in 0..polygon.len() {
        let next = (i + 1) % polygon.len();
        let (here, there) = (values[i], values[next]);
        parts[usize::from(here >= 0.0)].push(polygon[i]);
        if (here < 0.0) != (there < 0.0) {
            let share = here / (here - there);
            let cut = [0, 1, 2].map(|k| polygon[i][k] + share * (polygon[next][k] - polygon[i][k]));
            parts.iter_mut().for_each(|part| part.push(cut));
        }
    }
    parts
}

/// Returns where a point of a face lies on the cylinder that the face is laid out along.
fn place(patch: &Patch, at: [f64; 3]) -> [f64; 2] {
    let sum = |k: usize| patch.corners.iter().zip(at).map(|(c, w)| c[k] * w).sum();
    [sum(0), sum(1)]
}

/// Returns squares per unit along `x` and `y` of every cylinder. Where rows fit nearly, they are made to.
fn scales(domain: &Domain) -> Vec<[f64; 2]> {
    let side = median_scale(domain) * domain.mesh().diagonal() / SQUARES;
    let pairs = |length: f64, side: f64| 2.0 * (length / (2.0 * side)).round().max(1.0);
    let scale = |own: &Cylinder| {
        let [size, height] = [own.circumference, own.height].map(|n| n as f64);
        let x = pairs(size, side) / size;
        let y = pairs(height, 1.0 / x) / height;
        [
            x,
            if (y / x - 1.0).abs() < STRETCHED {
                y
            } else {
                x
            },
        ]
    };
    domain.complex().cylinders().iter().map(scale).collect()
}

/// Returns the median over the surface of lengths on the cylinders over lengths on the surface.
fn median_scale(domain: &Domain) -> f64 {
    let mesh = domain.mesh();
    let of_face = |face: u32| {
        let middle = SurfacePoint {
            face,
            at: [1.0 / 3.0; 3],
        };
        let [a, b, c] = domain.patch(&middle).corners;
        let flat = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let area = mesh.face_normal(face).norm();
        ((flat.max(0.0) / area).sqrt(), area)
    };
    let faces = (0..mesh.face_count() as u32).map(of_face);
    let mut scales: Vec<(f64, f64)> = faces.filter(|(scale, _)| scale.is_normal()).collect();
    scales.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = scales.iter().map(|(_, area)| area).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let median = scales.iter().find(|(_, area)| {
        sum += area;
        sum >= half
    });
    median.map_or(1.0, |found| found.0)
}

/// Returns the normals of vertices, the means of their faces.
fn normals(mesh: &TriangleMesh) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.vertex_count()];
    for (face, vertices) in (0..).zip(mesh.faces()) {
        let normal = mesh.face_normal(face);
        vertices.iter().for_each(|&v| normals[v as usize] += normal);
    }
    normals
}
