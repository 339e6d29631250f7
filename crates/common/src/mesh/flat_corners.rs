//! Removal of faces of no area without leaving a slit.

use std::collections::BTreeSet;

use super::half_edges::EdgeTable;
use super::preflight::is_collinear;
use super::repair::Sheet;
use super::repairs::Log;

impl Sheet<'_> {
    /// Removes a face whose middle corner lies on its longest side by splitting the face beyond
    /// that side there, so that no slit is left.
    pub(super) fn split_at_flat_corners(&mut self, log: &mut Log) -> bool {
        let flat: Vec<u32> = (0..self.faces.len() as u32)
            .filter(|&f| is_collinear(&self.corners(self.faces[f as usize])))
            .collect();
        if flat.is_empty() {
            return false;
        }
        let table = EdgeTable::of_triangles(&self.faces);
        let mut touched = BTreeSet::new();
        for face in flat {
            let triangle = self.faces[face as usize];
            let corners = self.corners(triangle);
            let length = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm_squared();
            let side = (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
            let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
            let apex = triangle[(side + 2) % 3];
            let [one, two] = table.edge(from, to) else {
                continue;
            };
            let other = if one.face == face { two.face } else { one.face };
            if touched.contains(&face) || touched.contains(&other) {
                continue;
            }
            if let Some(halves) = self.halves(other, [from, to], apex) {
                log.degenerate.insert(self.face_origin[face as usize]);
                touched.extend([face, other]);
                self.faces[other as usize] = halves[0];
                self.faces[face as usize] = halves[1];
                self.face_origin[face as usize] = self.face_origin[other as usize];
            }
        }
        !touched.is_empty()
    }

    /// Returns the halves of a face split at `apex` on the side between `ends`, if they are sound.
    fn halves(&self, face: u32, ends: [u32; 2], apex: u32) -> Option<[[u32; 3]; 2]> {
        let triangle = self.faces[face as usize];
        let i = (0..3).find(|&i| !ends.contains(&triangle[i]))?;
        let (far, from, to) = (triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]);
        let halves = [[far, from, apex], [far, apex, to]];
        let sound = |half: [u32; 3]| !is_collinear(&self.corners(half));
        (far != apex && halves.into_iter().all(sound)).then_some(halves)
    }
}
