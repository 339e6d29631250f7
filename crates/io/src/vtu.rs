//! VTU: VTK's XML file of an unstructured grid.
//!
//! Each array is the base64 text of one stream: its length in bytes as a 64-bit number, then its
//! numbers, least significant byte first. Doubles so survive exactly.

use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use msplines_common::bspline::{BezierCells, CellShape};
use nalgebra::Point3;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::output::Surface;
use crate::volume::{Field, Volume, VolumeCells};

/// VTK's number for a cell that is a triangle.
const VTK_TRIANGLE: u8 = 5;
/// VTK's number for a cell that is a tetrahedron.
const VTK_TETRAHEDRON: u8 = 10;
/// VTK's number for a cell that is a hexahedron.
const VTK_HEXAHEDRON: u8 = 12;
/// VTK's number for a cell that is a Bézier triangle.
const VTK_BEZIER_TRIANGLE: u8 = 76;
/// VTK's number for a cell that is a Bézier quadrangle.
const VTK_BEZIER_QUADRILATERAL: u8 = 77;
/// VTK's number for a cell that is a Bézier hexahedron.
const VTK_BEZIER_HEXAHEDRON: u8 = 79;
/// What VTK looks for by a role and not by its name, which here are the same, with its components.
const ROLES: [(&str, usize); 3] = [
    (NORMALS, 3),
    ("RationalWeights", 1),
    ("HigherOrderDegrees", 3),
];
const NORMALS: &str = "Normals";
/// Version of the format that all readers take.
const VERSION: &str = "1.0";
/// The version since which upright edges of cells of higher degree run around like their corners.
const HIGHER_DEGREE_VERSION: &str = "2.2";

/// Cells of one kind, whose vertices stand one cell after another.
struct Cells<'a> {
    /// Numbers of cells, and of vertices of each of them.
    runs: &'a [(usize, usize)],
    kind: u8,
    /// Returns the vertex at a place among those of all cells.
    vertex: &'a dyn Fn(usize) -> usize,
}

impl Cells<'_> {
    fn count(&self) -> usize {
        self.runs.iter().map(|&(cells, _)| cells).sum()
    }

    /// Returns the number of vertices of each cell.
    fn corners(&self) -> impl Iterator<Item = usize> + '_ {
        let runs = self.runs.iter();
        runs.flat_map(|&(cells, corners)| std::iter::repeat_n(corners, cells))
    }
}

/// Data of vertices or cells: name, components, values.
type Data<'a> = (&'a str, usize, &'a [f64]);

/// Writes a surface as triangle cells, its normals and attributes as point data.
pub(crate) fn write(surface: &Surface<'_>, to: &mut dyn Write) -> io::Result<()> {
    let cells = Cells {
        runs: &[(surface.faces.len(), 3)],
        kind: VTK_TRIANGLE,
        vertex: &|place| surface.faces[place / 3][place % 3] as usize,
    };
    let normals = surface.normals.map(|normals| {
        let numbers = normals.iter().flat_map(|n| [n.x, n.y, n.z]);
        numbers.collect::<Vec<f64>>()
    });
    let normals = normals.as_deref().map(|values| (NORMALS, 3, values));
    let attributes = surface.attributes.iter();
    let attributes =
        attributes.map(|attribute| (attribute.name.as_str(), 1, attribute.values.as_slice()));
    let data: Vec<Data<'_>> = normals.into_iter().chain(attributes).collect();
    write_grid(surface.positions, &cells, &data, &[], to)
}

/// Writes a solid as cells, with its data.
pub(crate) fn write_volume(volume: &Volume<'_>, to: &mut dyn Write) -> io::Result<()> {
    let cells = Cells {
        runs: &[(volume.cells.count(), volume.cells.corners())],
        vertex: &|place| volume.cells.vertices()[place] as usize,
        kind: match volume.cells {
            VolumeCells::Tetrahedra(_) => VTK_TETRAHEDRON,
            VolumeCells::Hexahedra(_) => VTK_HEXAHEDRON,
            VolumeCells::BezierHexahedra { .. } => VTK_BEZIER_HEXAHEDRON,
        },
    };
    let point_data: Vec<Data<'_>> = volume.point_data.iter().map(as_data).collect();
    let cell_data: Vec<Data<'_>> = volume.cell_data.iter().map(as_data).collect();
    write_grid(volume.positions, &cells, &point_data, &cell_data, to)
}

