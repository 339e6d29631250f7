//! What is wrong with a soup of tetrahedra.

use nalgebra::Point3;

use super::connectivity;
use super::defect::TetDefect;
use super::orientation::{Orientation, orientation};
use super::soup::TetSoup;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::preflight::is_finite;

/// What was found in a soup of tetrahedra.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetPreflight {
    /// Every defect: first those of single cells and vertices, then those between cells.
    pub defects: Vec<TetDefect>,
    /// Whether every cell that is not flat has its corners in the negative order: another
    /// convention and no defect, which acceptance under either policy turns around.
    pub all_inverted: bool,
    /// Number of cells in each component of cells that share faces.
    pub components: Vec<u32>,
}

/// Returns every defect of a soup of tetrahedra, in O(n log n).
///
/// Cells that cannot be used at all (an index that names no vertex, a coordinate that is not finite,
/// a repeated vertex) are named as such, and then left aside where faces, edges and components are
/// examined; so are duplicates of an earlier cell.
#[must_use]
pub fn preflight(soup: &TetSoup) -> TetPreflight {
    let mut found = TetPreflight::default();
    if soup.cells.is_empty() {
        found.defects.push(TetDefect::NoCell {
            vertices: soup.positions.len(),
        });
    }
    let mut cells = examine_cells(soup, &mut found);
    examine_vertices(soup, &mut found);
    drop_duplicates(&mut cells, &mut found);
    orient(soup, &mut cells, &mut found);
    examine_neighbours(soup.positions.len(), &cells, &mut found);
    found
}

/// Returns the corners of a cell if they name four vertices at finite positions, `None` if one is
/// not finite.
pub(super) fn checked_cell(soup: &TetSoup, cell: u32) -> Result<Option<[u32; 4]>, TetDefect> {
    let vertices = soup.positions.len();
    let mut corners = [0; 4];
    for (i, &index) in soup.cells[cell as usize].iter().enumerate() {
        match usize::try_from(index) {
            Ok(id) if id < vertices => corners[i] = id as u32,
            _ => {
                return Err(TetDefect::IndexOutOfRange {
                    cell,
                    index,
                    vertices,
                });
            }
        }
        if corners[..i].contains(&corners[i]) {
            let vertex = corners[i];
            return Err(TetDefect::RepeatedVertex { cell, vertex });
        }
    }
    let finite = corners
        .iter()
        .all(|&v| is_finite(&soup.positions[v as usize]));
    Ok(finite.then_some(corners))
}

/// Returns the orientation of a cell.
pub(super) fn orientation_of(positions: &[Point3<f64>], corners: [u32; 4]) -> Orientation {
    orientation(&corners.map(|v| positions[v as usize]))
}

fn examine_cells(soup: &TetSoup, found: &mut TetPreflight) -> Vec<(u32, [u32; 4])> {
    let mut usable = Vec::with_capacity(soup.cells.len());
    for cell in 0..soup.cells.len() as u32 {
        match checked_cell(soup, cell) {
            Err(defect) => found.defects.push(defect),
            Ok(None) => {}
            Ok(Some(corners)) => usable.push((cell, corners)),
        }
    }
    usable
}

fn examine_vertices(soup: &TetSoup, found: &mut TetPreflight) {
    let mut used = vec![false; soup.positions.len()];
    for &index in soup.cells.iter().flatten() {
        if let Some(slot) = usize::try_from(index).ok().and_then(|i| used.get_mut(i)) {
            *slot = true;
        }
    }
    for (vertex, position) in soup.positions.iter().enumerate() {
        let vertex = vertex as u32;
        if !is_finite(position) {
            let position = position.coords.data.0[0];
            found
                .defects
                .push(TetDefect::NotFinite { vertex, position });
        }
        if !used[vertex as usize] && !soup.cells.is_empty() {
            found.defects.push(TetDefect::UnreferencedVertex { vertex });
        }
    }
}

