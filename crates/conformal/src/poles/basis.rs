//! Harmonic forms of a surface with holes: those that vanish along the holes, and those that nothing
//! flows out of.

use msplines_common::linalg::{Mat, Ordering, column};
use msplines_common::mesh::{NONE, Topology};
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::progress::Stages;
use nalgebra::{DMatrix, DVector};

use super::holes::Cut;
use crate::basis::raised;
use crate::bounded::{BoundedError, between_loops, coclosing};
use crate::error::ConformalError;
use crate::extension::{cotangent_weights, ends, laplacian};
use crate::uniformity::{SAMPLES, Uniformity, gradient, sampled};

/// Determinants of integer matrices further from ±1 than this are wrong.
const UNIMODULAR: f64 = 1e-6;

/// Part of a loop over which densities are taken: an edge of the loop of a regular vertex.
const WINDOW: f64 = 0.16;

/// Least density of the real part on a part of a loop, over that on the whole of it.
const LEAST_DENSITY: f64 = 0.25;

/// Integer closed forms and the functions that make them harmonic: `H_k = W_k + df_k`.
struct Forms {
    /// `W_k` by half-edge of the triangulation.
    integers: Vec<Vec<i32>>,
    /// `f_k`, one column each.
    functions: Mat<f64>,
}

/// The harmonic forms of a surface with `b` holes and genus `g`, `2g + b - 1` of either kind.
pub(super) struct PoledBasis {
    pub(super) triangulation: IntrinsicTriangulation,
    genus: usize,
    relative: Forms,
    absolute: Forms,
    /// Length of each edge around each hole, and the values of the absolute forms along it.
    loops: Vec<Vec<(f64, DVector<f64>)>>,
    gram: DMatrix<f64>,
    /// `-M⁻¹ G`, which turns coefficients of the imaginary part into those of the real part.
    turn: DMatrix<f64>,
}

impl PoledBasis {
    pub(super) fn build(cut: &Cut, stages: &mut Stages<'_, '_>) -> Result<Self, ConformalError> {
        stages.enter()?;
        let mesh = &cut.mesh;
        let triangulation =
            intrinsic_delaunay_by(mesh, FlipRule::Simplicial).map_err(BoundedError::from)?;
        let weights = raised(&triangulation, cotangent_weights(&triangulation));
        let matrix = laplacian(mesh.vertex_count(), &triangulation, &weights);
        let ordering = Ordering::minimum_degree(&matrix, |_| true).map_err(BoundedError::from)?;
        let (relative, absolute) = integer_forms(cut);
        let wedges = wedges(&relative, &absolute);
        let harmonic = |mut integers: Vec<Vec<i32>>, free: Vec<bool>| {
            integers.iter_mut().for_each(|w| triangulation.carry(w));
            let closed = integers.iter();
            let closed: Vec<Vec<f64>> = closed
                .map(|w| w.iter().map(|&n| f64::from(n)).collect())
                .collect();
            let with = (&matrix, &ordering);
            let functions = coclosing(&triangulation, &weights, &closed, with, free);
            functions.map(|functions| Forms {
                integers,
                functions,
            })
        };
        let inner = (0..mesh.vertex_count() as u32).map(|v| !mesh.topology().is_boundary_vertex(v));
        stages.enter()?;
        let relative = harmonic(relative, inner.collect()).map_err(BoundedError::from)?;
        stages.enter()?;
        // Constants are free: the vertex eliminated last stays at zero.
        let grounded = ordering.as_slice().last().map_or(0, |&row| row as usize);
        let free = (0..mesh.vertex_count()).map(|v| v != grounded).collect();
        let absolute = harmonic(absolute, free).map_err(BoundedError::from)?;
        let gram = gram(&triangulation, &weights, &relative);
        let classes = gram.nrows();
        let factors = wedges.lu();
        let determinant = factors.determinant();
        let inverse = factors.try_inverse();
        let inverse = inverse.filter(|_| (determinant.abs() - 1.0).abs() < UNIMODULAR);
        let inverse = inverse.ok_or(ConformalError::Intersections {
            classes,
            determinant,
        })?;
        Ok(Self {
            loops: around_holes(cut, &triangulation, &absolute),
            turn: -inverse.map(f64::round) * &gram,
            triangulation,
            genus: cut.handles.len() / 2,
            relative,
            absolute,
            gram,
        })
    }

    pub(super) fn classes(&self) -> usize {
        self.gram.nrows()
    }

    pub(super) fn genus(&self) -> usize {
        self.genus
    }

    pub(super) fn gram(&self) -> &DMatrix<f64> {
        &self.gram
    }

    /// Returns the coefficients of the real part in the absolute forms; the last of them are the
    /// integrals of the real part around all holes but the first.
    pub(super) fn real(&self, imaginary: &DVector<f64>) -> DVector<f64> {
        &self.turn * imaginary
    }

