//! Junctions, the arcs between them, and which arcs continue one another.
//!
//! # Notation
//! Arc `a` has the half-edges `2 a`, along it, and `2 a + 1`, against it. A half-edge starts at its
//! origin, a junction. Its mate leaves the same junction and continues the same curve backwards.

use msplines_common::mesh::curves::CurveNetwork;
use nalgebra::{Point3, Vector3};

use super::arc_curve::ArcCurve;
use super::error::NetworkError;
use super::segments::Segments;
use super::touching::check_touching;

/// Arcs that may meet at a junction: the pairwise costs of its arcs grow with the square.
const MOST_ARCS: usize = 128;

/// Junctions put on a closed curve that has none: the corners of a quad.
const LOOP_JUNCTIONS: usize = 4;

/// A point where arcs end.
#[derive(Clone, Debug, PartialEq)]
pub struct Junction {
    /// The point of the network.
    pub point: u32,
    /// Where it is.
    pub position: Point3<f64>,
    /// The half-edges that start here, in no meaningful order.
    pub half_edges: Vec<u32>,
}

/// A piece of the network between junctions.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkArc {
    /// The junctions where it starts and ends; they may be one.
    pub ends: [u32; 2],
    /// The points of the network along it, with those of its junctions.
    pub points: Vec<u32>,
    /// The curve of the network at its start.
    pub curve: usize,
    /// Whether the surface has a crease along it.
    pub crease: bool,
    /// The smooth curve through its points.
    pub shape: ArcCurve,
}

/// A network as junctions and arcs.
#[derive(Clone, Debug)]
pub struct CurveGraph {
    junctions: Vec<Junction>,
    arcs: Vec<NetworkArc>,
    mates: Vec<Option<u32>>,
    warnings: Vec<String>,
}

impl CurveGraph {
    /// Returns the graph of a network. A point is a junction if three or more segments end there;
    /// at other points curves are joined. The arcs are centripetal Catmull-Rom splines that run
    /// through junctions as the curves do.
    ///
    /// A curve runs on through the junctions it passes. If none passes any (each arc is a curve of
    /// its own), the straightest pairs of ends that turn by less than 32 degrees count as one curve.
    /// A network of closed curves only, that do not meet, gets four junctions on each.
    ///
    /// # Reference
    /// [Wang2016] §4.3; [Yuksel2011].
    ///
    /// # Errors
    /// A curve that ends nowhere, meets another without a shared point, or is alone; a point with
    /// more than 128 arcs.
    pub fn build(network: &CurveNetwork) -> Result<Self, NetworkError> {
        let segments = Segments::of(network);
        let crossed = check_touching(&segments)?;
        let warning = |curve| {
            format!("curve {curve} crosses itself without a point there; it is kept as it is")
        };
        let junction_of = junctions(&segments)?;
        let mut graph = Self {
            junctions: Vec::new(),
            arcs: Vec::new(),
            mates: Vec::new(),
            warnings: crossed.into_iter().map(warning).collect(),
        };
        for (point, junction) in junction_of.iter().enumerate() {
            if junction.is_some() {
                graph.junctions.push(Junction {
                    point: point as u32,
                    position: network.points()[point],
                    half_edges: Vec::new(),
                });
            }
        }
        graph.add_arcs(&segments, &junction_of);
        Ok(graph)
    }

    fn add_arcs(&mut self, segments: &Segments<'_>, junction_of: &[Option<u32>]) {
        // The half-edge that leaves a junction by each end of a segment.
        let mut half_edge_at = vec![None; 2 * segments.list.len()];
        for v in 0..self.junctions.len() {
            for &end in segments.ends_at(self.junctions[v].point) {
                if half_edge_at[end as usize].is_none() {
                    let arc = self.arcs.len() as u32;
                    let last = self.add_arc(segments, junction_of, end);
                    half_edge_at[end as usize] = Some(2 * arc);
                    half_edge_at[last as usize] = Some(2 * arc + 1);
                }
            }
        }
        self.mates = vec![None; 2 * self.arcs.len()];
        for (end, half_edge) in half_edge_at.iter().enumerate() {
            if let Some(h) = half_edge {
                let next = segments.continuation(end as u32);
                self.mates[*h as usize] = next.and_then(|next| half_edge_at[next as usize]);
            }
        }
    }