/// Drops all but the first of cells with the same vertices.
pub(super) fn drop_duplicates(cells: &mut Vec<(u32, [u32; 4])>, found: &mut TetPreflight) {
    let sorted = |place: &u32| {
        let mut corners = cells[*place as usize].1;
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<u32> = (0..cells.len() as u32).collect();
    order.sort_by_cached_key(sorted);
    let mut original = vec![None; cells.len()];
    for same in order.chunk_by(|a, b| sorted(a) == sorted(b)) {
        for &copy in &same[1..] {
            original[copy as usize] = Some(cells[same[0] as usize].0);
        }
    }
    let mut place = 0;
    cells.retain(|&(cell, _)| {
        let of = original[place];
        place += 1;
        if let Some(of) = of {
            found.defects.push(TetDefect::DuplicateCell { cell, of });
        }
        of.is_none()
    });
}

/// Names flat and inverted cells, and puts the corners of the latter in order.
pub(super) fn orient(soup: &TetSoup, cells: &mut [(u32, [u32; 4])], found: &mut TetPreflight) {
    let (mut inverted, mut flat) = (Vec::new(), 0);
    for (cell, corners) in cells.iter_mut() {
        match orientation_of(&soup.positions, *corners) {
            Orientation::Positive => {}
            Orientation::Negative => {
                inverted.push(*cell);
                corners.swap(2, 3);
            }
            Orientation::Flat => {
                flat += 1;
                found.defects.push(TetDefect::Flat {
                    cell: *cell,
                    corners: *corners,
                });
            }
        }
    }
    found.all_inverted = !inverted.is_empty() && inverted.len() + flat == cells.len();
    if !inverted.is_empty() && !found.all_inverted {
        found.defects.push(TetDefect::Inverted { cells: inverted });
    }
}

fn examine_neighbours(vertex_count: usize, cells: &[(u32, [u32; 4])], found: &mut TetPreflight) {
    let corners: Vec<[u32; 4]> = cells.iter().map(|&(_, corners)| corners).collect();
    let uses = connectivity::face_uses(vertex_count, &corners);
    let place = |cell: u32| cells[cell as usize].0;
    let mut connected = DisjointSets::new(cells.len());
    let mut parts = DisjointSets::new(4 * cells.len());
    let mut boundary = Vec::new();
    for same in uses.chunk_by(|a, b| a.vertices == b.vertices) {
        let [first, rest @ ..] = same else { continue };
        let face = first.vertices;
        for other in rest {
            connected.join(first.cell, other.cell, false);
            for vertex in face {
                let corner = |cell: u32| {
                    let local = corners[cell as usize].iter().position(|&v| v == vertex);
                    4 * cell + local.unwrap_or(0) as u32
                };
                parts.join(corner(first.cell), corner(other.cell), false);
            }
        }
        match same {
            [_] => boundary.push(face),
            [one, two] if one.reversed == two.reversed => found.defects.push(TetDefect::Folded {
                face,
                cells: [place(one.cell), place(two.cell)],
            }),
            [_, _] => {}
            _ => found.defects.push(TetDefect::NonManifoldFace {
                face,
                cells: same.iter().map(|one| place(one.cell)).collect(),
            }),
        }
    }
    let mut pieces = vec![0usize; vertex_count];
    for (corner, &vertex) in corners.iter().flatten().enumerate() {
        let root = parts.root(corner as u32) == corner as u32;
        pieces[vertex as usize] += usize::from(root);
    }
    let fans = boundary_fans(vertex_count, &boundary, found);
    for (vertex, (&pieces, fans)) in pieces.iter().zip(fans).enumerate() {
        let parts = pieces.max(fans);
        if parts > 1 {
            let vertex = vertex as u32;
            found
                .defects
                .push(TetDefect::NonManifoldVertex { vertex, parts });
        }
    }
    report_components(&mut connected, cells.len(), found);
}

/// Names the edges that have not two boundary faces, and returns the number of fans of boundary
/// faces around each vertex.
fn boundary_fans(vertex_count: usize, faces: &[[u32; 3]], found: &mut TetPreflight) -> Vec<usize> {
    // Vertices of a face ascend, and so do the ends of its edges.
    let mut edges: Vec<([u32; 2], [u32; 2])> = (0..faces.len())
        .flat_map(|f| {
            let corner = |i| (3 * f + i) as u32;
            [[0, 1], [0, 2], [1, 2]]
                .map(|[i, j]| ([faces[f][i], faces[f][j]], [corner(i), corner(j)]))
        })
        .collect();
    edges.sort_unstable();
    let mut fans = DisjointSets::new(3 * faces.len());
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        for other in &same[1..] {
            for (a, b) in same[0].1.into_iter().zip(other.1) {
                fans.join(a, b, false);
            }
        }
        if same.len() != 2 {
            found.defects.push(TetDefect::NonManifoldEdge {
                edge: same[0].0,
                faces: same.len(),
            });
        }
    }
    let mut count = vec![0usize; vertex_count];
    for (corner, &vertex) in faces.iter().flatten().enumerate() {
        count[vertex as usize] += usize::from(fans.root(corner as u32) == corner as u32);
    }
    count
}

fn report_components(connected: &mut DisjointSets, cells: usize, found: &mut TetPreflight) {
    let mut sizes = vec![0u32; cells];
    for cell in 0..cells as u32 {
        sizes[connected.root(cell) as usize] += 1;
    }
    found.components = sizes.into_iter().filter(|&n| n > 0).collect();
    if found.components.len() > 1 {
        found.defects.push(TetDefect::SeveralComponents {
            cells: found.components.clone(),
        });
    }
}
