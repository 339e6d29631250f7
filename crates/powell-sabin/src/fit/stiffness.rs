//! The energy of one component as blocks over vertices and edges.

use msplines_common::mesh::{NONE, Topology};
use rayon::prelude::*;

use crate::domain::{FlatDomain, median};
use crate::energy::{ElementMatrix, membrane, thin_plate};
use crate::options::{Fairness, Options};

/// Couples the three numbers of one vertex with those of another.
pub(super) type Block = [[f64; 3]; 3];

/// How far one face may weigh more or less than the median one, where the mesh or the domain is
/// degenerate.
const WEIGHTS: [f64; 2] = [1e-6, 1e6];

/// Returns the weight of the thin plate on every face.
pub(crate) fn plate_weights(domain: &FlatDomain, options: &Options) -> Vec<f64> {
    let faces = domain.mesh().face_count() as u32;
    let unit = domain.median_edge_length().powi(2);
    let weights: Vec<f64> = match options.fairness {
        Fairness::Parametric => vec![1.0; faces as usize],
        Fairness::Geometric => {
            let area = |f: u32| 0.5 * domain.mesh().face_normal(f).norm();
            let ratios: Vec<f64> = (0..faces).map(|f| domain.flat_area(f) / area(f)).collect();
            let middle = median(ratios.clone());
            let bounded = |r: f64| (r / middle).clamp(WEIGHTS[0], WEIGHTS[1]);
            // A mesh without any area says nothing.
            let usable = middle.is_finite() && middle > 0.0;
            let relative = |r: f64| if usable { bounded(r) } else { 1.0 };
            ratios.into_iter().map(relative).collect()
        }
    };
    weights
        .into_iter()
        .map(|w| options.thin_plate * unit * w)
        .collect()
}

/// Returns the weighted sum of both energies on a face.
pub(crate) fn element(
    domain: &FlatDomain,
    face: u32,
    options: &Options,
    plate: f64,
) -> ElementMatrix {
    let triangle = domain.macro_triangle(face);
    let (soft, stiff) = (membrane(&triangle), thin_plate(&triangle));
    std::array::from_fn(|i| {
        std::array::from_fn(|j| options.membrane * soft[i][j] + plate * stiff[i][j])
    })
}

/// The blocks of the energy at vertices that have unknowns, and along all their edges.
pub(super) struct Stiffness<'a> {
    topology: &'a Topology,
    elements: Vec<ElementMatrix>,
    /// Place of every face among the elements.
    places: Vec<u32>,
}

impl<'a> Stiffness<'a> {
    /// Assembles the elements of faces with a corner for which `active` holds.
    pub(super) fn assemble(
        domain: &'a FlatDomain,
        options: &Options,
        active: impl Fn(u32) -> bool,
    ) -> Self {
        let mut places = vec![NONE; domain.mesh().face_count()];
        let mut faces = Vec::new();
        for (face, corners) in domain.mesh().faces().iter().enumerate() {
            if corners.iter().any(|&v| active(v)) {
                places[face] = faces.len() as u32;
                faces.push(face as u32);
            }
        }
        let weights = plate_weights(domain, options);
        let elements = faces
            .par_iter()
            .map(|&face| element(domain, face, options, weights[face as usize]))
            .collect();
        Self {
            topology: domain.topology(),
            elements,
            places,
        }
    }

    fn add(&self, sum: &mut Block, face: u32, i: u32, j: u32) {
        let element = &self.elements[self.places[face as usize] as usize];
        let (rows, columns) = (3 * i as usize, 3 * j as usize);
        for (row, source) in sum.iter_mut().zip(&element[rows..rows + 3]) {
            row.iter_mut()
                .zip(&source[columns..columns + 3])
                .for_each(|(sum, value)| *sum += value);
        }
    }

    /// Returns the block of a vertex with itself and with every neighbour: first itself, then the
    /// neighbours counter-clockwise.
    pub(super) fn blocks(&self, vertex: u32) -> Vec<(u32, Block)> {
        let topology = self.topology;
        let mut blocks = vec![(vertex, [[0.0; 3]; 3])];
        for h in topology.outgoing(vertex) {
            let (face, i) = (h / 3, h % 3);
            self.add(&mut blocks[0].1, face, i, i);
            let mut block = [[0.0; 3]; 3];
            self.add(&mut block, face, i, (i + 1) % 3);
            let twin = topology.twin(h);
            if twin != NONE {
                self.add(&mut block, twin / 3, (twin + 1) % 3, twin % 3);
            }
            blocks.push((topology.target(h), block));
            let previous = Topology::previous(h);
            if topology.twin(previous) == NONE {
                let mut block = [[0.0; 3]; 3];
                self.add(&mut block, face, i, previous % 3);
                blocks.push((topology.origin(previous), block));
            }
        }
        blocks
    }
}