/// Writes Bézier cells with their data; the points are the control points in the order of the cells.
pub(crate) fn write_bezier(
    cells: &BezierCells,
    point_data: &[Field<'_>],
    cell_data: &[Field<'_>],
    to: &mut dyn Write,
) -> io::Result<()> {
    let shape = cells.shape();
    let (mut runs, mut vertices) = (Vec::new(), Vec::with_capacity(cells.points().len()));
    for run in cells.runs() {
        let order = shape.vtk_order(run.degree);
        for _ in 0..run.cells {
            let first = vertices.len();
            vertices.extend(order.iter().map(|place| first + place));
        }
        runs.push((run.cells, order.len()));
    }
    let grid = Cells {
        runs: &runs,
        kind: match shape {
            CellShape::Triangles => VTK_BEZIER_TRIANGLE,
            CellShape::Quads => VTK_BEZIER_QUADRILATERAL,
            CellShape::Hexahedra => VTK_BEZIER_HEXAHEDRON,
        },
        vertex: &|place| vertices[place],
    };
    let point_data: Vec<Data<'_>> = point_data.iter().map(as_data).collect();
    let cell_data: Vec<Data<'_>> = cell_data.iter().map(as_data).collect();
    write_grid(cells.points(), &grid, &point_data, &cell_data, to)
}

fn as_data<'a>(field: &Field<'a>) -> Data<'a> {
    (field.name, field.components, field.values)
}

fn write_grid(
    positions: &[Point3<f64>],
    cells: &Cells<'_>,
    point_data: &[Data<'_>],
    cell_data: &[Data<'_>],
    to: &mut dyn Write,
) -> io::Result<()> {
    let (points, count) = (positions.len(), cells.count());
    let version = match cells.kind {
        VTK_BEZIER_TRIANGLE | VTK_BEZIER_QUADRILATERAL | VTK_BEZIER_HEXAHEDRON => {
            HIGHER_DEGREE_VERSION
        }
        _ => VERSION,
    };
    let mut xml = Writer::new_with_indent(to, b' ', 1);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("VTKFile")
        .with_attributes([("type", "UnstructuredGrid"), ("version", version)])
        .with_attributes([("byte_order", "LittleEndian"), ("header_type", "UInt64")])
        .write_inner_content(|xml| {
            xml.create_element("UnstructuredGrid")
                .write_inner_content(|xml| {
                    xml.create_element("Piece")
                        .with_attribute(("NumberOfPoints", points.to_string().as_str()))
                        .with_attribute(("NumberOfCells", count.to_string().as_str()))
                        .write_inner_content(|xml| {
                            write_data("PointData", point_data, xml)?;
                            if !cell_data.is_empty() {
                                write_data("CellData", cell_data, xml)?;
                            }
                            write_points(positions, xml)?;
                            write_cells(cells, xml)
                        })?;
                    Ok(())
                })?;
            Ok(())
        })?;
    xml.get_mut().write_all(b"\n")
}

fn write_data<W: Write>(name: &str, data: &[Data<'_>], xml: &mut Writer<W>) -> io::Result<()> {
    let has = |role: &(&str, usize)| data.iter().any(|&(name, n, _)| (name, n) == *role);
    let roles = ROLES.into_iter().filter(has).map(|(role, _)| (role, role));
    let element = xml.create_element(name).with_attributes(roles);
    element.write_inner_content(|xml| {
        for &(name, components, values) in data {
            let numbers = values.iter().map(|value| value.to_le_bytes());
            write_array(xml, name, "Float64", components, numbers)?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_points<W: Write>(positions: &[Point3<f64>], xml: &mut Writer<W>) -> io::Result<()> {
    xml.create_element("Points").write_inner_content(|xml| {
        let numbers = positions.iter().flat_map(|p| [p.x, p.y, p.z]);
        write_array(xml, "Points", "Float64", 3, numbers.map(f64::to_le_bytes))
    })?;
    Ok(())
}

fn write_cells<W: Write>(cells: &Cells<'_>, xml: &mut Writer<W>) -> io::Result<()> {
    xml.create_element("Cells").write_inner_content(|xml| {
        let places = 0..cells.corners().sum();
        let vertices = places.map(|place| (cells.vertex)(place) as i64);
        write_array(
            xml,
            "connectivity",
            "Int64",
            1,
            vertices.map(i64::to_le_bytes),
        )?;
        let ends = cells.corners().scan(0, |end, corners| {
            *end += corners as i64;
            Some(*end)
        });
        write_array(xml, "offsets", "Int64", 1, ends.map(i64::to_le_bytes))?;
        write_array(
            xml,
            "types",
            "UInt8",
            1,
            (0..cells.count()).map(|_| [cells.kind]),
        )
    })?;
    Ok(())
}

fn write_array<W: Write, const N: usize>(
    xml: &mut Writer<W>,
    name: &str,
    kind: &str,
    components: usize,
    numbers: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    const LENGTH_BYTES: usize = 8;
    let mut stream = vec![0; LENGTH_BYTES];
    numbers.for_each(|number| stream.extend_from_slice(&number));
    let length = (stream.len() - LENGTH_BYTES) as u64;
    stream[..LENGTH_BYTES].copy_from_slice(&length.to_le_bytes());
    let mut array = xml.create_element("DataArray").with_attributes([
        ("type", kind),
        ("Name", name),
        ("format", "binary"),
    ]);
    // An array of one component is a scalar, and some readers shape it otherwise if told so.
    if components > 1 {
        array = array.with_attribute(("NumberOfComponents", components.to_string().as_str()));
    }
    array.write_text_content(BytesText::new(&STANDARD.encode(&stream)))?;
    Ok(())
}