    /// Returns the coefficients of the imaginary part of a class and integrals around all holes but the
    /// first; nothing if rounding makes the equations singular.
    pub(super) fn with_fluxes(&self, class: &[i64], fluxes: &[f64]) -> Option<DVector<f64>> {
        let handles = 2 * self.genus;
        let levels = self.classes() - handles;
        let of_class = DVector::from_iterator(handles, class.iter().map(|&n| n as f64));
        let beside = self.turn.view((handles, 0), (levels, handles)) * &of_class;
        let matrix = self.turn.view((handles, handles), (levels, levels));
        let wanted = DVector::from_column_slice(fluxes) - beside;
        let found = matrix.into_owned().lu().solve(&wanted)?;
        let all = of_class.iter().chain(found.iter()).copied();
        Some(DVector::from_iterator(self.classes(), all))
    }

    /// Returns by half-edge of the triangulation the form with this imaginary part.
    pub(super) fn form(&self, imaginary: &DVector<f64>) -> Vec<[f64; 2]> {
        let real = self
            .absolute
            .combine(&self.triangulation, &self.real(imaginary));
        let imaginary = self.relative.combine(&self.triangulation, imaginary);
        real.into_iter()
            .zip(imaginary)
            .map(|(u, v)| [u, v])
            .collect()
    }

    /// Returns the holes around which the real part is too uneven: a zero lies on their loops or near.
    ///
    /// Every sixth of a loop has to have a quarter of its share of the integral. In a parallel flow the
    /// next zero is farther than two and a half radii from the middle of such a hole.
    pub(super) fn uneven_holes(&self, imaginary: &DVector<f64>, fluxes: &[f64]) -> Vec<usize> {
        let real = self.real(imaginary);
        let is_uneven = |hole: &usize| {
            let edges: Vec<(f64, f64)> = self.loops[*hole]
                .iter()
                .map(|(length, values)| (*length, values.dot(&real)))
                .collect();
            let whole: f64 = edges.iter().map(|(length, _)| length).sum();
            let density = |first: usize| {
                let (mut along, mut value) = (0.0, 0.0);
                for (length, own) in edges.iter().cycle().skip(first).take(edges.len()) {
                    along += length;
                    value += own;
                    if along >= WINDOW * whole {
                        break;
                    }
                }
                value * whole / (along * fluxes[*hole])
            };
            (0..edges.len()).any(|first| density(first) < LEAST_DENSITY)
        };
        (0..self.loops.len()).filter(is_uneven).collect()
    }

    /// Returns the part of `v` that is a function: all but the integer forms of the handles.
    pub(super) fn function(&self, cut: &Cut, imaginary: &DVector<f64>) -> Vec<f64> {
        let mut function = self.relative.function(imaginary);
        let levels = imaginary.iter().skip(2 * self.genus);
        for (half_edges, level) in cut.loops[1..].iter().zip(levels) {
            for &half_edge in half_edges {
                function[cut.mesh.topology().origin(half_edge) as usize] += level;
            }
        }
        function
    }

    /// Returns what measures how even forms are, by the coefficients of the imaginary part.
    pub(super) fn uniformity(&self) -> Uniformity {
        let (chosen, weights) = sampled(&self.triangulation, SAMPLES);
        let classes = self.classes();
        let derivatives = |forms: &Forms| {
            let mut parts = [0; 2].map(|_| DMatrix::zeros(chosen.len(), classes));
            for (sample, &face) in chosen.iter().enumerate() {
                for k in 0..classes {
                    let along =
                        [0, 2].map(|side| forms.along(&self.triangulation, 3 * face + side, k));
                    let [x, y] = gradient(self.triangulation.lengths[face], along);
                    parts[0][(sample, k)] = 0.5 * x;
                    parts[1][(sample, k)] = -0.5 * y;
                }
            }
            parts
        };
        let [ur, ui] = derivatives(&self.absolute).map(|part| part * &self.turn);
        let [vr, vi] = derivatives(&self.relative);
        Uniformity::from_parts(&[ur - vi, ui + vr], weights)
    }
}

impl Forms {
    /// The value of one form along a half-edge.
    fn along(&self, triangulation: &IntrinsicTriangulation, half_edge: usize, k: usize) -> f64 {
        let [a, b] = ends(triangulation, half_edge as u32).map(|v| v as usize);
        f64::from(self.integers[k][half_edge]) + (self.functions[(b, k)] - self.functions[(a, k)])
    }

    fn combine(
        &self,
        triangulation: &IntrinsicTriangulation,
        coefficients: &DVector<f64>,
    ) -> Vec<f64> {
        let function = self.function(coefficients);
        let half_edges = 0..triangulation.twins.len() as u32;
        let along = half_edges.map(|h| {
            let [a, b] = ends(triangulation, h).map(|v| v as usize);
            let jumps = self.integers.iter().zip(coefficients.iter());
            let jump: f64 = jumps.map(|(w, a)| f64::from(w[h as usize]) * a).sum();
            jump + (function[b] - function[a])
        });
        along.collect()
    }

