//! Meshes, networks and solids as bare numbers, which may be wrong.

use std::fmt::Write;

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::tet::TetMesh;

use super::law::Bounds;

/// What the cells of a draft are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Triangles or other polygons.
    Faces,
    /// Curves through points.
    Curves,
    /// Tetrahedra.
    Tets,
}

/// Points, and cells of their numbers.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub(super) kind: Kind,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) cells: Vec<Vec<u32>>,
}

impl Draft {
    pub(super) fn of_triangles(mesh: &TriangleMesh) -> Self {
        Self {
            kind: Kind::Faces,
            positions: mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect(),
            cells: mesh.faces().iter().map(|face| face.to_vec()).collect(),
        }
    }

    pub(super) fn of_polygons(mesh: &PolygonMesh) -> Self {
        Self {
            kind: Kind::Faces,
            positions: mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect(),
            cells: mesh.topology().faces().map(<[u32]>::to_vec).collect(),
        }
    }

    pub(super) fn of_curves(network: &CurveNetwork) -> Self {
        Self {
            kind: Kind::Curves,
            positions: network.points().iter().map(|p| [p.x, p.y, p.z]).collect(),
            cells: network.curves().iter().map(|c| c.points.clone()).collect(),
        }
    }

    pub(super) fn of_tets(mesh: &TetMesh) -> Self {
        Self {
            kind: Kind::Tets,
            positions: mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect(),
            cells: mesh.cells().iter().map(|cell| cell.to_vec()).collect(),
        }
    }

    /// Returns where a result may lie.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds::around(self.positions.iter().copied())
    }

    /// Returns the ending of its file.
    pub(super) fn ending(&self) -> &'static str {
        match self.kind {
            Kind::Faces | Kind::Curves => "obj",
            Kind::Tets => "mesh",
        }
    }

    /// Returns its file: OBJ, or Medit for solids.
    pub(super) fn text(&self) -> String {
        let number = |x: &f64| {
            if x.is_nan() {
                "nan".to_owned()
            } else {
                x.to_string()
            }
        };
        let point = |p: &[f64; 3]| p.iter().map(number).collect::<Vec<_>>().join(" ");
        let cell = |c: &Vec<u32>| {
            let corners: Vec<String> = c.iter().map(|v| (v + 1).to_string()).collect();
            corners.join(" ")
        };
        let mut text = String::new();
        if self.kind == Kind::Tets {
            let _ = writeln!(
                text,
                "MeshVersionFormatted 2\nDimension 3\nVertices\n{}",
                self.positions.len()
            );
            for p in &self.positions {
                let _ = writeln!(text, "{} 0", point(p));
            }
            let _ = writeln!(text, "Tetrahedra\n{}", self.cells.len());
            for c in &self.cells {
                let _ = writeln!(text, "{} 0", cell(c));
            }
            text.push_str("End\n");
            return text;
        }
        let letter = if self.kind == Kind::Curves { 'l' } else { 'f' };
        for p in &self.positions {
            let _ = writeln!(text, "v {}", point(p));
        }
        for c in &self.cells {
            let _ = writeln!(text, "{letter} {}", cell(c));
        }
        text
    }

    /// Leaves out points that no cell names.
    pub(super) fn compact(&mut self) {
        let mut number = vec![None; self.positions.len()];
        let mut kept = Vec::new();
        for vertex in self.cells.iter_mut().flatten() {
            let new = number[*vertex as usize].get_or_insert_with(|| {
                kept.push(self.positions[*vertex as usize]);
                kept.len() as u32 - 1
            });
            *vertex = *new;
        }
        self.positions = kept;
    }

    /// Adds a small draft of the same kind beside this one, all of it new but the corners in `shared`,
    /// which become vertices of this one.
    pub(super) fn add_beside(&mut self, other: &Self, shared: Option<(u32, u32)>) {
        let [low, high] = self.bounds().inner;
        let size = 0.1 * (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let base = self.positions.len() as u32;
        let place = |p: &[f64; 3]| [0, 1, 2].map(|d| high[d] + size * (1.0 + p[d]));
        self.positions.extend(other.positions.iter().map(place));
        let rename = |v: &u32| match shared {
            Some((theirs, ours)) if theirs == *v => ours,
            _ => base + v,
        };
        let cells = other.cells.iter().map(|c| c.iter().map(rename).collect());
        self.cells.extend(cells);
        if shared.is_some() {
            self.compact();
        }
    }
}
