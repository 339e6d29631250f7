//! The complete list of what is wrong with a polygon soup.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use nalgebra::Point3;

use super::defect::Defect;
use super::disjoint_sets::DisjointSets;
use super::half_edges::{EdgeTable, HalfEdge};
use super::polygons::triangulate;
use super::soup::PolygonSoup;

/// A face is of zero area if twice its area is at most this fraction of its squared perimeter: a
/// cotangent of its angles would then have at most six correct digits.
const COLLINEAR: f64 = 1e-10;

/// What was found in a polygon soup.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preflight {
    /// Every defect: first those of single faces and vertices, then those between faces.
    pub defects: Vec<Defect>,
    /// Number of faces with more than three corners, which acceptance cuts into triangles.
    pub polygons: usize,
    /// Pairs of a vertex and an earlier one at exactly the same position. That is no defect in
    /// itself, since a surface may touch itself; repair joins the edges that coincide.
    pub coincident: Vec<[u32; 2]>,
    /// Number of faces in each edge-connected component.
    pub components: Vec<u32>,
}

/// Returns every defect of a polygon soup, in O(n log n).
///
/// Faces that cannot be used at all (an index that names no vertex, a coordinate that is not
/// finite, fewer than three corners, a repeated vertex) are named as such, and then left aside
/// where edges, fans and components are examined; so are duplicates of an earlier face.
///
/// # Panics
/// If the face offsets of the soup do not ascend within its corners.
#[must_use]
pub fn preflight(soup: &PolygonSoup) -> Preflight {
    let mut found = Preflight::default();
    if soup.face_count() == 0 {
        found.defects.push(Defect::NoFace {
            vertices: soup.positions.len(),
        });
    }
    let faces = examine_faces(soup, &mut found);
    examine_vertices(soup, &mut found);
    let faces = examine_duplicates(soup, faces, &mut found);
    examine_neighbours(soup, &faces, &mut found);
    found
}

/// Returns the indices of a face if they all name vertices.
pub(super) fn checked_face(soup: &PolygonSoup, face: usize) -> Result<Vec<u32>, Defect> {
    let vertices = soup.positions.len();
    let place = face as u32;
    let corners = soup.face(face);
    let ids: Result<Vec<u32>, Defect> = corners
        .iter()
        .map(|&index| match usize::try_from(index) {
            Err(_) => Err(Defect::NegativeIndex { face: place, index }),
            Ok(id) if id >= vertices => Err(Defect::IndexOutOfRange {
                face: place,
                index,
                vertices,
            }),
            Ok(id) => Ok(id as u32),
        })
        .collect();
    let ids = ids?;
    if ids.len() < 3 {
        return Err(Defect::TooFewCorners {
            face: place,
            corners: ids.len(),
        });
    }
    Ok(ids)
}

/// Returns whether a vertex is at a finite position.
pub(super) fn is_finite(position: &Point3<f64>) -> bool {
    position.iter().all(|x| x.is_finite())
}

/// Returns whether corners lie on a line, relative to the length of their sides.
pub(super) fn is_collinear([a, b, c]: &[Point3<f64>; 3]) -> bool {
    let perimeter = (b - a).norm() + (c - b).norm() + (a - c).norm();
    // Differences of far coordinates overflow to infinity; such a face cannot be used either.
    let area = (b - a).cross(&(c - a)).norm();
    area.partial_cmp(&(COLLINEAR * perimeter * perimeter)) != Some(Ordering::Greater)
}

/// Returns, for each vertex, the first vertex at exactly the same position.
pub(super) fn first_coincident(positions: &[Point3<f64>]) -> Vec<u32> {
    // Adding zero makes the two zeros equal in their bits.
    let key = |v: &u32| {
        positions[*v as usize]
            .coords
            .map(|x| (x + 0.0).to_bits())
            .data
            .0
    };
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_by_key(key);
    let mut first: Vec<u32> = (0..positions.len() as u32).collect();
    for group in order.chunk_by(|a, b| key(a) == key(b)) {
        for &vertex in group {
            first[vertex as usize] = group[0];
        }
    }
    first
}

fn examine_faces(soup: &PolygonSoup, found: &mut Preflight) -> Vec<(u32, Vec<u32>)> {
    let mut usable = Vec::with_capacity(soup.face_count());
    for face in 0..soup.face_count() {
        let place = face as u32;
        match checked_face(soup, face) {
            Err(defect) => found.defects.push(defect),
            Ok(ids) => {
                found.polygons += usize::from(ids.len() > 3);
                let mut sorted = ids.clone();
                sorted.sort_unstable();
                if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                    found.defects.push(Defect::RepeatedVertex {
                        face: place,
                        vertex: pair[0],
                    });
                    continue;
                }
                let corners: Vec<_> = ids.iter().map(|&v| soup.positions[v as usize]).collect();
                if !corners.iter().all(is_finite) {
                    continue;
                }
                if has_zero_area(&corners) {
                    found.defects.push(Defect::ZeroArea { face: place });
                }
                usable.push((place, ids));
            }
        }
    }
    usable
}

/// Returns whether a polygon, or one of the triangles it is cut into, has its corners on a line.
fn has_zero_area(corners: &[Point3<f64>]) -> bool {
    triangulate(corners)
        .iter()
        .any(|triangle| is_collinear(&triangle.map(|i| corners[i])))
}

