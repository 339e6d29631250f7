//! From cycles to oriented patches and holes.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::super::error::NetworkError;
use super::super::graph::CurveGraph;
use super::options::{CycleOptions, CycleReport};
use super::{Cycle, Cycles};

/// Samples on each piece of an arc for volumes.
const SAMPLES: usize = 2;

/// Cycles sorted into patches and holes.
pub(super) struct Sorted<'a> {
    graph: &'a CurveGraph,
    list: Vec<Cycle>,
    component: Vec<u32>,
    components: u32,
    warnings: Vec<String>,
}

impl<'a> Sorted<'a> {
    /// Returns found cycles, with holes told apart and the second sides of sheets dropped.
    pub(super) fn of(
        graph: &'a CurveGraph,
        cycles: Vec<Vec<u32>>,
        options: &CycleOptions,
    ) -> Result<Self, NetworkError> {
        let mut sorted = Self::new(graph, cycles);
        sorted.drop_second_sides();
        for cycle in &mut sorted.list {
            cycle.hole = is_hole(graph, &cycle.half_edges, options.patch_corners);
        }
        sorted.override_holes(options)?;
        Ok(sorted)
    }

    /// Returns cycles given by hand, and the holes that they leave.
    pub(super) fn of_given(
        graph: &'a CurveGraph,
        cycles: Vec<Vec<u32>>,
        options: &CycleOptions,
    ) -> Result<Self, NetworkError> {
        let mut sorted = Self::new(graph, cycles);
        sorted.override_holes(options)?;
        Ok(sorted)
    }

    fn new(graph: &'a CurveGraph, cycles: Vec<Vec<u32>>) -> Self {
        let (component, components) = graph.components();
        let patch = |half_edges| Cycle {
            half_edges,
            hole: false,
        };
        Self {
            graph,
            list: cycles.into_iter().map(patch).collect(),
            component,
            components,
            warnings: graph.warnings().to_vec(),
        }
    }

    /// Keeps one of two cycles with the same arcs, as a single loop has them.
    fn drop_second_sides(&mut self) {
        let mut seen = BTreeSet::new();
        let before = self.list.len();
        self.list.retain(|cycle| {
            let mut arcs: Vec<u32> = cycle.half_edges.iter().map(|h| h / 2).collect();
            arcs.sort_unstable();
            seen.insert(arcs)
        });
        let dropped = before - self.list.len();
        if dropped > 0 {
            self.warnings.push(format!(
                "{dropped} closed loops have the same arcs on both sides; one patch is put in each"
            ));
        }
    }

    fn override_holes(&mut self, options: &CycleOptions) -> Result<(), NetworkError> {
        let mut filled = BTreeSet::new();
        for points in &options.fill {
            let cycle = self.named("fill", points)?;
            self.list[cycle].hole = false;
            filled.insert(cycle);
        }
        for points in &options.hole {
            let cycle = self.named("hole", points)?;
            if filled.contains(&cycle) {
                let points = points.clone();
                return Err(NetworkError::FilledHole { points });
            }
            self.list[cycle].hole = true;
        }
        Ok(())
    }

    /// Returns the one cycle that passes all of some points.
    fn named(&self, list: &'static str, points: &[u32]) -> Result<usize, NetworkError> {
        let passes = |cycle: &Cycle| {
            let along = |&h: &u32| self.graph.arc(h).points.iter().copied();
            let on: BTreeSet<u32> = cycle.half_edges.iter().flat_map(along).collect();
            points.iter().all(|point| on.contains(point))
        };
        let all = 0..self.list.len();
        let found: Vec<usize> = all.filter(|&i| passes(&self.list[i])).collect();
        match found[..] {
            [cycle] => Ok(cycle),
            _ => Err(NetworkError::NotOneCycle {
                list,
                points: points.to_vec(),
                count: found.len(),
            }),
        }
    }

    fn component_of(&self, cycle: &Cycle) -> usize {
        self.component[self.graph.origin(cycle.half_edges[0]) as usize] as usize
    }

    /// Returns whether no cycle passes a junction twice.
    pub(super) fn is_sound(&self) -> bool {
        self.list
            .iter()
            .all(|cycle| repeated(self.graph, cycle).is_none())
    }

