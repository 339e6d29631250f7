//! glb: binary glTF 2.0, which browsers and modelling programs show.

use std::collections::BTreeMap;
use std::io::{self, Write};

use gltf_json as json;
use json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use json::buffer::{Buffer, Target, View};
use json::mesh::{Mesh, Mode, Primitive, Semantic};
use json::validation::{Checked, USize64};
use json::{Index, Root, Value};
use nalgebra::{Point3, Vector3};

use crate::output::{Surface, Wedges, WriteError};

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;
const ALIGNMENT: usize = 4;

/// A document ready to write: its JSON text and its numbers.
pub(crate) struct Document {
    text: Vec<u8>,
    numbers: Vec<u8>,
}

impl Document {
    /// Returns the document of a surface, in single precision, with its normals or else smooth ones, and
    /// with vertex colours where it has the attributes `red`, `green` and `blue`.
    ///
    /// Colours count from 0 to 1, or to 255 where one exceeds 1, and are taken as sRGB; glTF wants
    /// them linear. Where a vertex has corners of different texture coordinates it is split: its copies
    /// come after all vertices. glTF counts the second coordinate downwards.
    ///
    /// # Errors
    /// A coordinate does not fit into single precision, or the file would pass 4 GiB.
    pub(crate) fn build(surface: &Surface<'_>) -> Result<Self, WriteError> {
        let positions = single_precision(surface.positions)?;
        let normals = match surface.normals {
            Some(normals) => normals.iter().map(|normal| unit(*normal)).collect(),
            None => smooth_normals(&positions, surface.faces),
        };
        let texture = surface.corner_texture;
        let wedges = texture.map(|t| Wedges::build(positions.len(), surface.faces, t));
        let spread = |values: Vec<[f32; 3]>| match &wedges {
            Some(wedges) => wedges.vertex.iter().map(|&v| values[v]).collect(),
            None => values,
        };
        let mut content = Content::default();
        let corners: Vec<u8> = match &wedges {
            Some(wedges) => {
                let corners = wedges.faces.iter().flatten();
                corners.flat_map(|&v| (v as u32).to_le_bytes()).collect()
            }
            None => {
                let corners = surface.faces.iter().flatten();
                corners.flat_map(|vertex| vertex.to_le_bytes()).collect()
            }
        };
        let corner_kind = (ComponentType::U32, Type::Scalar);
        let corners = content.add(&corners, Target::ElementArrayBuffer, corner_kind);
        let mut attributes = BTreeMap::new();
        let positions = content.add_positions(&spread(positions));
        attributes.insert(Semantic::Positions, positions);
        let normals = content.add_vectors(&spread(normals));
        attributes.insert(Semantic::Normals, normals);
        if let Some(colours) = linear_colours(surface) {
            let colours = content.add_vectors(&spread(colours));
            attributes.insert(Semantic::Colors(0), colours);
        }
        if let Some(wedges) = &wedges {
            let texture = content.add_texture(&wedges.texture);
            attributes.insert(Semantic::TexCoords(0), texture);
        }
        content.finish(attributes, corners)
    }

    /// Writes the document.
    pub(crate) fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        to.write_all(b"glTF")?;
        to.write_all(&2u32.to_le_bytes())?;
        to.write_all(&(self.length() as u32).to_le_bytes())?;
        for (kind, chunk) in [(b"JSON", &self.text), (b"BIN\0", &self.numbers)] {
            to.write_all(&(chunk.len() as u32).to_le_bytes())?;
            to.write_all(kind)?;
            to.write_all(chunk)?;
        }
        Ok(())
    }

    fn length(&self) -> usize {
        HEADER_BYTES + 2 * CHUNK_HEADER_BYTES + self.text.len() + self.numbers.len()
    }
}

/// A document in the making. Each array has a buffer view and an accessor of its own.
#[derive(Default)]
struct Content {
    root: Root,
    numbers: Vec<u8>,
}