    /// Adds the arc that starts with an end; returns the end with which it ends.
    fn add_arc(&mut self, segments: &Segments<'_>, junction_of: &[Option<u32>], first: u32) -> u32 {
        let mut end = first;
        let mut points = vec![segments.point_id(first)];
        let mut pieces = Vec::new();
        let mut flags = Vec::new();
        let last = loop {
            pieces.push(segments.cubic(end));
            flags.push(segments.list[end as usize / 2].crease);
            let far = end ^ 1;
            let point = segments.point_id(far);
            points.push(point);
            if junction_of[point as usize].is_some() {
                break far;
            }
            // A point that is no junction has two ends.
            let ends = segments.ends_at(point);
            end = if ends[0] == far { ends[1] } else { ends[0] };
        };
        let shape = ArcCurve::new(pieces);
        let crease = self.crease(&flags, &shape, segments.list[first as usize / 2].curve);
        let ends = [first, last].map(|end| junction_of[segments.point_id(end) as usize]);
        let ends = ends.map(|junction| junction.unwrap_or_default());
        let arc = self.arcs.len() as u32;
        self.junctions[ends[0] as usize].half_edges.push(2 * arc);
        self.junctions[ends[1] as usize]
            .half_edges
            .push(2 * arc + 1);
        self.arcs.push(NetworkArc {
            ends,
            points,
            curve: segments.list[first as usize / 2].curve,
            crease,
            shape,
        });
        last
    }

    /// Returns whether most of an arc is crease.
    fn crease(&mut self, flags: &[bool], shape: &ArcCurve, curve: usize) -> bool {
        if flags.iter().all(|flag| *flag == flags[0]) {
            return flags[0];
        }
        let mut length = 0.0;
        let mut before = 0.0;
        for (piece, &flag) in flags.iter().enumerate() {
            let to = shape.length_to_end_of(piece);
            length += if flag { to - before } else { 0.0 };
            before = to;
        }
        let crease = length > 0.5 * shape.length();
        let kept = if crease { "a crease" } else { "smooth" };
        self.warnings.push(format!(
            "curve {curve} is a crease along part of an arc only; the arc is made {kept}, as most of it is"
        ));
        crease
    }

    /// Returns the junctions.
    #[must_use]
    pub fn junctions(&self) -> &[Junction] {
        &self.junctions
    }

    /// Returns the arcs.
    #[must_use]
    pub fn arcs(&self) -> &[NetworkArc] {
        &self.arcs
    }

    /// Returns the half-edge in which the curve of a half-edge continues backwards.
    #[must_use]
    pub fn mate(&self, half_edge: u32) -> Option<u32> {
        self.mates[half_edge as usize]
    }

    /// Returns the junction that a half-edge leaves.
    #[must_use]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.arcs[half_edge as usize / 2].ends[half_edge as usize % 2]
    }

    /// Returns the arc of a half-edge.
    #[must_use]
    pub fn arc(&self, half_edge: u32) -> &NetworkArc {
        &self.arcs[half_edge as usize / 2]
    }

    /// Returns the unit tangent of a half-edge at its origin, away from there.
    #[must_use]
    pub fn tangent(&self, half_edge: u32) -> Vector3<f64> {
        let shape = &self.arc(half_edge).shape;
        if half_edge.is_multiple_of(2) {
            shape.tangent(0.0)
        } else {
            -shape.tangent(shape.length())
        }
    }

    /// Returns what was decided for the caller.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Returns the connected component of every junction, and how many there are.
    #[must_use]
    pub fn components(&self) -> (Vec<u32>, u32) {
        let mut component = vec![u32::MAX; self.junctions.len()];
        let mut count = 0;
        for start in 0..self.junctions.len() {
            if component[start] != u32::MAX {
                continue;
            }
            component[start] = count;
            let mut waiting = vec![start];
            while let Some(v) = waiting.pop() {
                for &h in &self.junctions[v].half_edges {
                    let other = self.origin(h ^ 1) as usize;
                    if component[other] == u32::MAX {
                        component[other] = count;
                        waiting.push(other);
                    }
                }
            }
            count += 1;
        }
        (component, count)
    }
}

