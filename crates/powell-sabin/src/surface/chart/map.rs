//! The maps of faces into the chart, and where points of it lie.

use msplines_common::mesh::NONE;
use nalgebra::Complex;

use super::Chart;
use crate::surface::jet::PlaneJet;
use crate::vector::cross;

/// A number and its first and second derivative.
type Series = [Complex<f64>; 3];

fn constant(value: Complex<f64>) -> Series {
    [value, Complex::default(), Complex::default()]
}

fn product(a: Series, b: Series) -> Series {
    [
        a[0] * b[0],
        a[1] * b[0] + a[0] * b[1],
        a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2],
    ]
}

fn quotient(a: Series, b: Series) -> Series {
    let value = a[0] / b[0];
    let first = (a[1] - value * b[1]) / b[0];
    let second = (a[2] - 2.0 * first * b[1] - value * b[2]) / b[0];
    [value, first, second]
}

/// Returns the sum of all products of `degree` of these factors, each as often as one likes.
fn sum_of_products(factors: &[Series], degree: usize) -> Series {
    let mut sums = vec![constant(Complex::default()); degree + 1];
    sums[0] = constant(Complex::new(1.0, 0.0));
    for &factor in factors {
        for k in 1..=degree {
            let more = product(factor, sums[k - 1]);
            sums[k] = [0, 1, 2].map(|i| sums[k][i] + more[i]);
        }
    }
    sums[degree]
}

/// Where a point of the chart is.
pub(in crate::surface) struct Located {
    pub(in crate::surface) face: u32,
    pub(in crate::surface) at: [f64; 3],
    /// Whether it is outside of the disk.
    pub(in crate::surface) left: bool,
}

impl Chart {
    /// Returns `dz/dw = n w^(n - 1)` at a vertex that is not inside.
    pub(in crate::surface) fn slope(&self, vertex: u32) -> Complex<f64> {
        let (z, w) = (self.z[vertex as usize], self.w[vertex as usize]);
        f64::from(self.power) * (z - self.z0) / w
    }

    /// Returns the map of a face that is not covered into the chart, by the flat coordinates of the form.
    pub(in crate::surface) fn outside(&self, face: u32, at: [f64; 3]) -> PlaneJet {
        let corners = self.mesh.faces()[face as usize];
        let zeta = corners.map(|v| self.z[v as usize] - self.z0);
        let here = at[0] * zeta[0] + at[1] * zeta[1] + at[2] * zeta[2];
        let [w, slope, bend] = self.root(self.w[corners[0] as usize], zeta[0], here);
        let i = Complex::new(0.0, 1.0);
        PlaneJet {
            value: w,
            first: [slope, i * slope],
            second: [bend, i * bend, -bend],
        }
    }

    /// Returns `w` and its first and second derivative by `z` at `ζ`, on the branch that is `w0` at `ζ0`.
    fn root(&self, w0: Complex<f64>, zeta0: Complex<f64>, zeta: Complex<f64>) -> [Complex<f64>; 3] {
        let share = 1.0 / f64::from(self.power);
        let ratio = zeta / zeta0;
        let w = w0
            * match self.power {
                -1 => ratio.inv(),
                2 => ratio.sqrt(),
                _ => ratio.powf(share),
            };
        let slope = share * w / zeta;
        [w, slope, (share - 1.0) * slope / zeta]
    }

    /// Returns the map of a covered face into the chart, by the second and third barycentric
    /// coordinate.
    pub(in crate::surface) fn inside(&self, face: u32, at: [f64; 3]) -> PlaneJet {
        let corners = self.mesh.faces()[face as usize].map(|v| self.w[v as usize]);
        let mut jet = PlaneJet {
            value: at[0] * corners[0] + at[1] * corners[1] + at[2] * corners[2],
            first: [corners[1] - corners[0], corners[2] - corners[0]],
            second: [Complex::default(); 3],
        };
        for side in (0..3).filter(|&side| self.is_rim(3 * face + side as u32)) {
            self.add_bulge(&mut jet, face, side, at);
        }
        jet
    }

    /// Whether a half-edge of a covered face has one that is not on its other side.
    pub(in crate::surface) fn is_rim(&self, half_edge: u32) -> bool {
        let twin = self.mesh.topology().twin(half_edge);
        self.covered[(half_edge / 3) as usize] && twin != NONE && !self.covered[(twin / 3) as usize]
    }

