//! TetGen's pair of text files: `.node` with positions, `.ele` with tetrahedra.

use msplines_common::mesh::tet::TetSoup;
use nalgebra::Point3;

use super::cells::refuse;
use crate::error::Fault;
use crate::text::Lines;

/// Positions, and the index of the first.
pub(super) struct Nodes {
    positions: Vec<Point3<f64>>,
    first: i64,
}

/// Returns the counts of a file's first line: of rows, and of the further columns asked for.
fn header<const N: usize>(
    lines: &mut Lines<'_>,
    least: usize,
    what: &str,
) -> Result<(usize, [i64; N]), Fault> {
    let Some(mut words) = lines.next_with_words() else {
        return Err(Fault::truncated(lines.place(), "the counts are missing"));
    };
    let claimed = words.integer(what)?;
    let mut further = [0; N];
    for value in &mut further {
        *value = words.integer("a count of columns")?;
    }
    let room = (lines.rest().len() + 1) / least;
    match usize::try_from(claimed) {
        Ok(count) if count <= room => Ok((count, further)),
        Ok(count) => {
            let problem = format!("{what} is {count}, there is room for at most {room}");
            Err(Fault::truncated(words.place(), problem))
        }
        Err(_) => Err(Fault::malformed(
            words.place(),
            format!("{what} is {claimed}"),
        )),
    }
}

/// Returns the vertices of a `.node` file, numbered one after another from 0 or 1.
pub(super) fn parse_nodes(bytes: &[u8]) -> Result<Nodes, Fault> {
    let mut lines = Lines::new(bytes);
    let (count, [dimension]) = header(&mut lines, 8, "the number of vertices")?;
    if dimension != 3 {
        return Err(Fault::Unsupported {
            place: lines.place(),
            feature: format!("dimension {dimension}"),
            remedy: "give a mesh in three dimensions",
        });
    }
    let mut nodes = Nodes {
        positions: Vec::new(),
        first: 0,
    };
    for vertex in 0..count {
        let Some(mut words) = lines.next_with_words() else {
            let problem = format!("{count} vertices are announced, {vertex} are there");
            return Err(Fault::truncated(lines.place(), problem));
        };
        let mut read = || -> Result<(), Fault> {
            let index = words.integer("the index")?;
            if vertex == 0 {
                nodes.first = index;
            }
            if !(0..=1).contains(&nodes.first) || index - nodes.first != vertex as i64 {
                let problem =
                    format!("the index is {index}; indices must count up from 0 or 1 without gaps");
                return Err(Fault::malformed(words.place(), problem));
            }
            let x = words.number("the x coordinate")?;
            let y = words.number("the y coordinate")?;
            let position = Point3::new(x, y, words.number("the z coordinate")?);
            nodes.positions.push(position);
            Ok(())
        };
        read().map_err(|fault| fault.in_element("vertex", vertex as u64))?;
    }
    Ok(nodes)
}

/// Returns the soup of a `.ele` file over these vertices.
pub(super) fn parse_cells(bytes: &[u8], nodes: Nodes) -> Result<TetSoup, Fault> {
    let mut lines = Lines::new(bytes);
    let (count, [corners]) = header(&mut lines, 10, "the number of tetrahedra")?;
    if corners != 4 {
        let name = format!("tetrahedron of {corners} nodes");
        return Err(refuse(lines.place(), &name));
    }
    let mut soup = TetSoup {
        positions: nodes.positions,
        cells: Vec::new(),
    };
    for cell in 0..count {
        let Some(mut words) = lines.next_with_words() else {
            let problem = format!("{count} tetrahedra are announced, {cell} are there");
            return Err(Fault::truncated(lines.place(), problem));
        };
        let mut read = || -> Result<(), Fault> {
            words.integer("the index")?;
            let mut corners = [0; 4];
            for corner in &mut corners {
                *corner = words.integer("a vertex index")?.saturating_sub(nodes.first);
            }
            soup.cells.push(corners);
            Ok(())
        };
        read().map_err(|fault| fault.in_element("tetrahedron", cell as u64))?;
    }
    Ok(soup)
}
