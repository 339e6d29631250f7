//! All faces of an atlas in the plane at once.

use std::collections::VecDeque;

use msplines_common::mesh::{NONE, Topology};

use crate::atlas::Atlas;

/// Images of a vertex that are nearer than this share of the whole image are one: they come along
/// other paths, and differ by the rounding of some hundred sums.
const SAME: f64 = 1e-12;

impl Atlas {
    /// Returns the corners of every face in the plane, up to one translation of all: the form is
    /// integrated over a spanning tree of faces, breadth first.
    ///
    /// Two faces agree along their edge wherever no loop with a period closes there; elsewhere they
    /// differ by a period. Faces at a pole have no image: theirs has no area. Faces on limbs may be too
    /// small for the digits of coordinates, which the form itself is not. O(n).
    ///
    /// # Reference
    /// [He2005] §3.3, the charts of the affine atlas.
    #[must_use]
    pub fn corners(&self) -> Vec<[[f64; 2]; 3]> {
        let faces = self.mesh().face_count();
        let mut at_pole = vec![false; faces];
        let poles = self.zeros().iter().filter(|zero| zero.order < 0);
        for &face in poles.flat_map(|pole| &pole.faces) {
            at_pole[face as usize] = true;
        }
        let mut corners = vec![[[0.0; 2]; 3]; faces];
        let mut is_placed = vec![false; faces];
        let (inside, last): (Vec<usize>, Vec<usize>) = (0..faces).partition(|&f| !at_pole[f]);
        for first in inside.into_iter().chain(last) {
            if is_placed[first] {
                continue;
            }
            is_placed[first] = true;
            let sides = &self.form()[3 * first..];
            corners[first] = [[0.0; 2], sides[0], negated(sides[2])];
            let mut queue = VecDeque::from([first]);
            while let Some(face) = queue.pop_front() {
                // The form is not closed there, and nothing may depend on it.
                if at_pole[face] {
                    continue;
                }
                for side in 0..3 {
                    let twin = self.mesh().topology().twin((3 * face + side) as u32);
                    if twin == NONE || is_placed[twin as usize / 3] {
                        continue;
                    }
                    let (beside, own) = (twin as usize / 3, twin as usize % 3);
                    let (from, to) = (corners[face][side], corners[face][(side + 1) % 3]);
                    let back = self.form()[Topology::previous(twin) as usize];
                    corners[beside][own] = to;
                    corners[beside][(own + 1) % 3] = from;
                    corners[beside][(own + 2) % 3] = [to[0] - back[0], to[1] - back[1]];
                    is_placed[beside] = true;
                    queue.push_back(beside);
                }
            }
        }
        self.united(corners)
    }

    /// Returns the corners with images of a vertex that differ by rounding made the same.
    fn united(&self, mut corners: Vec<[[f64; 2]; 3]>) -> Vec<[[f64; 2]; 3]> {
        let all = corners.as_flattened().as_flattened();
        let near = SAME * all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let mut images: Vec<Vec<[f64; 2]>> = vec![Vec::new(); self.mesh().vertex_count()];
        for (face, own) in self.mesh().faces().iter().zip(&mut corners) {
            for (&vertex, corner) in face.iter().zip(own) {
                let known = &mut images[vertex as usize];
                let same = |at: &&[f64; 2]| (at[0] - corner[0]).hypot(at[1] - corner[1]) <= near;
                match known.iter().find(same) {
                    Some(image) => *corner = *image,
                    None => known.push(*corner),
                }
            }
        }
        corners
    }
}

fn negated(v: [f64; 2]) -> [f64; 2] {
    v.map(|x| -x)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;

    use crate::{Atlas, AtlasOptions, SurfaceAtlas};

    /// Rounding of a path of some hundred faces, over the size of the image.
    const ROUNDING: f64 = 1e-11;

    fn laid_out(mesh: &msplines_common::mesh::TriangleMesh, puncture: &[u32]) -> SurfaceAtlas {
        let options = AtlasOptions {
            puncture: puncture.to_vec(),
            ..AtlasOptions::default()
        };
        Atlas::of_surface(mesh, &options, &mut unobserved()).expect("an atlas")
    }

    /// How many images each vertex has, and the farthest of a side from the form over the diagonal.
    fn images(atlas: &Atlas) -> (Vec<usize>, f64) {
        let mut images = vec![BTreeSet::new(); atlas.mesh().vertex_count()];
        let mut farthest = 0.0_f64;
        let poles: Vec<u32> = atlas
            .zeros()
            .iter()
            .filter(|z| z.order < 0)
            .flat_map(|z| z.faces.clone())
            .collect();
        for (face, corners) in atlas.corners().iter().enumerate() {
            if poles.contains(&(face as u32)) {
                continue;
            }
            for side in 0..3 {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                let along = atlas.form()[3 * face + side];
                farthest =
                    farthest.max((to[0] - from[0] - along[0]).hypot(to[1] - from[1] - along[1]));
                images[atlas.mesh().faces()[face][side] as usize].insert(from.map(f64::to_bits));
            }
        }
        (
            images.iter().map(BTreeSet::len).collect(),
            farthest / atlas.mesh().diagonal(),
        )
    }

    #[test]
    fn a_disk_has_one_image_and_every_side_is_the_form() {
        let found = laid_out(&shapes::sphere(600), &[7]);
        let (images, farthest) = images(&found.atlas);
        assert!(images.iter().all(|&count| count == 1), "{images:?}");
        assert!(farthest < ROUNDING, "{farthest}");
    }

    #[test]
    fn images_of_a_torus_differ_along_a_seam_only() {
        let mesh = shapes::torus(1.0, 0.4, 900);
        let (images, farthest) = images(&laid_out(&mesh, &[]).atlas);
        let at_seams = images.iter().filter(|&&count| count > 1).count();
        // Two loops around, with a branch or two that the tree leaves, and no more.
        assert!(
            (10..mesh.vertex_count() / 4).contains(&at_seams),
            "{at_seams}"
        );
        assert!(farthest < ROUNDING, "{farthest}");
    }

    #[test]
    fn a_pole_has_no_image_and_spoils_none() {
        let found = laid_out(&shapes::bumpy_sphere(642), &[]);
        let (images, farthest) = images(&found.atlas);
        assert!(images.iter().all(|&count| count <= 1), "{images:?}");
        // Faces beside the pole are large.
        assert!(farthest < 1e3 * ROUNDING, "{farthest}");
        assert!(
            found.report.closedness < ROUNDING,
            "{}",
            found.report.closedness
        );
    }
}
