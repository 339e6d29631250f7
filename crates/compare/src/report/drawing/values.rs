//! What the surface of a panel is painted with: numbers, colours or cells, vertex by vertex.

use std::collections::BTreeMap;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_picture::{Rgb, category_colours, edges};

use super::camera::camera;
use super::fitted::colours;
use super::source::Source;
use crate::experiment::{FieldColours, Panel, Show};
use crate::run::CHECKERS;

/// Names of the attributes that are colours.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];
/// The channel of a colour whose channels count in bytes.
const FULL_BYTE: f64 = 255.0;

/// What a panel shows of a row.
pub(super) struct Subject<'a> {
    pub(super) source: &'a Source,
    pub(super) values: Values,
}

/// What a surface is painted with.
pub(super) enum Values {
    /// Nothing.
    Bare,
    /// Numbers, by a scale.
    Scalars { values: Vec<f64>, measure: Measure },
    /// Colours.
    Colours(Vec<Rgb>),
    /// A checkerboard, by the texture coordinates of the corners of each face.
    Checkers(Vec<[[f64; 2]; 3]>),
    /// Colours of the cell of each vertex, and the faces cut along their borders.
    Cells {
        colours: Vec<Rgb>,
        split: SplitFaces,
    },
}

/// What numbers measure: those that measure the same are painted by the same scale.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Measure {
    /// Errors in percent of the diagonal.
    Error,
    /// Errors of colours in percent of the range of a channel.
    ColourError,
    /// A field by its name.
    Field {
        name: String,
        colours: FieldColours,
        /// Share of the vertices whose numbers the scale spans.
        span: f64,
    },
}

/// A mesh whose every face lies in one cell.
pub(super) struct SplitFaces {
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) faces: Vec<[u32; 3]>,
    /// Colour of each face.
    pub(super) colours: Vec<Rgb>,
}

impl<'a> Subject<'a> {
    /// Returns what `panel` shows of the row of `source`, or says why it cannot.
    pub(super) fn of(panel: &Panel, source: &'a Source) -> Result<Self, String> {
        let fitted = || source.fitted.as_ref().map_err(Clone::clone);
        let of_data = |index: usize| {
            let colours = fitted()?.colours.as_ref();
            Ok(colours.map_or(Values::Bare, |both| Values::Colours(both[index].clone())))
        };
        let values = match panel.show {
            // Charts and solids have no data at vertices, and nothing to colour.
            Show::Input | Show::Spline if source.lines().is_some() => Ok(Values::Bare),
            Show::Input => of_data(0),
            Show::Spline => of_data(1),
            Show::Error => fitted().map(|fitted| Values::Scalars {
                values: fitted.errors.iter().map(|error| 100.0 * error).collect(),
                measure: if fitted.colours.is_some() {
                    Measure::ColourError
                } else {
                    Measure::Error
                },
            }),
            Show::Knots
            | Show::Target
            | Show::ControlTriangles
            | Show::Refinement
            | Show::Charts
            | Show::ControlPoints
            | Show::Level => Ok(Values::Bare),
            Show::Cylinders | Show::Rectangles => {
                Ok(Values::Colours(source.of_t_spline(panel)?.colours()))
            }
            Show::Isophotes => isophotes(panel, source),
            Show::Field => field(panel, source),
            Show::Checkers => Ok(Values::Checkers(source.texture()?.to_vec())),
        };
        Ok(Self {
            source,
            values: values?,
        })
    }
}

/// Stripes of equal slope from the lowest to the highest.
const ISOPHOTES: f64 = 96.0;

/// Returns the texture of stripes across the angle between the normals and what is up in the picture.
fn isophotes(panel: &Panel, source: &Source) -> Result<Values, String> {
    let missing = "only Powell-Sabin splines have exact normals; show the spline instead";
    let normals = source.normals().ok_or_else(|| missing.to_owned())?;
    let up = camera(panel, source)?.up();
    let angle = |v: u32| normals[v as usize].dot(&up).clamp(-1.0, 1.0).acos();
    let unit = ISOPHOTES / CHECKERS / std::f64::consts::PI;
    // Half a square along the other coordinate is one stripe.
    let corner = |v: u32| [unit * angle(v), 0.5 / CHECKERS];
    let faces = source.spline.faces().iter();
    Ok(Values::Checkers(
        faces.map(|face| face.map(corner)).collect(),
    ))
}

fn field(panel: &Panel, source: &Source) -> Result<Values, String> {
    let name = panel.field.as_deref().unwrap_or_default();
    let on = panel.on.unwrap_or_default();
    match panel.field_colours() {
        how @ (FieldColours::Sequential | FieldColours::Diverging) => {
            let values = source.attribute(on, name)?.to_vec();
            let measure = Measure::Field {
                name: name.to_owned(),
                colours: how,
                span: panel.span.unwrap_or(1.0),
            };
            Ok(Values::Scalars { values, measure })
        }
        FieldColours::Cells => cells(name, source.attribute(on, name)?, source.shown(on)?.0),
        FieldColours::Values => {
            let channels = CHANNELS.map(|channel| source.attribute(on, channel));
            let [red, green, blue] = channels;
            let (red, green, blue) = (red?, green?, blue?);
            let mut values: Vec<f64> = (0..red.len())
                .flat_map(|vertex| [red[vertex], green[vertex], blue[vertex]])
                .collect();
            // Channels count from 0 to 1, or to 255 where one exceeds 1.
            if values.iter().any(|&value| value > 1.0) {
                values.iter_mut().for_each(|value| *value /= FULL_BYTE);
            }
            Ok(Values::Colours(colours(&values)))
        }
    }
}