impl Content {
    fn add(
        &mut self,
        bytes: &[u8],
        target: Target,
        kind: (ComponentType, Type),
    ) -> Index<Accessor> {
        let element = kind.0.size() * kind.1.multiplicity();
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.numbers.len())),
            byte_stride: None,
            name: None,
            target: Some(Checked::Valid(target)),
            extensions: None,
            extras: Default::default(),
        });
        self.numbers.extend_from_slice(bytes);
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(bytes.len() / element),
            component_type: Checked::Valid(GenericComponentType(kind.0)),
            extensions: None,
            extras: Default::default(),
            type_: Checked::Valid(kind.1),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    fn add_vectors(&mut self, vectors: &[[f32; 3]]) -> Index<Accessor> {
        let bytes: Vec<u8> = vectors
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        self.add(
            &bytes,
            Target::ArrayBuffer,
            (ComponentType::F32, Type::Vec3),
        )
    }

    fn add_texture(&mut self, texture: &[[f64; 2]]) -> Index<Accessor> {
        let downwards = texture
            .iter()
            .flat_map(|&[u, v]| [u as f32, (1.0 - v) as f32]);
        let bytes: Vec<u8> = downwards.flat_map(f32::to_le_bytes).collect();
        let kind = (ComponentType::F32, Type::Vec2);
        self.add(&bytes, Target::ArrayBuffer, kind)
    }

    fn add_positions(&mut self, positions: &[[f32; 3]]) -> Index<Accessor> {
        let index = self.add_vectors(positions);
        let extreme = |pick: fn(f32, f32) -> f32| {
            let fold = |axis: usize| positions.iter().map(|p| p[axis]).reduce(pick);
            Some(Value::from(
                [0, 1, 2]
                    .map(|axis| fold(axis).unwrap_or_default())
                    .to_vec(),
            ))
        };
        let accessor = &mut self.root.accessors[index.value()];
        (accessor.min, accessor.max) = (extreme(f32::min), extreme(f32::max));
        index
    }

    fn finish(
        mut self,
        attributes: BTreeMap<Semantic, Index<Accessor>>,
        corners: Index<Accessor>,
    ) -> Result<Document, WriteError> {
        let numbers = self.numbers;
        self.root.asset.generator = Some("Manifold Splines".to_owned());
        self.root.push(Buffer {
            byte_length: USize64::from(numbers.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let material = self.root.push(matte());
        let attributes = attributes
            .into_iter()
            .map(|(name, at)| (Checked::Valid(name), at));
        let mesh = self.root.push(Mesh {
            extensions: None,
            extras: Default::default(),
            name: None,
            weights: None,
            primitives: vec![Primitive {
                attributes: attributes.collect(),
                extensions: None,
                extras: Default::default(),
                indices: Some(corners),
                material: Some(material),
                mode: Checked::Valid(Mode::Triangles),
                targets: None,
            }],
        });
        let node = self.root.push(json::Node {
            mesh: Some(mesh),
            ..Default::default()
        });
        let scene = json::Scene {
            extensions: None,
            extras: Default::default(),
            name: None,
            nodes: vec![node],
        };
        self.root.scene = Some(self.root.push(scene));
        let mut text = self
            .root
            .to_vec()
            .map_err(|error| WriteError::Json(error.to_string()))?;
        text.resize(text.len().next_multiple_of(ALIGNMENT), b' ');
        let document = Document { text, numbers };
        match u32::try_from(document.length()) {
            Ok(_) => Ok(document),
            Err(_) => Err(WriteError::TooLarge {
                bytes: document.length(),
            }),
        }
    }
}

/// Returns a material that shows the shape and the vertex colours from both sides.
fn matte() -> json::Material {
    let mut material = json::Material {
        double_sided: true,
        ..Default::default()
    };
    material.pbr_metallic_roughness.metallic_factor = json::material::StrengthFactor(0.0);
    material
}

fn single_precision(positions: &[Point3<f64>]) -> Result<Vec<[f32; 3]>, WriteError> {
    let single: Vec<_> = positions
        .iter()
        .map(|p| [p.x as f32, p.y as f32, p.z as f32])
        .collect();
    match single.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        Some(vertex) => Err(WriteError::NotFinite {
            name: "position".to_owned(),
            vertex,
        }),
        None => Ok(single),
    }
}

/// Returns unit normals at the vertices: the mean over the faces around, weighted by area.
fn smooth_normals(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let point = |vertex: u32| Vector3::from(positions[vertex as usize].map(f64::from));
    let mut sums = vec![Vector3::zeros(); positions.len()];
    for &[a, b, c] in faces {
        let normal = (point(b) - point(a)).cross(&(point(c) - point(a)));
        for vertex in [a, b, c] {
            sums[vertex as usize] += normal;
        }
    }
    sums.into_iter().map(unit).collect()
}

/// Returns a vector of length 1.
fn unit(vector: Vector3<f64>) -> [f32; 3] {
    // Divided first, so that no square overflows or vanishes. Where faces have no area or cancel out
    // there is no normal, but the format wants one.
    let scaled = vector / vector.amax();
    let unit = scaled.try_normalize(0.0).unwrap_or(Vector3::z());
    unit.map(|x| x as f32).into()
}

fn linear_colours(surface: &Surface<'_>) -> Option<Vec<[f32; 3]>> {
    let channel = |name: &str| {
        surface
            .attributes
            .iter()
            .find(|attribute| attribute.name == name)
    };
    let channels = [channel("red")?, channel("green")?, channel("blue")?];
    let in_bytes = channels
        .iter()
        .any(|channel| channel.values.iter().any(|&value| value > 1.0));
    let scale = if in_bytes { 255.0 } else { 1.0 };
    let colour = |vertex: usize| channels.map(|c| linear(c.values[vertex] / scale) as f32);
    Some((0..surface.positions.len()).map(colour).collect())
}

/// Returns the linear intensity of an sRGB value (IEC 61966-2-1).
fn linear(value: f64) -> f64 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}