    /// Adds what lies between the chord of a side and its curve.
    fn add_bulge(&self, jet: &mut PlaneJet, face: u32, side: usize, at: [f64; 3]) {
        let next = (side + 1) % 3;
        let ends = [side, next].map(|i| self.mesh.faces()[face as usize][i] as usize);
        let zeta = ends.map(|v| self.z[v] - self.z0);
        let w = ends.map(|v| self.w[v]);
        let (a, b) = (at[side], at[next]);
        let t = 0.5 * (1.0 + b - a);
        let bulge = self.bulge(w, zeta, t);
        // Barycentric coordinates by the second and third of them.
        let by = |i: usize| [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]][i];
        let (da, db) = (by(side), by(next));
        let dt = [0, 1].map(|k| 0.5 * (db[k] - da[k]));
        jet.value += a * b * bulge[0];
        for k in 0..2 {
            let product = da[k] * b + a * db[k];
            jet.first[k] += product * bulge[0] + a * b * dt[k] * bulge[1];
        }
        for (entry, [k, l]) in [[0, 0], [0, 1], [1, 1]].into_iter().enumerate() {
            let product = |k: usize| da[k] * b + a * db[k];
            jet.second[entry] += (da[k] * db[l] + da[l] * db[k]) * bulge[0]
                + (product(k) * dt[l] + product(l) * dt[k]) * bulge[1]
                + a * b * dt[k] * dt[l] * bulge[2];
        }
    }

    /// Returns `ε` and its first and second derivative by `t`.
    fn bulge(&self, [wa, wb]: [Complex<f64>; 2], zeta: [Complex<f64>; 2], t: f64) -> Series {
        let chord = zeta[1] - zeta[0];
        let [q, slope, bend] = self.root(wa, zeta[0], zeta[0] + t * chord);
        let q = [q, slope * chord, bend * chord * chord];
        if self.power < 0 {
            return q.map(|q| -chord * chord * wa * wb * q);
        }
        let (a, b) = (constant(wa), constant(wb));
        let n = self.power as usize;
        let top = sum_of_products(&[a, q, b], n - 2);
        let bottom = product(
            sum_of_products(&[a, q], n - 1),
            sum_of_products(&[q, b], n - 1),
        );
        quotient(top, bottom).map(|x| chord * (wb - wa) * x)
    }

    /// Returns the face of the disk that holds a point of the chart, and barycentric coordinates, from a
    /// face near it; the face on the boundary where the point leaves the disk.
    pub(in crate::surface) fn locate(&self, start: u32, point: Complex<f64>) -> Located {
        let topology = self.mesh.topology();
        let mut face = start;
        let mut left = false;
        // No face comes twice on the way to a point but by rounding.
        for _ in 0..self.mesh.face_count() {
            let at = self.barycentric(face, point);
            let least = (0..3).fold(0, |best, i| if at[i] < at[best] { i } else { best });
            // The side opposite to corner i is i + 1.
            let twin = topology.twin(3 * face + (least as u32 + 1) % 3);
            if at[least] >= -1e-13 || twin == NONE {
                left = at[least] < -1e-13;
                break;
            }
            face = twin / 3;
        }
        Located {
            face,
            at: self.barycentric(face, point),
            left,
        }
    }

    fn barycentric(&self, face: u32, point: Complex<f64>) -> [f64; 3] {
        let sides = self.mesh.faces()[face as usize].map(|v| {
            let side = self.w[v as usize] - point;
            [side.re, side.im]
        });
        let area = self.flat_area(face);
        [0, 1, 2].map(|i| cross(sides[(i + 1) % 3], sides[(i + 2) % 3]) / area)
    }

    /// Whether points stay on the disk, and faces along the rim unfolded, at the points looked at.
    pub(in crate::surface) fn is_sound(&self) -> bool {
        let steps: Vec<f64> = (0..=8).map(|k| f64::from(k) / 8.0).collect();
        let topology = self.mesh.topology();
        let faces = 0..self.mesh.face_count() as u32;
        let mut beside = vec![false; self.mesh.vertex_count()];
        self.rim().iter().for_each(|&v| beside[v as usize] = true);
        faces.into_iter().all(|face| {
            let corners = self.mesh.faces()[face as usize];
            if self.covered[face as usize] {
                let rim = (0..3).any(|i| self.is_rim(3 * face + i));
                let grid = || {
                    let rows = steps.iter().enumerate();
                    rows.flat_map(|(i, a)| {
                        steps[..steps.len() - i]
                            .iter()
                            .map(move |b| [1.0 - a - b, *a, *b])
                    })
                };
                return !rim
                    || grid().all(|at| {
                        let [u, v] = self.inside(face, at).first;
                        cross([u.re, u.im], [v.re, v.im]) > 0.0
                    });
            }
            let near = corners.iter().any(|&v| beside[v as usize]);
            let sides = (0..3).filter(|&i| near && topology.twin(3 * face + i) != NONE);
            sides.into_iter().all(|i| {
                steps.iter().all(|t| {
                    let mut at = [0.0; 3];
                    at[i as usize] = 1.0 - t;
                    at[(i as usize + 1) % 3] = *t;
                    !self.locate(face, self.outside(face, at).value).left
                })
            })
        })
    }
}
