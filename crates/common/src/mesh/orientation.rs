//! Orientation of faces alike, outwards if the surface is closed.

use super::disjoint_sets::DisjointSets;
use super::half_edges::EdgeTable;
use super::repair::Sheet;
use super::repairs::Log;

impl Sheet<'_> {
    /// Returns an edge and its faces across which orientation comes back reversed, or orients all
    /// faces alike: outwards if the surface is closed, else as most of them are.
    pub(super) fn orient(&mut self, log: &mut Log) -> Result<bool, ([u32; 2], [u32; 2])> {
        let mut oriented = DisjointSets::new(self.faces.len());
        let mut closed = true;
        for edge in EdgeTable::of_triangles(&self.faces).edges() {
            closed &= edge.len() == 2;
            let [one, two] = edge else { continue };
            if !oriented.join(one.face, two.face, one.reversed == two.reversed) {
                let ends = [one.low, one.high].map(|v| self.vertex_origin[v as usize]);
                let faces = [one.face, two.face].map(|f| self.face_origin[f as usize]);
                return Err((ends, faces));
            }
        }
        let odd: Vec<bool> = (0..self.faces.len() as u32)
            .map(|f| oriented.find(f).1)
            .collect();
        let volume = if closed { self.volume(&odd) } else { 0.0 };
        let minority = 2 * odd.iter().filter(|&&odd| odd).count() <= odd.len();
        // Volume is that of the even faces as they are and the odd ones turned over.
        let turned = if volume == 0.0 {
            minority
        } else {
            volume > 0.0
        };
        let mut changed = false;
        for face in (0..odd.len()).filter(|&f| odd[f] == turned) {
            self.faces[face].swap(1, 2);
            log.flipped.insert(self.face_origin[face]);
            changed = true;
        }
        Ok(changed)
    }

    /// Returns six times the volume enclosed once the odd faces are turned over.
    fn volume(&self, odd: &[bool]) -> f64 {
        let centre = self.corners(self.faces[0])[0];
        let triangles = self.faces.iter().zip(odd);
        triangles
            .map(|(&triangle, &odd)| {
                let [a, b, c] = self.corners(triangle).map(|p| p - centre);
                let part = a.dot(&b.cross(&c));
                if odd { -part } else { part }
            })
            .sum()
    }
}
