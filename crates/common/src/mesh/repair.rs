//! Repair of a polygon soup, step by step.

use std::collections::BTreeSet;

use nalgebra::Point3;

use super::disjoint_sets::DisjointSets;
use super::half_edges::{EdgeTable, HalfEdge};
use super::preflight::{checked_face, first_coincident, is_collinear, is_finite};
use super::repairs::Log;
use super::soup::PolygonSoup;

/// Triangles on their way to a mesh, and where they come from.
pub(super) struct Sheet<'a> {
    pub(super) input: &'a [Point3<f64>],
    /// Input vertex of each vertex.
    pub(super) vertex_origin: Vec<u32>,
    /// Corners of each triangle.
    pub(super) faces: Vec<[u32; 3]>,
    /// Input face of each triangle.
    pub(super) face_origin: Vec<u32>,
}

impl<'a> Sheet<'a> {
    /// Returns the triangles of the faces that can be used.
    pub(super) fn new(soup: &'a PolygonSoup, log: &mut Log) -> Self {
        let mut sheet = Self {
            input: &soup.positions,
            vertex_origin: (0..soup.positions.len() as u32).collect(),
            faces: Vec::with_capacity(soup.face_count()),
            face_origin: Vec::with_capacity(soup.face_count()),
        };
        for face in 0..soup.face_count() {
            let place = face as u32;
            let mut ids = match checked_face(soup, face) {
                Ok(ids) if ids.iter().all(|&v| is_finite(&soup.positions[v as usize])) => ids,
                _ => {
                    log.unusable.insert(place);
                    continue;
                }
            };
            let corners = ids.len();
            ids.dedup();
            if ids.len() > 1 && ids.first() == ids.last() {
                ids.pop();
            }
            if ids.len() < 3 || BTreeSet::from_iter(&ids).len() < ids.len() {
                log.degenerate.insert(place);
                continue;
            }
            if ids.len() < corners {
                log.degenerate.insert(place);
            }
            if ids.len() > 3 {
                log.triangulated.insert(place);
            }
            let polygon: Vec<_> = ids.iter().map(|&v| soup.positions[v as usize]).collect();
            for triangle in super::polygons::triangulate(&polygon) {
                sheet.faces.push(triangle.map(|i| ids[i]));
                sheet.face_origin.push(place);
            }
        }
        sheet
    }

    /// Returns the position of every vertex.
    pub(super) fn positions(&self) -> Vec<Point3<f64>> {
        self.vertex_origin
            .iter()
            .map(|&v| self.input[v as usize])
            .collect()
    }

    pub(super) fn corners(&self, triangle: [u32; 3]) -> [Point3<f64>; 3] {
        triangle.map(|v| self.input[self.vertex_origin[v as usize] as usize])
    }

    /// Repairs once; returns whether anything changed.
    pub(super) fn repair_round(&mut self, log: &mut Log) -> bool {
        let mut changed = self.split_at_flat_corners(log);
        changed |= self.drop_degenerate(log);
        changed |= self.drop_duplicates(log);
        changed |= self.join_and_split(log);
        changed |= self.keep_largest(log);
        changed |= self.drop_unused_vertices();
        changed
    }

    fn drop_degenerate(&mut self, log: &mut Log) -> bool {
        let keep = |sheet: &Self, f: usize| !is_collinear(&sheet.corners(sheet.faces[f]));
        self.retain_faces(&mut log.degenerate, keep)
    }

    /// Drops faces with the vertices of an earlier one, and triangles connected to nothing that
    /// lie exactly on another.
    fn drop_duplicates(&mut self, log: &mut Log) -> bool {
        let first = first_coincident(&self.positions());
        let mut alone = vec![true; self.faces.len()];
        for edge in EdgeTable::of_triangles(&self.faces)
            .edges()
            .filter(|edge| edge.len() > 1)
        {
            edge.iter().for_each(|h| alone[h.face as usize] = false);
        }
        let sorted = |mut ids: [u32; 3]| {
            ids.sort_unstable();
            ids
        };
        let places: Vec<_> = self
            .faces
            .iter()
            .map(|t| sorted(t.map(|v| first[v as usize])))
            .collect();
        let sets: Vec<_> = self.faces.iter().map(|&t| sorted(t)).collect();
        let mut order: Vec<usize> = (0..self.faces.len()).collect();
        // Connected faces first, so that a lone triangle yields to them.
        order.sort_by_key(|&f| (places[f], alone[f], sets[f], f));
        let mut keep = vec![true; self.faces.len()];
        for group in order.chunk_by(|&a, &b| places[a] == places[b]) {
            for pair in group.windows(2) {
                keep[pair[1]] = !alone[pair[1]] && sets[pair[0]] != sets[pair[1]];
            }
        }
        self.retain_faces(&mut log.duplicate, |_, f| keep[f])
    }

