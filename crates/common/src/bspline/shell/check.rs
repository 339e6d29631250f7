//! What is no shell.

use std::fmt;

use nalgebra::Point3;

use super::{BezierEdge, BezierFace};

/// A part of a shell, as errors name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellPart {
    /// A vertex.
    Vertex(usize),
    /// An edge.
    Edge(usize),
    /// A face.
    Face(usize),
}

impl fmt::Display for ShellPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(vertex) => write!(f, "vertex {vertex}"),
            Self::Edge(edge) => write!(f, "edge {edge}"),
            Self::Face(face) => write!(f, "face {face}"),
        }
    }
}

/// Why patches, edges and vertices are no shell.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShellError {
    /// There are no faces.
    #[error("a shell without faces; give at least one")]
    Empty,
    /// The tolerance is no length.
    #[error("the tolerance is {0}; give a finite length that is not negative")]
    Tolerance(f64),
    /// A coordinate is NaN or infinite.
    #[error("a coordinate of {part} is not finite; leave the part out")]
    NotFinite {
        /// The part.
        part: ShellPart,
    },
    /// A degree of 0.
    #[error("{part} is of degree 0, which is but a point; raise its degree to 1 or leave it out")]
    Degree {
        /// The part.
        part: ShellPart,
    },
    /// Control points are not those of the degrees.
    #[error("face {face} has {points} control points and its degrees ask for {expected}")]
    Points {
        /// The face.
        face: usize,
        /// Points that it has.
        points: usize,
        /// Points of a patch of its degrees.
        expected: usize,
    },
    /// Weights are not one for each control point.
    #[error("{part} has {weights} weights for {points} control points; give each one, or none")]
    Weights {
        /// The part.
        part: ShellPart,
        /// Number of weights.
        weights: usize,
        /// Number of points.
        points: usize,
    },
    /// A weight is not a positive number.
    #[error("the weight of control point {point} of {part} is {weight}; weights are positive")]
    Weight {
        /// The part.
        part: ShellPart,
        /// The point.
        point: usize,
        /// Its weight.
        weight: f64,
    },
    /// An edge names a vertex that does not exist.
    #[error("edge {edge} ends at vertex {vertex}, but there are {vertices} vertices")]
    VertexIndex {
        /// The edge.
        edge: usize,
        /// The index it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face names an edge that does not exist.
    #[error("face {face} names edge {edge}, but there are {edges} edges")]
    EdgeIndex {
        /// The face.
        face: usize,
        /// The index it holds.
        edge: u32,
        /// How many edges there are.
        edges: usize,
    },
    /// A curve does not end at its vertex.
    #[error(
        "edge {edge} ends {distance:e} from vertex {vertex}, more than the tolerance of \
         {tolerance:e}; move the vertex or allow more"
    )]
    End {
        /// The edge.
        edge: usize,
        /// The vertex.
        vertex: u32,
        /// How far it is from the end of the curve.
        distance: f64,
        /// How far it may be.
        tolerance: f64,
    },
    /// A face without edges.
    #[error("face {face} has no edges; list those around it")]
    NoBoundary {
        /// The face.
        face: usize,
    },
    /// An edge does not start where the one before it ends.
    #[error(
        "around face {face}, edge {edge} ends at vertex {end} and edge {next} after it starts at \
         vertex {start}; list the edges in order, and reverse those that run against it"
    )]
    NotClosed {
        /// The face.
        face: usize,
        /// The edge.
        edge: u32,
        /// Where it ends.
        end: u32,
        /// The edge after it.
        next: u32,
        /// Where that starts.
        start: u32,
    },
    /// A boundary does not pass the corners of its patch in order.
    #[error(
        "the boundary of face {face} does not pass the corners (0, 0), (1, 0), (1, 1), (0, 1) of its \
         patch in this order; list its edges counterclockwise"
    )]
    Corners {
        /// The face.
        face: usize,
    },
    /// An edge is used never or more than twice.
    #[error("edge {edge} is used {uses} times; an edge bounds one face or joins two")]
    Uses {
        /// The edge.
        edge: usize,
        /// How often it is used.
        uses: usize,
    },
    /// Two faces use an edge in the same direction.
    #[error(
        "faces {faces:?} use edge {edge} in the same direction; turn one of them over, for outer \
         sides to be on one side"
    )]
    SameDirection {
        /// The edge.
        edge: usize,
        /// The faces.
        faces: [usize; 2],
    },
}

/// Returns the faces at each edge, or why this is no shell.
pub(super) fn check(
    vertices: &[Point3<f64>],
    edges: &[BezierEdge],
    faces: &[BezierFace],
    tolerance: f64,
) -> Result<Vec<(u32, Option<u32>)>, ShellError> {
    if !(tolerance.is_finite() && tolerance >= 0.0) {
        return Err(ShellError::Tolerance(tolerance));
    }
    if faces.is_empty() {
        return Err(ShellError::Empty);
    }
    for (vertex, point) in vertices.iter().enumerate() {
        check_points(ShellPart::Vertex(vertex), &[*point], None)?;
    }
    for (edge, given) in edges.iter().enumerate() {
        check_edge(edge, given, vertices, tolerance)?;
    }
    for (face, given) in faces.iter().enumerate() {
        check_patch(face, given)?;
        let starts = check_boundary(face, given, edges)?;
        let starts: Vec<_> = starts.iter().map(|&v| vertices[v as usize]).collect();
        if !passes(&starts, given.corners(), tolerance) {
            return Err(ShellError::Corners { face });
        }
    }
    check_uses(edges.len(), faces)
}

