//! The lattice of periods of a form on a torus, and coordinates by it.
//!
//! # Notation
//! `ω` a form on a torus, `γ_1`, `γ_2` its loops; `l_1`, `l_2` the reduced periods, `τ = l_2 / l_1` with
//! `|Re τ| <= 1/2`, `|τ| >= 1`, `Im τ > 0`.
//!
//! # Reference
//! [He2006] §4, the planar domain of a torus. Reduction of the two periods: [Gauss1801] art. 171.

use crate::homology::Homology;

/// Two shortest periods of a form on a torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The periods `l_1` and `l_2` as vectors of the plane, the shorter one first, the second to its
    /// left.
    pub periods: [[f64; 2]; 2],
    /// The periods as integer combinations of the periods over the loops of the homology.
    pub combinations: [[i64; 2]; 2],
}

impl Lattice {
    /// Returns the lattice of a form given by half-edge of the mesh; nothing unless the surface has one
    /// handle and its periods span the plane.
    #[must_use]
    pub fn of(homology: &Homology, form: &[[f64; 2]]) -> Option<Self> {
        let parts = [0, 1].map(|part| homology.periods(|h| form[h as usize][part]));
        (homology.genus() == 1)
            .then(|| [0, 1].map(|k| [parts[0][k], parts[1][k]]))
            .and_then(Self::reduced)
    }

    /// Returns the lattice that two periods span, reduced; nothing if they are parallel.
    #[must_use]
    pub fn reduced(periods: [[f64; 2]; 2]) -> Option<Self> {
        let mut lattice = Self {
            periods,
            combinations: [[1, 0], [0, 1]],
        };
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        if !lattice.area().is_normal() {
            return None;
        }
        loop {
            let [a, b] = lattice.periods;
            if square(b) < square(a) {
                lattice.periods.swap(0, 1);
                lattice.combinations.swap(0, 1);
            }
            let [a, b] = lattice.periods;
            let multiple = ((a[0] * b[0] + a[1] * b[1]) / square(a)).round();
            let shortened = [0, 1].map(|i| b[i] - multiple * a[i]);
            // Rounding must not let two of the same length take turns.
            if multiple == 0.0 || square(shortened) >= square(b) * (1.0 - f64::EPSILON) {
                break;
            }
            lattice.periods[1] = shortened;
            let [first, second] = lattice.combinations;
            lattice.combinations[1] = [0, 1].map(|i| second[i] - multiple as i64 * first[i]);
        }
        if lattice.area() < 0.0 {
            lattice.periods[1] = lattice.periods[1].map(|x| -x);
            lattice.combinations[1] = lattice.combinations[1].map(|n| -n);
        }
        Some(lattice)
    }

    /// Returns the signed area of the parallelogram of the two periods.
    #[must_use]
    pub fn area(&self) -> f64 {
        let [a, b] = self.periods;
        a[0] * b[1] - a[1] * b[0]
    }

    /// Returns the modulus `τ`, real and imaginary part: what all conformal tori of this shape share.
    #[must_use]
    pub fn modulus(&self) -> [f64; 2] {
        let [a, b] = self.periods;
        let square = a[0] * a[0] + a[1] * a[1];
        [(a[0] * b[0] + a[1] * b[1]) / square, self.area() / square]
    }

    /// Returns the coordinates `s`, `t` of a vector `s l_1 + t l_2` of the plane.
    #[must_use]
    pub fn coordinates(&self, vector: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.periods;
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        [
            cross(vector, b) / self.area(),
            cross(a, vector) / self.area(),
        ]
    }
}