    /// Gives every fan of faces a vertex of its own, after joining boundary edges that coincide.
    ///
    /// Corners of faces are united across edges of two faces, and then across boundary edges of
    /// which exactly two coincide and orientation allows it; every set of corners becomes a
    /// vertex. An edge of more than two faces unites nothing, which cuts the surface along it.
    fn join_and_split(&mut self, log: &mut Log) -> bool {
        let mut corners = DisjointSets::new(3 * self.faces.len());
        let mut oriented = DisjointSets::new(self.faces.len());
        let first = first_coincident(&self.positions());
        let mut open = Vec::new();
        let mut cut = false;
        for edge in EdgeTable::of_triangles(&self.faces).edges() {
            match edge {
                [one, two] => {
                    unite(&mut corners, one, two);
                    oriented.join(one.face, two.face, one.reversed == two.reversed);
                }
                [one] => open.push(*one),
                _ => {
                    cut = true;
                    log.cut
                        .extend(edge.iter().map(|h| self.face_origin[h.face as usize]));
                }
            }
        }
        for half_edge in &mut open {
            let ends = [half_edge.corner, half_edge.next].map(|c| first[self.at(c) as usize]);
            *half_edge = HalfEdge::new(half_edge.face, [half_edge.corner, half_edge.next], ends);
        }
        for edge in EdgeTable::new(open).edges() {
            if let [one, two] = edge
                && oriented.join(one.face, two.face, one.reversed == two.reversed)
            {
                unite(&mut corners, one, two);
            }
        }
        self.rebuild_vertices(&mut corners, log) || cut
    }

    fn at(&self, corner: u32) -> u32 {
        self.faces[(corner / 3) as usize][(corner % 3) as usize]
    }

    /// Makes each set of corners a vertex, ordered by the first vertex among its corners.
    fn rebuild_vertices(&mut self, corners: &mut DisjointSets, log: &mut Log) -> bool {
        let count = 3 * self.faces.len();
        let mut lowest = vec![u32::MAX; count];
        for corner in 0..count as u32 {
            let root = corners.root(corner) as usize;
            lowest[root] = lowest[root].min(self.at(corner));
        }
        let mut roots: Vec<u32> = (0..count as u32)
            .filter(|&c| lowest[c as usize] != u32::MAX)
            .collect();
        roots.sort_by_key(|&root| (lowest[root as usize], root));
        let mut number = vec![u32::MAX; count];
        for (id, &root) in roots.iter().enumerate() {
            number[root as usize] = id as u32;
        }
        let mut changed = false;
        for pair in roots.windows(2) {
            let vertex = lowest[pair[1] as usize];
            if lowest[pair[0] as usize] == vertex {
                log.split.insert(self.vertex_origin[vertex as usize]);
                changed = true;
            }
        }
        let mut faces = self.faces.clone();
        for corner in 0..count as u32 {
            let (vertex, root) = (self.at(corner), corners.root(corner));
            if vertex != lowest[root as usize] {
                log.merged.insert(self.vertex_origin[vertex as usize]);
                changed = true;
            }
            faces[(corner / 3) as usize][(corner % 3) as usize] = number[root as usize];
        }
        let origin = |&root: &u32| self.vertex_origin[lowest[root as usize] as usize];
        self.vertex_origin = roots.iter().map(origin).collect();
        self.faces = faces;
        changed
    }

    fn keep_largest(&mut self, log: &mut Log) -> bool {
        let mut connected = DisjointSets::new(self.faces.len());
        for edge in EdgeTable::of_triangles(&self.faces).edges() {
            for other in &edge[1..] {
                connected.join(edge[0].face, other.face, false);
            }
        }
        let roots: Vec<u32> = (0..self.faces.len() as u32)
            .map(|f| connected.root(f))
            .collect();
        let mut size = vec![0usize; self.faces.len()];
        roots.iter().for_each(|&root| size[root as usize] += 1);
        let largest =
            (0..size.len()).fold(0, |best, f| if size[f] > size[best] { f } else { best });
        log.components += size.iter().filter(|&&n| n > 0).count().saturating_sub(1);
        self.retain_faces(&mut log.component_faces, |_, f| {
            roots[f] as usize == largest
        })
    }

    fn drop_unused_vertices(&mut self) -> bool {
        let mut number = vec![u32::MAX; self.vertex_origin.len()];
        self.faces
            .iter()
            .flatten()
            .for_each(|&v| number[v as usize] = 0);
        let before = self.vertex_origin.len();
        let mut kept = Vec::with_capacity(before);
        for (vertex, slot) in number
            .iter_mut()
            .enumerate()
            .filter(|(_, slot)| **slot == 0)
        {
            *slot = kept.len() as u32;
            kept.push(self.vertex_origin[vertex]);
        }
        self.vertex_origin = kept;
        for triangle in &mut self.faces {
            *triangle = triangle.map(|v| number[v as usize]);
        }
        self.vertex_origin.len() < before
    }

    /// Records the input vertices that neither remain nor were merged.
    pub(super) fn log_dropped_vertices(&self, log: &mut Log) {
        let mut kept = vec![false; self.input.len()];
        self.vertex_origin
            .iter()
            .for_each(|&v| kept[v as usize] = true);
        let gone = (0..kept.len() as u32).filter(|&v| !kept[v as usize]);
        log.dropped_vertices = gone.filter(|v| !log.merged.contains(v)).collect();
    }

    fn retain_faces(
        &mut self,
        dropped: &mut BTreeSet<u32>,
        keep: impl Fn(&Self, usize) -> bool,
    ) -> bool {
        let keep: Vec<bool> = (0..self.faces.len()).map(|f| keep(self, f)).collect();
        dropped.extend(
            (0..keep.len())
                .filter(|&f| !keep[f])
                .map(|f| self.face_origin[f]),
        );
        let mut flags = keep.iter();
        self.faces.retain(|_| *flags.next().unwrap_or(&true));
        let mut flags = keep.iter();
        self.face_origin.retain(|_| *flags.next().unwrap_or(&true));
        keep.contains(&false)
    }
}

fn unite(corners: &mut DisjointSets, one: &HalfEdge, two: &HalfEdge) {
    for (a, b) in one.corners().into_iter().zip(two.corners()) {
        corners.join(a, b, false);
    }
}