fn examine_vertices(soup: &PolygonSoup, found: &mut Preflight) {
    let mut used = vec![false; soup.positions.len()];
    for face in 0..soup.face_count() {
        for index in soup.face(face) {
            if let Some(slot) = usize::try_from(*index).ok().and_then(|i| used.get_mut(i)) {
                *slot = true;
            }
        }
    }
    for (vertex, position) in soup.positions.iter().enumerate() {
        let place = vertex as u32;
        if !is_finite(position) {
            let position = position.coords.data.0[0];
            found.defects.push(Defect::NotFinite {
                vertex: place,
                position,
            });
        }
        if !used[vertex] && soup.face_count() > 0 {
            found
                .defects
                .push(Defect::UnreferencedVertex { vertex: place });
        }
    }
    let first = first_coincident(&soup.positions);
    found.coincident = (0..first.len() as u32)
        .filter(|&v| first[v as usize] != v && is_finite(&soup.positions[v as usize]))
        .map(|v| [v, first[v as usize]])
        .collect();
}

fn examine_duplicates(
    soup: &PolygonSoup,
    faces: Vec<(u32, Vec<u32>)>,
    found: &mut Preflight,
) -> Vec<(u32, Vec<u32>)> {
    let sets: Vec<Vec<u32>> = faces.iter().map(|(_, ids)| sorted(ids)).collect();
    let mut order: Vec<u32> = (0..faces.len() as u32).collect();
    order.sort_by(|&a, &b| sets[a as usize].cmp(&sets[b as usize]).then(a.cmp(&b)));
    let mut original = vec![None; soup.face_count()];
    for group in order.chunk_by(|&a, &b| sets[a as usize] == sets[b as usize]) {
        for &copy in &group[1..] {
            original[faces[copy as usize].0 as usize] = Some(faces[group[0] as usize].0);
        }
    }
    for (face, of) in original.iter().enumerate() {
        if let Some(of) = *of {
            found.defects.push(Defect::DuplicateFace {
                face: face as u32,
                of,
            });
        }
    }
    faces
        .into_iter()
        .filter(|(face, _)| original[*face as usize].is_none())
        .collect()
}

fn sorted(ids: &[u32]) -> Vec<u32> {
    let mut ids = ids.to_vec();
    ids.sort_unstable();
    ids
}

fn examine_neighbours(soup: &PolygonSoup, faces: &[(u32, Vec<u32>)], found: &mut Preflight) {
    let mut corner_vertices = Vec::new();
    let mut half_edges = Vec::new();
    for (index, (_, ids)) in faces.iter().enumerate() {
        let (first, n) = (corner_vertices.len() as u32, ids.len());
        for i in 0..n {
            let j = (i + 1) % n;
            let corners = [first + i as u32, first + j as u32];
            half_edges.push(HalfEdge::new(index as u32, corners, [ids[i], ids[j]]));
        }
        corner_vertices.extend_from_slice(ids);
    }
    let table = EdgeTable::new(half_edges);
    let mut fans = DisjointSets::new(corner_vertices.len());
    let mut connected = DisjointSets::new(faces.len());
    let mut oriented = DisjointSets::new(faces.len());
    let mut one_sided = Vec::new();
    for edge in table.edges() {
        let ends = [edge[0].low, edge[0].high];
        let place = |h: &HalfEdge| faces[h.face as usize].0;
        for other in &edge[1..] {
            connected.join(edge[0].face, other.face, false);
            for (a, b) in edge[0].corners().into_iter().zip(other.corners()) {
                fans.join(a, b, false);
            }
        }
        if edge.len() > 2 {
            let faces = edge.iter().map(place).collect();
            found
                .defects
                .push(Defect::NonManifoldEdge { edge: ends, faces });
        } else if let [one, two] = edge {
            let mirrored = one.reversed == two.reversed;
            let pair = [place(one), place(two)];
            if mirrored {
                let defect = Defect::InconsistentOrientation {
                    edge: ends,
                    faces: pair,
                };
                found.defects.push(defect);
            }
            if !oriented.join(one.face, two.face, mirrored) {
                one_sided.push((oriented.root(one.face), ends, pair));
            }
        }
    }
    report_one_sided(one_sided, &mut oriented, found);
    report_fans(&corner_vertices, &mut fans, soup.positions.len(), found);
    report_components(&mut connected, faces.len(), found);
}

/// Names each one-sided component once.
fn report_one_sided(
    conflicts: Vec<(u32, [u32; 2], [u32; 2])>,
    oriented: &mut DisjointSets,
    found: &mut Preflight,
) {
    let mut named = BTreeSet::new();
    for (root, edge, faces) in conflicts {
        if named.insert(oriented.root(root)) {
            found.defects.push(Defect::NotOrientable { edge, faces });
        }
    }
}

fn report_fans(
    corner_vertices: &[u32],
    fans: &mut DisjointSets,
    vertex_count: usize,
    found: &mut Preflight,
) {
    let mut count = vec![0usize; vertex_count];
    for (corner, &vertex) in corner_vertices.iter().enumerate() {
        count[vertex as usize] += usize::from(fans.root(corner as u32) == corner as u32);
    }
    for (vertex, &fans) in count.iter().enumerate() {
        if fans > 1 {
            found.defects.push(Defect::BowTieVertex {
                vertex: vertex as u32,
                fans,
            });
        }
    }
}

fn report_components(connected: &mut DisjointSets, faces: usize, found: &mut Preflight) {
    let mut sizes = vec![0u32; faces];
    for face in 0..faces as u32 {
        sizes[connected.root(face) as usize] += 1;
    }
    found.components = sizes.into_iter().filter(|&n| n > 0).collect();
    if found.components.len() > 1 {
        found.defects.push(Defect::SeveralComponents {
            faces: found.components.clone(),
        });
    }
}