/// Refuses numbers and weights that are not fit.
fn check_points(
    part: ShellPart,
    points: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> Result<(), ShellError> {
    if points.iter().any(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(ShellError::NotFinite { part });
    }
    let Some(weights) = weights else {
        return Ok(());
    };
    if weights.len() != points.len() {
        return Err(ShellError::Weights {
            part,
            weights: weights.len(),
            points: points.len(),
        });
    }
    let is_wrong = |weight: &f64| !(weight.is_finite() && *weight > 0.0);
    match weights.iter().position(is_wrong) {
        Some(point) => Err(ShellError::Weight {
            part,
            point,
            weight: weights[point],
        }),
        None => Ok(()),
    }
}

fn check_edge(
    edge: usize,
    given: &BezierEdge,
    vertices: &[Point3<f64>],
    tolerance: f64,
) -> Result<(), ShellError> {
    let part = ShellPart::Edge(edge);
    let curve = &given.curve;
    check_points(part, &curve.points, curve.weights.as_deref())?;
    let [first, .., last] = curve.points[..] else {
        return Err(ShellError::Degree { part });
    };
    for (vertex, end) in given.ends.into_iter().zip([first, last]) {
        let Some(at) = vertices.get(vertex as usize) else {
            return Err(ShellError::VertexIndex {
                edge,
                vertex,
                vertices: vertices.len(),
            });
        };
        let distance = (end - at).norm();
        if distance > tolerance {
            return Err(ShellError::End {
                edge,
                vertex,
                distance,
                tolerance,
            });
        }
    }
    Ok(())
}

fn check_patch(face: usize, given: &BezierFace) -> Result<(), ShellError> {
    let part = ShellPart::Face(face);
    if given.degree.contains(&0) {
        return Err(ShellError::Degree { part });
    }
    let [rows, columns] = given.degree.map(|degree| degree.saturating_add(1));
    let expected = rows.saturating_mul(columns);
    if given.points.len() != expected {
        return Err(ShellError::Points {
            face,
            points: given.points.len(),
            expected,
        });
    }
    check_points(part, &given.points, given.weights.as_deref())
}

/// Returns the vertices at which the edges around a face start.
fn check_boundary(
    face: usize,
    given: &BezierFace,
    edges: &[BezierEdge],
) -> Result<Vec<u32>, ShellError> {
    let around = &given.boundary;
    if around.is_empty() {
        return Err(ShellError::NoBoundary { face });
    }
    let mut ends = Vec::with_capacity(around.len());
    for used in around {
        let Some(edge) = edges.get(used.edge as usize) else {
            return Err(ShellError::EdgeIndex {
                face,
                edge: used.edge,
                edges: edges.len(),
            });
        };
        let [start, end] = edge.ends;
        ends.push(if used.reversed {
            [end, start]
        } else {
            [start, end]
        });
    }
    for (at, &[_, end]) in ends.iter().enumerate() {
        let after = (at + 1) % ends.len();
        let [start, _] = ends[after];
        if start != end {
            return Err(ShellError::NotClosed {
                face,
                edge: around[at].edge,
                end,
                next: around[after].edge,
                start,
            });
        }
    }
    Ok(ends.into_iter().map(|[start, _]| start).collect())
}

/// Whether a closed way through `starts` meets these corners in order; those that agree with the one
/// before them count once.
fn passes(starts: &[Point3<f64>], corners: [Point3<f64>; 4], tolerance: f64) -> bool {
    let is_near = |a: &Point3<f64>, b: &Point3<f64>| (a - b).norm() <= tolerance;
    let mut apart: Vec<_> = (0..4)
        .filter(|&at| !is_near(&corners[at], &corners[(at + 3) % 4]))
        .map(|at| corners[at])
        .collect();
    if apart.is_empty() {
        apart.push(corners[0]);
    }
    (0..starts.len()).any(|first| {
        let mut way = starts[first..].iter().chain(&starts[..first]);
        apart
            .iter()
            .all(|corner| way.any(|start| is_near(start, corner)))
    })
}

/// Returns the faces at each edge; refuses other numbers than one and two, and equal directions.
fn check_uses(edges: usize, faces: &[BezierFace]) -> Result<Vec<(u32, Option<u32>)>, ShellError> {
    let mut uses = vec![0; edges];
    let mut users = vec![[(0, false); 2]; edges];
    for (face, given) in faces.iter().enumerate() {
        for used in &given.boundary {
            let edge = used.edge as usize;
            if let Some(user) = users[edge].get_mut(uses[edge]) {
                *user = (face, used.reversed);
            }
            uses[edge] += 1;
        }
    }
    let sides = uses.into_iter().zip(users).enumerate();
    sides
        .map(|(edge, (uses, [one, other]))| match uses {
            1 => Ok((one.0 as u32, None)),
            2 if one.1 != other.1 => Ok((one.0 as u32, Some(other.0 as u32))),
            2 => Err(ShellError::SameDirection {
                edge,
                faces: [one.0, other.0],
            }),
            uses => Err(ShellError::Uses { edge, uses }),
        })
        .collect()
}
