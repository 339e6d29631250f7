//! Control meshes of quads made from a short name, with creases, darts, cusps and jitter.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use msplines_common::Vector3;
use msplines_common::mesh::polygon::{CreaseTag, INFINITELY_SHARP, PolygonMesh};
use msplines_common::mesh::shapes;
use serde::{Deserialize, Serialize};

/// By how much vertices are moved along each axis; edges are about one long.
const JITTER: f64 = 0.12;
/// Cosine of the angle from which on an edge of the shape counts as sharp.
const SHARP: f64 = 0.9;

/// A control mesh: a shape, and words that say what is done to it.
///
/// `box-1x2x3+jitter-3+top+dart`: the surface of a box of unit cubes, moved a little at random, with
/// a crease around its top and one that ends inside of the surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ControlShape {
    name: String,
    base: Base,
    words: Vec<Word>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Base {
    Box([u32; 3]),
    Slab(u32),
    Trapezohedron(u32),
    Patch(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    /// A cube on top, where four faces meet flat.
    Bump,
    /// Vertices moved at random, with this seed.
    Jitter(u64),
    /// All edges of the shape at which it bends are creases.
    Edges,
    /// The edges between vertices of valence three are creases.
    Rim,
    /// The edges around the faces at the top are creases.
    Top,
    /// Two edges in a line are a crease.
    Dart,
    /// Vertices of valence three without a crease are corners.
    Cusps,
}

impl ControlShape {
    /// Returns the mesh and the tags of its creases and corners.
    #[must_use]
    pub fn mesh(&self) -> (PolygonMesh, Vec<CreaseTag>) {
        let plain = self.plain();
        let tags = tags(&plain, &self.words);
        let seed = self.words.iter().find_map(|word| match word {
            Word::Jitter(seed) => Some(*seed),
            _ => None,
        });
        match seed {
            Some(seed) => (shapes::jittered(&plain, JITTER, seed), tags),
            None => (plain, tags),
        }
    }

    fn plain(&self) -> PolygonMesh {
        match self.base {
            Base::Box(size) if self.words.contains(&Word::Bump) => {
                let mut cubes = BTreeSet::new();
                for x in 0..size[0] as i32 {
                    for y in 0..size[1] as i32 {
                        cubes.extend((0..size[2] as i32).map(|z| [x, y, z]));
                    }
                }
                let middle = [size[0] / 2, size[1] / 2, size[2]];
                cubes.insert(middle.map(|n| n as i32));
                shapes::voxels(&cubes).unwrap_or_else(|_| shapes::box_surface(size))
            }
            Base::Box(size) => shapes::box_surface(size),
            Base::Slab(handles) => shapes::slab_with_holes(handles),
            Base::Trapezohedron(n) => shapes::trapezohedron(n),
            Base::Patch(n) => shapes::quad_patch(n),
        }
    }
}

/// Returns the tags that words ask for on a mesh that has not been moved yet.
fn tags(mesh: &PolygonMesh, words: &[Word]) -> Vec<CreaseTag> {
    let topology = mesh.topology();
    let position = |v: u32| mesh.positions()[v as usize];
    let normal = |face: u32| -> Vector3<f64> {
        let corners = topology.face_vertices(face);
        let p = |i: usize| position(corners[i]);
        (p(2) - p(0)).cross(&(p(3) - p(1))).normalize()
    };
    let top = mesh.bounding_box()[1].z;
    let on_top = |face: u32| {
        topology
            .face_vertices(face)
            .iter()
            .all(|&v| position(v).z == top)
    };
    let mut creased = vec![false; topology.edge_count()];
    for edge in 0..topology.edge_count() as u32 {
        let h = topology.edge_half_edge(edge);
        if topology.is_boundary_edge(edge) {
            continue;
        }
        let faces = [h, topology.twin(h)].map(|h| topology.face(h));
        let bends = normal(faces[0]).dot(&normal(faces[1])) < SHARP;
        creased[edge as usize] = (words.contains(&Word::Edges) && bends)
            || (words.contains(&Word::Rim)
                && topology
                    .edge_vertices(edge)
                    .iter()
                    .all(|&v| topology.valence(v) == 3))
            || (words.contains(&Word::Top) && on_top(faces[0]) != on_top(faces[1]));
    }
    if words.contains(&Word::Dart) {
        add_dart(mesh, &mut creased);
    }
    let edges = (0..topology.edge_count() as u32).filter(|&e| creased[e as usize]);
    let mut tags: Vec<CreaseTag> = edges
        .map(|edge| CreaseTag {
            vertices: topology.edge_vertices(edge),
            sharpness: INFINITELY_SHARP,
        })
        .collect();
    if words.contains(&Word::Cusps) {
        let corner = |v: &u32| {
            topology.valence(*v) == 3
                && topology
                    .spokes(*v)
                    .all(|h| !creased[topology.edge(h) as usize])
        };
        let corners = (0..topology.vertex_count() as u32).filter(corner);
        tags.extend(corners.map(|v| CreaseTag {
            vertices: [v, v],
            sharpness: INFINITELY_SHARP,
        }));
    }
    tags
}

/// Makes a crease of two edges in a line, away from the others.
fn add_dart(mesh: &PolygonMesh, creased: &mut [bool]) {
    let topology = mesh.topology();
    let away = |v: u32| {
        topology
            .spokes(v)
            .all(|h| !creased[topology.edge(h) as usize])
    };
    let inner = |v: u32| topology.valence(v) == 4 && !topology.is_boundary_vertex(v) && away(v);
    let middle = (0..topology.vertex_count() as u32).find(|&v| inner(v));
    for h in middle
        .into_iter()
        .flat_map(|v| topology.outgoing(v).step_by(2))
    {
        creased[topology.edge(h) as usize] = true;
    }
}

impl fmt::Display for ControlShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl From<ControlShape> for String {
    fn from(shape: ControlShape) -> Self {
        shape.name
    }
}

impl TryFrom<String> for ControlShape {
    type Error = UnknownShape;

    fn try_from(name: String) -> Result<Self, UnknownShape> {
        name.parse()
    }
}

/// No control mesh has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no control mesh `{name}`; give box-AxBxC, slab-N, trapezohedron-N or patch-N, and then, each after a +, any of bump (on a box), jitter-SEED, edges, rim, top, dart and cusps"
)]
pub struct UnknownShape {
    /// The name.
    pub name: String,
}