/// Returns the colours of the cells that the numbers at the vertices of `mesh` name.
fn cells(name: &str, values: &[f64], mesh: &TriangleMesh) -> Result<Values, String> {
    if let Some(vertex) = values.iter().position(|value| value.fract() != 0.0) {
        let value = values[vertex];
        return Err(format!(
            "its `{name}` is {value} at vertex {vertex}; cells are whole numbers"
        ));
    }
    let mut numbers: Vec<i64> = values.iter().map(|&value| value as i64).collect();
    let of_vertex = numbers.clone();
    numbers.retain(|&number| number >= 0);
    numbers.sort_unstable();
    numbers.dedup();
    let places: Vec<Option<u32>> = of_vertex
        .iter()
        .map(|number| numbers.binary_search(number).ok().map(|at| at as u32))
        .collect();
    let touching: Vec<[u32; 2]> = edges(mesh.faces())
        .into_iter()
        .filter_map(|[a, b]| Some([places[a as usize]?, places[b as usize]?]))
        .filter(|[a, b]| a != b)
        .collect();
    let palette = category_colours(numbers.len(), &touching);
    let colour = |place: &Option<u32>| place.map_or(Rgb::GREY, |at| palette[at as usize]);
    let colours: Vec<Rgb> = places.iter().map(colour).collect();
    let split = split(mesh, &of_vertex, &colours);
    Ok(Values::Cells { colours, split })
}

/// Cuts the faces of a mesh that lie in several cells, so that borders run across the middles of
/// edges and through those of faces.
fn split(mesh: &TriangleMesh, cells: &[i64], colours: &[Rgb]) -> SplitFaces {
    let mut whole = SplitFaces {
        positions: mesh.positions().to_vec(),
        faces: Vec::with_capacity(mesh.face_count()),
        colours: Vec::with_capacity(mesh.face_count()),
    };
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for &face in mesh.faces() {
        let [a, b, c] = face.map(|vertex| cells[vertex as usize]);
        if a == b && b == c {
            whole.add(face, colours[face[0] as usize]);
            continue;
        }
        let centre = whole.middle(&face);
        for side in 0..3 {
            let (from, to) = (face[side], face[(side + 1) % 3]);
            let colour = colours[from as usize];
            if cells[from as usize] == cells[to as usize] {
                whole.add([from, to, centre], colour);
                continue;
            }
            // Both faces at an edge cut it at the same vertex.
            let middle = *middles
                .entry([from.min(to), from.max(to)])
                .or_insert_with(|| whole.middle(&[from, to]));
            whole.add([from, middle, centre], colour);
            whole.add([middle, to, centre], colours[to as usize]);
        }
    }
    whole
}

impl SplitFaces {
    fn add(&mut self, face: [u32; 3], colour: Rgb) {
        self.faces.push(face);
        self.colours.push(colour);
    }

    /// Adds the mean of some vertices.
    fn middle(&mut self, vertices: &[u32]) -> u32 {
        let coords = vertices.iter().map(|&v| self.positions[v as usize].coords);
        let mean = coords.sum::<msplines_common::Vector3<f64>>() / vertices.len() as f64;
        self.positions.push(Point3::from(mean));
        self.positions.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use msplines_common::mesh::shapes;

    fn ball() -> TriangleMesh {
        shapes::sphere(300)
    }

    /// Numbers a vertex by the octant it lies in, 10 apart.
    fn octants(mesh: &TriangleMesh) -> Vec<f64> {
        let octant = |p: &Point3<f64>| {
            let bits = [p.x > 0.0, p.y > 0.0, p.z > 0.0].map(f64::from);
            10.0 * (bits[0] + 2.0 * bits[1] + 4.0 * bits[2])
        };
        mesh.positions().iter().map(octant).collect()
    }

    fn area(positions: &[Point3<f64>], faces: &[[u32; 3]]) -> f64 {
        let area = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| positions[v as usize]);
            (b - a).cross(&(c - a)).norm() / 2.0
        };
        faces.iter().map(area).sum()
    }

    #[test]
    fn cells_that_touch_differ_and_their_faces_cover_the_mesh() {
        let mesh = ball();
        let numbers = octants(&mesh);
        let Ok(Values::Cells { colours, split }) = cells("c", &numbers, &mesh) else {
            panic!("no cells");
        };
        for [a, b] in edges(mesh.faces()) {
            let (a, b) = (a as usize, b as usize);
            assert_eq!(numbers[a] == numbers[b], colours[a] == colours[b]);
        }
        assert_eq!(split.faces.len(), split.colours.len());
        let (ours, whole) = (
            area(&split.positions, &split.faces),
            area(mesh.positions(), mesh.faces()),
        );
        // Rounding of some hundred sums.
        assert!((ours / whole - 1.0).abs() < 1e-12, "{ours} {whole}");
        // Still closed, so that no crack opens at a border.
        TriangleMesh::build(split.positions, split.faces).expect("a manifold");
    }

    #[test]
    fn what_is_negative_is_in_no_cell_and_fractions_are_refused() {
        let mesh = ball();
        let mut numbers = vec![3.0; mesh.vertex_count()];
        numbers[5] = -1.0;
        let Ok(Values::Cells { colours, .. }) = cells("c", &numbers, &mesh) else {
            panic!("no cells");
        };
        assert_eq!(colours[5], Rgb::GREY);
        assert_ne!(colours[4], Rgb::GREY);
        for odd in [0.5, f64::NAN, f64::INFINITY] {
            numbers[7] = odd;
            let Err(text) = cells("c", &numbers, &mesh) else {
                panic!("{odd} is a cell");
            };
            assert!(text.contains(&format!("is {odd} at vertex 7")), "{text}");
        }
    }
}
