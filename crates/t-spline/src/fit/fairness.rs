//! The thin plate of a surface: of its leaves, and of the polynomials of its caps.
//!
//! The plate of a leaf is measured in the lengths of the leaf, so that it is as stiff on a large leaf as on a
//! small one; that of a cap in the coordinate of its polynomial. Where few samples lie, both are stiffer: what
//! they leave open, the weak plate alone would settle for the sake of a little less error at them. On
//! happy_buddha_25k with 4,000 control points the surface strayed by 16 % of the longest side between them,
//! with the stiffer plate by 5 %, at the same error at vertices.
//!
//! # Reference
//! [He2006] Eq. (3). Deviations: the polynomial of a cap has a plate in its own coordinate; the paper's plate of
//! a leaf, in units of the form, would be stiffer by the fourth power of how much the map compresses.

use nalgebra::Complex;

use super::samples::Sorted;
use crate::caps::{Jet, monomials};
use crate::complex::{Point, UNITS};
use crate::space::TSplineSpace;

/// Points of Gauss's rule of two.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Sum of the functions of a space at a point from which on few are missing.
const MOST_OF_THEM: f64 = 0.5;
/// Squared radii and weights of Gauss's rule of three over the unit disk, and angles: exact for squares of
/// second derivatives up to degree 7.
const SQUARED_RADII: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
const ANGLES: u32 = 16;

/// Samples on a leaf from which on its plate is not stiffer than others.
const ENOUGH_ON_LEAF: f64 = 4.0;
/// The same for each coefficient of a cap.
const ENOUGH_PER_COEFFICIENT: f64 = 2.0;
/// How many times stiffer a plate without samples is: on happy_buddha_25k with 100 faces are off by three times as
/// much at their worst, with 10,000 by five times; errors at vertices stay within 1 %.
const STIFFER: f64 = 1000.0;

/// Weights of the plates of leaves and of caps.
pub(super) struct Weights {
    pub(super) leaves: Vec<f64>,
    pub(super) caps: Vec<f64>,
}

impl Weights {
    /// Returns weights beside which the mean weight of the samples on a leaf is `1 / fairness`, more where there
    /// are few.
    pub(super) fn new(space: &TSplineSpace, sorted: &Sorted, fairness: f64) -> Self {
        let leaves = space.mesh().leaves().len();
        let weight = fairness * sorted.weight() / leaves as f64;
        let stiffened = |samples: usize, enough: f64| {
            let lacking = (1.0 - samples as f64 / enough).max(0.0);
            weight * (1.0 + STIFFER * lacking * lacking)
        };
        let caps = space.caps().caps();
        let mut in_caps = vec![0; caps.len()];
        for cap in sorted.points.iter().filter_map(|p| space.caps().at(*p)) {
            in_caps[cap.cap as usize] += 1;
        }
        Self {
            leaves: (0..leaves)
                .map(|leaf| stiffened(sorted.on(leaf).len(), ENOUGH_ON_LEAF))
                .collect(),
            caps: (caps.iter().zip(in_caps))
                .map(|(cap, samples)| {
                    let enough = ENOUGH_PER_COEFFICIENT * cap.coefficients() as f64;
                    stiffened(samples, enough)
                })
                .collect(),
        }
    }
}

/// Returns the entries of the mean over a cap of the squared second derivatives of its polynomial by `w`, times
/// a weight.
pub(super) fn of_cap(degree: u8, list: &[u32], weight: f64) -> Vec<(u32, u32, f64)> {
    let mut entries = Vec::new();
    for (node, share) in SQUARED_RADII {
        for step in 0..ANGLES {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(ANGLES);
            let w = Complex::from_polar(node.sqrt(), angle);
            let mut seconds = vec![[0.0; 3]; list.len()];
            let by_w = [Complex::new(1.0, 0.0), Complex::new(0.0, 0.0)];
            monomials(degree, w, by_w, |place, Jet([.., xx, xy, yy])| {
                seconds[place] = [xx, std::f64::consts::SQRT_2 * xy, yy];
            });
            let factor = weight * share / f64::from(ANGLES);
            for (i, p) in seconds.iter().enumerate() {
                for (j, q) in seconds[..=i].iter().enumerate() {
                    let product: f64 = p.iter().zip(q).map(|(p, q)| p * q).sum();
                    entries.push((list[i], list[j], factor * product));
                    if i != j {
                        entries.push((list[j], list[i], factor * product));
                    }
                }
            }
        }
    }
    entries
}

/// Returns four points on each leaf, the leaf, and its sides in units of the form's 1; in the cores of caps
/// only where leaves reach out of them. The T-spline counts by itself, as if there were no caps: what
/// one all but hides must not be free.
pub(super) fn gauss_points(space: &TSplineSpace) -> Vec<(Point, u32, [f64; 2])> {
    let leaves = space.mesh().leaves().iter().enumerate();
    let points = leaves.flat_map(|(index, leaf)| {
        let [w, h] = leaf.size().map(|s| s as f64);
        GAUSS
            .into_iter()
            .flat_map(move |s| GAUSS.map(|t| [s, t]))
            .map(move |[s, t]| {
                let point = Point {
                    cylinder: leaf.cylinder,
                    x: leaf.x[0] as f64 + s * w,
                    y: leaf.y[0] as f64 + t * h,
                };
                (point, index as u32, [w / UNITS, h / UNITS])
            })
    });
    let points: Vec<(Point, u32, [f64; 2])> = points.collect();
    let sums = space.sums(&points.iter().map(|p| p.0).collect::<Vec<_>>());
    let counts = |(point, ..): &(Point, u32, [f64; 2]), sum: f64| {
        let cap = space.caps().at(*point);
        // Functions inside of cores are none of the space.
        cap.is_none_or(|cap| cap.rest.0[0] > 0.0) || sum > MOST_OF_THEM
    };
    let pairs = points.into_iter().zip(sums);
    pairs
        .filter_map(|(point, sum)| counts(&point, sum).then_some(point))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::caps::CapOptions;
    use crate::complex::CylinderComplex;
    use crate::fit::Sample;
    use crate::tmesh::{Grid, TMesh};

    #[test]
    fn plates_are_stiffer_where_samples_are_few() {
        let unit = UNITS as i64;
        let complex = Arc::new(CylinderComplex::torus(unit, unit, 0).expect("a torus"));
        let grids = [Grid::of_cells(&complex.cylinders()[0], 16.0, 1.0)];
        let mesh = TMesh::build(&complex, &grids).expect("a mesh");
        let leaves = mesh.leaves().to_vec();
        // As many samples on a leaf as its number.
        let samples: Vec<Sample> = (leaves.iter().enumerate())
            .flat_map(|(count, leaf)| {
                let at = Point {
                    cylinder: 0,
                    x: leaf.x[0] as f64 + 1.0,
                    y: leaf.y[0] as f64 + 1.0,
                };
                vec![Sample::vertex(at, [0.0; 3].into()); count]
            })
            .collect();
        let sorted = Sorted::new(&samples, &mesh);
        let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("a space");
        let found = Weights::new(&space, &sorted, 1e-7).leaves;
        let weight = 1e-7 * samples.len() as f64 / leaves.len() as f64;
        assert!((found[0] / weight - 1001.0).abs() < 1e-9);
        assert!(found.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(found[4..].iter().all(|w| *w == weight) && found[3] > weight);
    }
}