/// Largest size in a name: a box of a million faces.
const LARGEST: u32 = 400;

impl FromStr for ControlShape {
    type Err = UnknownShape;

    fn from_str(name: &str) -> Result<Self, UnknownShape> {
        let unknown = || UnknownShape {
            name: name.to_owned(),
        };
        let mut parts = name.split('+');
        let base = parts.next().and_then(base).ok_or_else(unknown)?;
        let words: Option<Vec<Word>> = parts.map(word).collect();
        let words = words.ok_or_else(unknown)?;
        if words.contains(&Word::Bump) && !matches!(base, Base::Box(_)) {
            return Err(unknown());
        }
        Ok(Self {
            name: name.to_owned(),
            base,
            words,
        })
    }
}

fn base(text: &str) -> Option<Base> {
    let (kind, sizes) = text.split_once('-')?;
    let sizes: Vec<u32> = sizes
        .split('x')
        .map(|n| n.parse().ok())
        .collect::<Option<_>>()?;
    let fits = |least: u32| sizes.iter().all(|n| (least..=LARGEST).contains(n));
    match (kind, sizes.as_slice()) {
        ("box", &[x, y, z]) if fits(1) => Some(Base::Box([x, y, z])),
        ("slab", &[n]) if fits(0) => Some(Base::Slab(n)),
        ("trapezohedron", &[n]) if fits(3) => Some(Base::Trapezohedron(n)),
        ("patch", &[n]) if fits(1) => Some(Base::Patch(n)),
        _ => None,
    }
}

fn word(text: &str) -> Option<Word> {
    match text {
        "bump" => Some(Word::Bump),
        "edges" => Some(Word::Edges),
        "rim" => Some(Word::Rim),
        "top" => Some(Word::Top),
        "dart" => Some(Word::Dart),
        "cusps" => Some(Word::Cusps),
        _ => text.strip_prefix("jitter-")?.parse().ok().map(Word::Jitter),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(name: &str) -> (PolygonMesh, Vec<CreaseTag>) {
        name.parse::<ControlShape>().expect(name).mesh()
    }

    #[test]
    fn stand_ins_have_the_charts_of_the_models_of_the_paper() {
        for (name, charts) in [
            ("box-1x2x3", 24),
            ("box-1x3x4", 40),
            ("box-2x2x4", 42),
            ("slab-2", 48),
            ("box-1x4x4", 50),
            ("box-3x3x3", 56),
            ("box-2x3x5", 64),
            ("box-2x2x8", 74),
            ("box-1x6x10+bump", 158),
            ("box-10x10x15", 802),
        ] {
            assert_eq!(shape(name).0.vertex_count(), charts, "{name}");
        }
    }

    #[test]
    fn words_tag_what_they_say() {
        assert_eq!(shape("box-1x2x3+edges").1.len(), 24);
        assert_eq!(shape("box-1x2x3+top").1.len(), 6);
        assert_eq!(shape("trapezohedron-10+rim").1.len(), 20);
        assert_eq!(shape("box-3x3x3+dart").1.len(), 2);
        let cusps = shape("box-2x2x2+cusps").1;
        assert_eq!(cusps.len(), 8);
        assert!(cusps.iter().all(|tag| tag.vertices[0] == tag.vertices[1]));
        assert!(shape("patch-3+edges").1.is_empty());
    }

    #[test]
    fn jitter_moves_vertices_alike_every_time() {
        let (one, two) = (shape("slab-1+jitter-7").0, shape("slab-1+jitter-7").0);
        assert_eq!(one.positions(), two.positions());
        assert_ne!(one.positions(), shape("slab-1").0.positions());
    }

    #[test]
    fn other_names_are_refused_with_what_there_is() {
        for name in [
            "",
            "box-1x2",
            "box-0x1x1",
            "slab-1+bump",
            "patch-3+sharp",
            "box-1x1x9999",
        ] {
            let error = name.parse::<ControlShape>().expect_err(name).to_string();
            assert!(error.contains("give box-AxBxC"), "{error}");
        }
    }
}
