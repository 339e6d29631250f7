//! VTU: VTK's XML file of an unstructured grid.
//!
//! Each array is the base64 text of one stream: its length in bytes as a 64-bit number, then its
//! numbers, least significant byte first. Doubles so survive exactly.

use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::output::Surface;

/// VTK's number for a cell that is a triangle.
const VTK_TRIANGLE: u8 = 5;

/// Writes a surface as triangle cells, its attributes as point data.
pub(crate) fn write(surface: &Surface<'_>, to: &mut dyn Write) -> io::Result<()> {
    let mut xml = Writer::new_with_indent(to, b' ', 1);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("VTKFile")
        .with_attributes([("type", "UnstructuredGrid"), ("version", "1.0")])
        .with_attributes([("byte_order", "LittleEndian"), ("header_type", "UInt64")])
        .write_inner_content(|xml| {
            xml.create_element("UnstructuredGrid")
                .write_inner_content(|xml| write_piece(surface, xml))?;
            Ok(())
        })?;
    xml.get_mut().write_all(b"\n")
}

fn write_piece<W: Write>(surface: &Surface<'_>, xml: &mut Writer<W>) -> io::Result<()> {
    xml.create_element("Piece")
        .with_attribute((
            "NumberOfPoints",
            surface.positions.len().to_string().as_str(),
        ))
        .with_attribute(("NumberOfCells", surface.faces.len().to_string().as_str()))
        .write_inner_content(|xml| {
            write_points(surface, xml)?;
            write_cells(surface, xml)
        })?;
    Ok(())
}

fn write_points<W: Write>(surface: &Surface<'_>, xml: &mut Writer<W>) -> io::Result<()> {
    xml.create_element("PointData").write_inner_content(|xml| {
        for attribute in surface.attributes {
            let numbers = attribute.values.iter().map(|value| value.to_le_bytes());
            write_array(xml, &attribute.name, "Float64", 1, numbers)?;
        }
        Ok(())
    })?;
    xml.create_element("Points").write_inner_content(|xml| {
        let numbers = surface.positions.iter().flat_map(|p| [p.x, p.y, p.z]);
        write_array(xml, "Points", "Float64", 3, numbers.map(f64::to_le_bytes))
    })?;
    Ok(())
}

fn write_cells<W: Write>(surface: &Surface<'_>, xml: &mut Writer<W>) -> io::Result<()> {
    xml.create_element("Cells").write_inner_content(|xml| {
        let corners = surface
            .faces
            .iter()
            .flatten()
            .map(|&vertex| i64::from(vertex));
        write_array(
            xml,
            "connectivity",
            "Int64",
            1,
            corners.map(i64::to_le_bytes),
        )?;
        let ends = (1..=surface.faces.len() as i64).map(|face| 3 * face);
        write_array(xml, "offsets", "Int64", 1, ends.map(i64::to_le_bytes))?;
        let kinds = surface.faces.iter().map(|_| [VTK_TRIANGLE]);
        write_array(xml, "types", "UInt8", 1, kinds)
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
