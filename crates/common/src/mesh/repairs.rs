//! The record of what a repair did.

use std::collections::BTreeSet;

use super::defect::listed;

/// Elements of the input that a repair touched.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Affected {
    /// How many.
    pub count: usize,
    /// The ids of the first few, ascending.
    pub first: Vec<u32>,
}

/// How many ids a record of repairs keeps.
const KEPT_IDS: usize = 8;

impl std::fmt::Display for Affected {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let more = if self.count > self.first.len() {
            ", ..."
        } else {
            ""
        };
        write!(out, "{} ({}{more})", self.count, listed(&self.first))
    }
}

/// One kind of change made to a soup on its way to a mesh. Ids are those of the input.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Repair {
    /// Faces of more than three corners were cut into triangles; not a repair, but worth knowing.
    Triangulated(Affected),
    /// Faces that name no vertex, a vertex that is not finite, or fewer than three vertices were
    /// dropped.
    DroppedUnusableFaces(Affected),
    /// Faces whose corners lie on a line were removed.
    DroppedDegenerateFaces(Affected),
    /// Faces with the vertices of an earlier face were dropped.
    DroppedDuplicateFaces(Affected),
    /// Edges of more than two faces were cut; the faces listed lie along them.
    CutAtFaces(Affected),
    /// Vertices were merged into an earlier one at the same position.
    MergedVertices(Affected),
    /// Vertices at which separate fans of faces met, or a cut ends, were split.
    SplitVertices(Affected),
    /// Faces of all components but the largest were dropped.
    DroppedComponents {
        /// Number of components dropped.
        components: usize,
        /// Faces dropped with them.
        faces: Affected,
    },
    /// Faces were turned over.
    FlippedFaces(Affected),
    /// Vertices that no remaining face uses were dropped.
    DroppedVertices(Affected),
}

impl std::fmt::Display for Repair {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Triangulated(faces) => write!(out, "cut into triangles: faces {faces}"),
            Self::DroppedUnusableFaces(faces) => write!(out, "dropped unusable faces: {faces}"),
            Self::DroppedDegenerateFaces(faces) => write!(out, "removed faces of no area: {faces}"),
            Self::DroppedDuplicateFaces(faces) => write!(out, "dropped duplicate faces: {faces}"),
            Self::CutAtFaces(faces) => {
                write!(out, "cut along edges of more than two faces: faces {faces}")
            }
            Self::MergedVertices(vertices) => {
                write!(
                    out,
                    "merged vertices into earlier ones at the same position: {vertices}"
                )
            }
            Self::SplitVertices(vertices) => {
                write!(
                    out,
                    "split vertices between separate fans of faces: {vertices}"
                )
            }
            Self::DroppedComponents { components, faces } => write!(
                out,
                "kept the largest component and dropped {components} others: faces {faces}"
            ),
            Self::FlippedFaces(faces) => write!(out, "turned over faces: {faces}"),
            Self::DroppedVertices(vertices) => write!(out, "dropped unused vertices: {vertices}"),
        }
    }
}

/// Input ids touched, by kind of repair.
#[derive(Default)]
pub(super) struct Log {
    pub(super) triangulated: BTreeSet<u32>,
    pub(super) unusable: BTreeSet<u32>,
    pub(super) degenerate: BTreeSet<u32>,
    pub(super) duplicate: BTreeSet<u32>,
    pub(super) cut: BTreeSet<u32>,
    pub(super) merged: BTreeSet<u32>,
    pub(super) split: BTreeSet<u32>,
    pub(super) components: usize,
    pub(super) component_faces: BTreeSet<u32>,
    pub(super) flipped: BTreeSet<u32>,
    pub(super) dropped_vertices: BTreeSet<u32>,
}

impl Log {
    /// Returns what was done, in the order in which it is done.
    pub(super) fn repairs(&self) -> Vec<Repair> {
        let components = self.components;
        let done = [
            affected(&self.triangulated).map(Repair::Triangulated),
            affected(&self.unusable).map(Repair::DroppedUnusableFaces),
            affected(&self.degenerate).map(Repair::DroppedDegenerateFaces),
            affected(&self.duplicate).map(Repair::DroppedDuplicateFaces),
            affected(&self.cut).map(Repair::CutAtFaces),
            affected(&self.merged).map(Repair::MergedVertices),
            affected(&self.split).map(Repair::SplitVertices),
            affected(&self.component_faces)
                .map(|faces| Repair::DroppedComponents { components, faces }),
            affected(&self.flipped).map(Repair::FlippedFaces),
            affected(&self.dropped_vertices).map(Repair::DroppedVertices),
        ];
        done.into_iter().flatten().collect()
    }
}

fn affected(ids: &BTreeSet<u32>) -> Option<Affected> {
    let first = || ids.iter().copied().take(KEPT_IDS).collect();
    (!ids.is_empty()).then(|| Affected {
        count: ids.len(),
        first: first(),
    })
}
