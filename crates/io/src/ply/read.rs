//! From a PLY body to a soup.

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use nalgebra::Point3;

use super::header::{self, Element, Encoding, Kind, Property, Scalar};
use super::values::{Ascii, Binary, Values};
use crate::error::{Fault, Place};

/// Ends a strip; the next index starts another one.
const RESTART: i64 = -1;

/// Returns the soup of a PLY file.
///
/// Scalar vertex properties other than `x`, `y`, `z` become attributes. A strip `a b c d` gives the
/// triangles `a b c` and `c b d`: every second one is turned, so that all face the same side. A
/// triangle with a repeated index only steers the strip and is no face.
pub(crate) fn parse(bytes: &[u8]) -> Result<PolygonSoup, Fault> {
    let header = header::parse(bytes)?;
    if !header
        .elements
        .iter()
        .any(|element| element.name == "vertex")
    {
        let problem = "the header has no element `vertex`";
        return Err(Fault::malformed(Place::Line(header.lines), problem));
    }
    let body_start = bytes.len() - header.body.len();
    let elements = &header.elements;
    match header.encoding {
        Encoding::Ascii => read_body(Ascii::new(header.body, header.lines), elements),
        Encoding::LittleEndian => {
            read_body(Binary::<false>::new(header.body, body_start), elements)
        }
        Encoding::BigEndian => read_body(Binary::<true>::new(header.body, body_start), elements),
    }
}

fn read_body(mut values: impl Values, elements: &[Element]) -> Result<PolygonSoup, Fault> {
    let mut soup = PolygonSoup {
        face_offsets: vec![0],
        ..PolygonSoup::default()
    };
    for element in elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut values, element, &mut soup)?,
            "face" => read_faces(&mut values, element, &mut soup)?,
            "tristrips" => read_strips(&mut values, element, &mut soup)?,
            _ => skip_element(&mut values, element)?,
        }
    }
    Ok(soup)
}

/// Where a vertex property goes.
enum Target {
    Coordinate(usize, Scalar),
    Attribute(usize, Scalar),
    Skip(Kind),
}

fn read_vertices(
    values: &mut impl Values,
    element: &Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    let count = values.record_count(element)?;
    let targets = vertex_targets(element, soup, values.place())?;
    soup.positions.reserve_exact(count);
    for attribute in &mut soup.attributes {
        attribute.values.reserve_exact(count);
    }
    for index in 0..count {
        let record = read_vertex(values, &targets, soup);
        record.map_err(|fault| fault.in_element("vertex", index as u64))?;
    }
    Ok(())
}

fn vertex_targets(
    element: &Element,
    soup: &mut PolygonSoup,
    place: Place,
) -> Result<Vec<Target>, Fault> {
    let mut targets = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        targets.push(match (property.kind, property.name.as_str()) {
            (Kind::One(scalar), "x") => Target::Coordinate(0, scalar),
            (Kind::One(scalar), "y") => Target::Coordinate(1, scalar),
            (Kind::One(scalar), "z") => Target::Coordinate(2, scalar),
            (Kind::One(scalar), name) => {
                let name = name.to_owned();
                soup.attributes.push(VertexAttribute {
                    name,
                    values: Vec::new(),
                });
                Target::Attribute(soup.attributes.len() - 1, scalar)
            }
            (list, _) => Target::Skip(list),
        });
    }
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if !targets
            .iter()
            .any(|t| matches!(t, Target::Coordinate(a, _) if *a == axis))
        {
            let problem = format!("element `vertex` has no property `{name}`");
            return Err(Fault::malformed(place, problem));
        }
    }
    Ok(targets)
}

fn read_vertex(
    values: &mut impl Values,
    targets: &[Target],
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    let mut position = Point3::origin();
    for target in targets {
        match *target {
            Target::Coordinate(axis, scalar) => position[axis] = values.real(scalar)?,
            Target::Attribute(attribute, scalar) => {
                let value = values.real(scalar)?;
                soup.attributes[attribute].values.push(value);
            }
            Target::Skip(kind) => skip(values, kind)?,
        }
    }
    soup.positions.push(position);
    Ok(())
}

fn read_faces(
    values: &mut impl Values,
    element: &Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    let count = values.record_count(element)?;
    if count == 0 {
        return Ok(());
    }
    let indices = index_list(element, values.place())?;
    soup.face_offsets.reserve_exact(count);
    for face in 0..count {
        for (i, property) in element.properties.iter().enumerate() {
            let read = if i == indices {
                read_indices(values, property.kind, &mut soup.face_vertices)
            } else {
                skip(values, property.kind)
            };
            read.map_err(|fault| fault.in_element("face", face as u64))?;
        }
        soup.face_offsets.push(soup.face_vertices.len());
    }
    Ok(())
}

fn read_strips(
    values: &mut impl Values,
    element: &Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    let count = values.record_count(element)?;
    if count == 0 {
        return Ok(());
    }
    let indices = index_list(element, values.place())?;
    let mut strip = Vec::new();
    for index in 0..count {
        for (i, property) in element.properties.iter().enumerate() {
            let read = if i == indices {
                strip.clear();
                read_indices(values, property.kind, &mut strip)
            } else {
                skip(values, property.kind)
            };
            read.map_err(|fault| fault.in_element("tristrips", index as u64))?;
        }
        for run in strip.split(|&vertex| vertex == RESTART) {
            push_strip(run, soup);
        }
    }
    Ok(())
}

fn push_strip(strip: &[i64], soup: &mut PolygonSoup) {
    for (i, window) in strip.windows(3).enumerate() {
        let [a, b, c] = [window[0], window[1], window[2]];
        if a == b || b == c || c == a {
            continue;
        }
        soup.push_face(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
    }
}

/// Returns which property of an element lists vertex indices.
fn index_list(element: &Element, place: Place) -> Result<usize, Fault> {
    let lists_indices = |property: &Property| {
        matches!(property.kind, Kind::List { .. })
            && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    };
    element
        .properties
        .iter()
        .position(lists_indices)
        .ok_or_else(|| {
            let problem = format!("element `{}` has no list `vertex_indices`", element.name);
            Fault::malformed(place, problem)
        })
}

fn read_indices(values: &mut impl Values, kind: Kind, to: &mut Vec<i64>) -> Result<(), Fault> {
    let Kind::List { count, item } = kind else {
        return Ok(());
    };
    for _ in 0..values.list_length(count, item)? {
        to.push(values.integer(item)?);
    }
    Ok(())
}

fn skip_element(values: &mut impl Values, element: &Element) -> Result<(), Fault> {
    for index in 0..values.record_count(element)? {
        for property in &element.properties {
            let skipped = skip(values, property.kind);
            skipped.map_err(|fault| fault.in_element(&element.name, index as u64))?;
        }
    }
    Ok(())
}

fn skip(values: &mut impl Values, kind: Kind) -> Result<(), Fault> {
    match kind {
        Kind::One(scalar) => values.skip(scalar, 1),
        Kind::List { count, item } => {
            let length = values.list_length(count, item)?;
            values.skip(item, length)
        }
    }
}