/// Returns the number of the junction at every point.
fn junctions(segments: &Segments<'_>) -> Result<Vec<Option<u32>>, NetworkError> {
    let points = segments.network.points();
    let mut is_junction = vec![false; points.len()];
    for (point, &position) in points.iter().enumerate() {
        let ends = segments.ends_at(point as u32);
        let point = point as u32;
        if let [end] = ends {
            return Err(NetworkError::Dangling {
                curve: segments.list[*end as usize / 2].curve,
                point,
                position,
            });
        }
        if ends.len() > MOST_ARCS {
            return Err(NetworkError::Crowded {
                point,
                position,
                arcs: ends.len(),
                most: MOST_ARCS,
            });
        }
        is_junction[point as usize] = ends.len() > 2;
    }
    let any = is_junction.contains(&true);
    for cycle in loops(segments, &is_junction) {
        if any {
            let end = cycle[0];
            return Err(NetworkError::LooseLoop {
                curve: segments.list[end as usize / 2].curve,
                position: segments.point(end),
            });
        }
        for point in loop_junctions(segments, &cycle) {
            is_junction[point as usize] = true;
        }
    }
    let mut count = 0..;
    let number = |junction: bool| if junction { count.next() } else { None };
    Ok(is_junction.into_iter().map(number).collect())
}

/// Returns the closed curves without junctions, each as the first ends of its segments in order.
fn loops(segments: &Segments<'_>, is_junction: &[bool]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; segments.list.len()];
    let follow = |start: u32, seen: &mut [bool]| {
        let mut ends = Vec::new();
        let mut end = start;
        while !seen[end as usize / 2] {
            seen[end as usize / 2] = true;
            ends.push(end);
            let point = segments.point_id(end ^ 1);
            if is_junction[point as usize] {
                break;
            }
            let both = segments.ends_at(point);
            end = if both[0] == end ^ 1 { both[1] } else { both[0] };
        }
        ends
    };
    for (point, _) in is_junction.iter().enumerate().filter(|pair| *pair.1) {
        for &end in segments.ends_at(point as u32) {
            follow(end, &mut seen);
        }
    }
    let starts = 0..segments.list.len() as u32;
    let found = starts.map(|s| follow(2 * s, &mut seen));
    found.filter(|ends| !ends.is_empty()).collect()
}

/// Returns the points of a closed curve that become junctions: its corners if it has three or more,
/// else points that quarter it.
fn loop_junctions(segments: &Segments<'_>, cycle: &[u32]) -> Vec<u32> {
    let corner = |&&end: &&u32| segments.continuation(end).is_none();
    let corners: Vec<u32> = cycle.iter().filter(corner).copied().collect();
    if corners.len() >= 3 {
        return corners.iter().map(|&end| segments.point_id(end)).collect();
    }
    let length = |end: u32| (segments.point(end ^ 1) - segments.point(end)).norm();
    let whole: f64 = cycle.iter().map(|&end| length(end)).sum();
    let mut chosen = Vec::new();
    let mut before = 0.0;
    for &end in cycle {
        let wanted = whole * chosen.len() as f64 / LOOP_JUNCTIONS as f64;
        if chosen.len() < LOOP_JUNCTIONS && before + 0.5 * length(end) >= wanted {
            chosen.push(segments.point_id(end));
        }
        before += length(end);
    }
    chosen
}