    /// Returns the Euler characteristic of every component.
    pub(super) fn euler(&self) -> Vec<i64> {
        let mut euler = vec![0; self.components as usize];
        for &c in &self.component {
            euler[c as usize] += 1;
        }
        for arc in self.graph.arcs() {
            euler[self.component[arc.ends[0] as usize] as usize] -= 1;
        }
        for cycle in self.list.iter().filter(|cycle| !cycle.hole) {
            euler[self.component_of(cycle)] += 1;
        }
        euler
    }

    /// Turns every component outwards and reports.
    pub(super) fn finish(mut self, energy: f64, restarts: u32) -> Cycles {
        self.orient();
        self.warn();
        let holes = self.list.iter().filter(|cycle| cycle.hole).count();
        let report = CycleReport {
            energy,
            restarts,
            patches: self.list.len() - holes,
            holes,
            euler: self.euler(),
            warnings: self.warnings,
        };
        Cycles {
            list: self.list,
            report,
        }
    }

    /// Reverses the components whose patches enclose a negative volume with their centre.
    fn orient(&mut self) {
        let mut centres = vec![(Vector3::zeros(), 0.0); self.components as usize];
        for (junction, &c) in self.graph.junctions().iter().zip(&self.component) {
            let (sum, count) = &mut centres[c as usize];
            *sum += junction.position.coords;
            *count += 1.0;
        }
        let mut volumes = vec![0.0; self.components as usize];
        for cycle in self.list.iter().filter(|cycle| !cycle.hole) {
            let c = self.component_of(cycle);
            volumes[c] += volume(self.graph, cycle, centres[c].0 / centres[c].1);
        }
        for index in 0..self.list.len() {
            if volumes[self.component_of(&self.list[index])] < 0.0 {
                let half_edges = &mut self.list[index].half_edges;
                half_edges.reverse();
                half_edges.iter_mut().for_each(|h| *h ^= 1);
            }
        }
    }

    fn warn(&mut self) {
        let mut repeats = BTreeMap::new();
        for cycle in self.list.iter().filter(|cycle| !cycle.hole) {
            if let Some(v) = repeated(self.graph, cycle) {
                repeats.entry(v).or_insert(cycle.half_edges.len());
            }
        }
        for (v, corners) in repeats {
            let point = self.graph.junctions()[v as usize].point;
            self.warnings.push(format!(
                "a cycle of {corners} arcs passes point {point} twice and bounds no disc"
            ));
        }
        let open: BTreeSet<usize> = self
            .list
            .iter()
            .filter(|cycle| cycle.hole)
            .map(|cycle| self.component_of(cycle))
            .collect();
        if !open.is_empty() {
            let count = open.len();
            self.warnings.push(format!(
                "{count} of {} components are open; their patches are turned away from their centre",
                self.components
            ));
        }
    }
}

/// Returns a junction that a cycle passes twice.
pub(in super::super) fn repeated(graph: &CurveGraph, cycle: &Cycle) -> Option<u32> {
    let mut origins: Vec<u32> = cycle.half_edges.iter().map(|&h| graph.origin(h)).collect();
    origins.sort_unstable();
    let pair = origins.windows(2).find(|pair| pair[0] == pair[1]);
    pair.map(|pair| pair[0])
}

/// Returns whether a cycle is one curve that goes round, longer than a patch.
fn is_hole(graph: &CurveGraph, half_edges: &[u32], patch_corners: usize) -> bool {
    let count = half_edges.len();
    let straight = |i: usize| graph.mate(half_edges[i] ^ 1) == Some(half_edges[(i + 1) % count]);
    count > patch_corners && (0..count).all(straight)
}

/// Returns six times the volume of the cone from a point over the fan of a cycle.
fn volume(graph: &CurveGraph, cycle: &Cycle, apex: Vector3<f64>) -> f64 {
    let mut points: Vec<Point3<f64>> = Vec::new();
    for &h in &cycle.half_edges {
        let mut samples = graph.arc(h).shape.samples(SAMPLES);
        if h % 2 == 1 {
            samples.reverse();
        }
        points.extend(samples[1..].iter().map(|sample| sample.0));
    }
    let centre = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let pairs = points.iter().zip(points.iter().cycle().skip(1));
    pairs
        .map(|(p, q)| (centre - apex).dot(&(p.coords - apex).cross(&(q.coords - apex))))
        .sum()
}