    fn function(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        let mut sum = vec![0.0; self.functions.nrows()];
        for (k, coefficient) in coefficients.iter().enumerate() {
            let values = column(self.functions.as_ref(), k);
            sum.iter_mut()
                .zip(values)
                .for_each(|(s, f)| *s += coefficient * f);
        }
        sum
    }
}

/// Returns bases of the integer forms that vanish along the holes, and of all integer closed forms.
///
/// Those of the first kind are the forms of the handles, changed by functions that make them vanish
/// there, and the differences of the functions that are 1 on one hole but the first. Those of the
/// second are the forms of the handles, and paths of faces from the first hole to each other one.
fn integer_forms(cut: &Cut) -> (Vec<Vec<i32>>, Vec<Vec<i32>>) {
    let topology = cut.mesh.topology();
    let dense = |cocycle: &Vec<(u32, i32)>| {
        let mut values = vec![0; 3 * cut.mesh.face_count()];
        cocycle
            .iter()
            .for_each(|&(h, value)| values[h as usize] = value);
        values
    };
    let handles: Vec<Vec<i32>> = cut.handles.iter().map(dense).collect();
    let mut relative = Vec::new();
    for values in &handles {
        let mut on_loops = vec![0; cut.mesh.vertex_count()];
        for half_edges in &cut.loops {
            let mut sum = 0;
            for &half_edge in half_edges {
                on_loops[topology.origin(half_edge) as usize] = sum;
                sum += values[half_edge as usize];
            }
        }
        let mut vanishing = values.clone();
        add_difference(topology, &on_loops, -1, &mut vanishing);
        relative.push(vanishing);
    }
    for half_edges in &cut.loops[1..] {
        let mut indicator = vec![0; cut.mesh.vertex_count()];
        half_edges
            .iter()
            .for_each(|&h| indicator[topology.origin(h) as usize] = 1);
        let mut form = vec![0; 3 * cut.mesh.face_count()];
        add_difference(topology, &indicator, 1, &mut form);
        relative.push(form);
    }
    let paths = between_loops(topology, &cut.loops);
    (relative, handles.into_iter().chain(paths).collect())
}

fn add_difference(topology: &Topology, function: &[i32], factor: i32, form: &mut [i32]) {
    for (h, value) in (0u32..).zip(form) {
        let [a, b] = [topology.origin(h), topology.target(h)].map(|v| function[v as usize]);
        *value += factor * (b - a);
    }
}

/// Wedge products of relative with absolute forms, which are integers whatever represents the classes.
fn wedges(relative: &[Vec<i32>], absolute: &[Vec<i32>]) -> DMatrix<f64> {
    let wedge = |i: usize, j: usize| {
        let faces = relative[i].as_chunks::<3>().0.iter();
        let both = faces.zip(absolute[j].as_chunks::<3>().0);
        let doubled: i64 = both
            .map(|(a, b)| i64::from(a[0] * b[1] - a[1] * b[0]))
            .sum();
        doubled as f64 / 2.0
    };
    DMatrix::from_fn(relative.len(), absolute.len(), wedge)
}

/// Lengths of the edges around the holes, and the values of forms along them.
fn around_holes(
    cut: &Cut,
    triangulation: &IntrinsicTriangulation,
    forms: &Forms,
) -> Vec<Vec<(f64, DVector<f64>)>> {
    let topology = cut.mesh.topology();
    let mut leaving = vec![0; cut.mesh.vertex_count()];
    for (h, &twin) in (0u32..).zip(&triangulation.twins) {
        if twin == NONE {
            leaving[ends(triangulation, h)[0] as usize] = h as usize;
        }
    }
    let edge = |&h: &u32| {
        let h = leaving[topology.origin(h) as usize];
        let values = DVector::from_fn(forms.integers.len(), |k, _| {
            forms.along(triangulation, h, k)
        });
        (triangulation.lengths[h / 3][h % 3], values)
    };
    let loops = cut.loops.iter();
    loops
        .map(|half_edges| half_edges.iter().map(edge).collect())
        .collect()
}

/// Inner products of the relative forms.
fn gram(triangulation: &IntrinsicTriangulation, weights: &[f64], forms: &Forms) -> DMatrix<f64> {
    let classes = forms.integers.len();
    let mut gram = DMatrix::zeros(classes, classes);
    let mut values = DVector::zeros(classes);
    for (h, &twin) in (0u32..).zip(&triangulation.twins) {
        // Boundary edges have no twin, and these forms vanish there.
        if h < twin {
            (0..classes).for_each(|k| values[k] = forms.along(triangulation, h as usize, k));
            gram.ger(weights[h as usize], &values, &values, 1.0);
        }
    }
    gram
}
