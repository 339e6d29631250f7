//! Small surfaces and random meshes for tests.

use std::sync::Arc;

use crate::complex::tests::double_torus;
use crate::complex::{Beyond, Cylinder, CylinderComplex, Segment};
use crate::tmesh::{Axis, Grading, Grid, TMesh};

/// Numbers that are the same in every run.
pub(crate) struct Sequence(pub(crate) u64);

impl Sequence {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The double torus with units of a realistic size, sheared by lengths that are no round numbers.
pub(crate) fn large_double_torus() -> Arc<CylinderComplex> {
    let scale = (1_i64 << 34) + 12_345;
    let mut cylinders = double_torus().cylinders().to_vec();
    for cylinder in &mut cylinders {
        cylinder.circumference *= scale;
        cylinder.height *= scale;
        for segment in cylinder.bottom.iter_mut().chain(&mut cylinder.top) {
            segment.start *= scale;
            segment.length *= scale;
            if let Beyond::Cylinder { start, .. } = &mut segment.beyond {
                *start *= scale;
            }
        }
    }
    Arc::new(CylinderComplex::build(cylinders).expect("a surface"))
}

/// Turns the top of a cylinder, and what is glued to it, by a length.
fn turn_top(cylinders: &mut [Cylinder], which: u32, length: i64) {
    let size = cylinders[which as usize].circumference;
    for below in cylinders.iter_mut().flat_map(|c| &mut c.bottom) {
        if let Beyond::Cylinder { cylinder, start } = &mut below.beyond
            && *cylinder == which
        {
            *start = (*start + length).rem_euclid(size);
        }
    }
    let mut turned = Vec::new();
    for &(mut segment) in &cylinders[which as usize].top {
        segment.start = (segment.start + length).rem_euclid(size);
        let over = segment.start + segment.length - size;
        if over > 0 {
            let mut rest = segment;
            (rest.start, rest.length, rest.zero) = (0, over, None);
            segment.length -= over;
            if let Beyond::Cylinder { start, .. } = &mut rest.beyond {
                *start += segment.length;
            }
            turned.push(rest);
        }
        turned.push(segment);
    }
    turned.sort_by_key(|s| s.start);
    cylinders[which as usize].top = turned;
}

/// The large double torus with zeros that do not face each other: tops are turned by shares of the
/// circumference.
pub(crate) fn twisted_double_torus(shares: [f64; 3]) -> Arc<CylinderComplex> {
    let mut cylinders = large_double_torus().cylinders().to_vec();
    for (which, share) in shares.into_iter().enumerate() {
        let length = (share * cylinders[which].circumference as f64) as i64;
        turn_top(&mut cylinders, which as u32, length);
    }
    Arc::new(CylinderComplex::build(cylinders).expect("a surface"))
}

/// Two cylinders with one zero of order 2.
pub(crate) fn double_zero(share: f64) -> Arc<CylinderComplex> {
    let unit = (1_i64 << 34) + 4_321;
    let row = |start, length, cylinder, there| Segment {
        start: start * unit,
        length: length * unit,
        beyond: Beyond::Cylinder {
            cylinder,
            start: there * unit,
        },
        zero: Some(0),
    };
    let wide = vec![row(0, 400, 1, 0), row(400, 600, 0, 400)];
    let narrow = vec![row(0, 400, 0, 0)];
    let cylinder = |border: Vec<Segment>, circumference, height| Cylinder {
        circumference: circumference * unit,
        height: height * unit,
        bottom: border.clone(),
        top: border,
    };
    let mut cylinders = vec![cylinder(wide, 1000, 350), cylinder(narrow, 400, 300)];
    for which in 0..2 {
        let length = (share * cylinders[which].circumference as f64) as i64;
        turn_top(&mut cylinders, which as u32, length);
    }
    Arc::new(CylinderComplex::build(cylinders).expect("a surface"))
}

/// Zeros that face each other, that do not, that nearly do, and a double one.
pub(crate) fn surfaces_with_zeros() -> Vec<Arc<CylinderComplex>> {
    vec![
        large_double_torus(),
        twisted_double_torus([0.317, 0.61, 0.0713]),
        twisted_double_torus([0.003, 0.9961, 0.02]),
        double_zero(0.2345),
    ]
}

/// A cylinder from a boundary at the bottom to a boundary or a pole at the top.
pub(crate) fn open_cylinder(top: Beyond) -> Arc<CylinderComplex> {
    let size = 1_i64 << 43;
    let border = |beyond| {
        vec![Segment {
            start: 0,
            length: size,
            beyond,
            zero: None,
        }]
    };
    let cylinder = Cylinder {
        circumference: size,
        height: size + size / 3,
        bottom: border(Beyond::Boundary { index: 0 }),
        top: border(top),
    };
    Arc::new(CylinderComplex::build(vec![cylinder]).expect("a surface"))
}

pub(crate) fn large_torus(twist: f64) -> Arc<CylinderComplex> {
    let size = (1_i64 << 43) + 77;
    let twist = (twist * size as f64) as i64;
    Arc::new(CylinderComplex::torus(size, size / 2 + 5, twist).expect("a torus"))
}

/// A mesh with even grids and random splits.
pub(crate) fn random_mesh(
    complex: &Arc<CylinderComplex>,
    grid: Grid,
    splits: usize,
    seed: u64,
) -> TMesh {
    let grids = vec![grid; complex.cylinders().len()];
    let mut mesh = TMesh::build(complex, &grids).expect("a mesh");
    let mut numbers = Sequence(seed);
    for _ in 0..splits {
        let leaf = (numbers.next() % mesh.leaves().len() as u64) as u32;
        let axis = [Axis::X, Axis::Y, Axis::Both][(numbers.next() % 3) as usize];
        mesh.refine(&[(leaf, axis)], &Grading::default());
    }
    mesh
}
