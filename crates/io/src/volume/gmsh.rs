//! Gmsh `.msh`, versions 2.2 and 4.1, text and binary.
//!
//! Nodes and cells have tags, in any order and with gaps; cells name nodes by tag.

use msplines_common::mesh::tet::TetSoup;
use nalgebra::Point3;

use super::cells::{Kind, gmsh_kind, refuse};
use super::cursor::Cursor;
use crate::error::{Fault, Place};
use crate::text::quoted;

pub(super) fn has_magic(bytes: &[u8]) -> bool {
    let word = Cursor::new(bytes).word();
    word == Some(b"$MeshFormat")
        || word == Some(b"$Comments") && find(bytes, b"$MeshFormat").is_some()
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

/// Nodes by tag, and cells by tags of their nodes.
#[derive(Default)]
struct Draft {
    tags: Vec<u64>,
    positions: Vec<Point3<f64>>,
    cells: Vec<[u64; 4]>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<TetSoup, Fault> {
    let mut cursor = Cursor::new(bytes);
    let mut numbers = None;
    let mut draft = Draft::default();
    while let Some(section) = cursor.word() {
        let Some(name) = section.strip_prefix(b"$") else {
            let problem = format!("{} stands where a section begins", quoted(section));
            return Err(Fault::malformed(cursor.line_place(), problem));
        };
        match (name, &numbers) {
            (b"MeshFormat", _) => numbers = Some(read_format(&mut cursor)?),
            (b"Nodes", Some(numbers)) => numbers.read_nodes(&mut cursor, &mut draft)?,
            (b"Elements", Some(numbers)) => numbers.read_cells(&mut cursor, &mut draft)?,
            (b"Nodes" | b"Elements", None) => {
                let problem = "$MeshFormat must come first";
                return Err(Fault::malformed(cursor.line_place(), problem));
            }
            // Other sections may hold anything; only their end tells how long they are.
            _ => {
                let end = [b"$End", name].concat();
                let Some(place) = find(cursor.rest(), &end) else {
                    return Err(cursor.ends_before(&String::from_utf8_lossy(&end)));
                };
                cursor.skip(place, "the end of a section")?;
            }
        }
        let end = cursor.word().unwrap_or_default();
        if end.strip_prefix(b"$End") != Some(name) {
            let problem = format!("{} stands where a section ends", quoted(end));
            return Err(Fault::malformed(cursor.line_place(), problem));
        }
    }
    resolve(draft, &cursor)
}

/// Replaces tags of nodes by their places.
fn resolve(draft: Draft, cursor: &Cursor<'_>) -> Result<TetSoup, Fault> {
    let mut order: Vec<(u64, u32)> = draft.tags.iter().copied().zip(0..).collect();
    order.sort_unstable();
    if let Some(pair) = order.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let problem = format!("two nodes have the tag {}", pair[0].0);
        return Err(Fault::malformed(cursor.line_place(), problem));
    }
    let mut cells = Vec::with_capacity(draft.cells.len());
    for (number, tags) in draft.cells.iter().enumerate() {
        let mut corners = [0; 4];
        for (corner, tag) in corners.iter_mut().zip(tags) {
            let place = order.binary_search_by_key(tag, |&(tag, _)| tag);
            let Ok(place) = place else {
                let problem = format!("tetrahedron {number} names node {tag}, which is not there");
                return Err(Fault::malformed(cursor.line_place(), problem));
            };
            *corner = i64::from(order[place].1);
        }
        cells.push(corners);
    }
    Ok(TetSoup {
        positions: draft.positions,
        cells,
    })
}

/// How numbers are written, and which sections there are.
#[derive(Clone, Copy)]
struct Numbers {
    version: Version,
    binary: bool,
    big_endian: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Version {
    Two,
    Four,
}

fn read_format(cursor: &mut Cursor<'_>) -> Result<Numbers, Fault> {
    let word = cursor.expect("the version")?;
    let version = match word {
        b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
        b"4.1" => Version::Four,
        other => {
            return Err(Fault::Unsupported {
                place: cursor.line_place(),
                feature: format!("version {}", quoted(other)),
                remedy: "save it in version 4.1 or 2.2",
            });
        }
    };
    let kind = cursor.integer("the file type")?;
    let size = cursor.integer("the size of numbers")?;
    if !(0..=1).contains(&kind) || kind == 1 && size != 8 {
        let problem = format!("file type {kind} with numbers of {size} bytes");
        return Err(Fault::malformed(cursor.line_place(), problem));
    }
    let mut big_endian = false;
    if kind == 1 {
        cursor.line();
        let one = cursor.take::<4>("the number one")?;
        big_endian = one == 1i32.to_be_bytes();
        if !big_endian && one != 1i32.to_le_bytes() {
            let problem = "the number one is not one: the byte order is unknown";
            return Err(Fault::malformed(cursor.byte_place(), problem));
        }
    }
    Ok(Numbers {
        version,
        binary: kind == 1,
        big_endian,
    })
}

impl Numbers {
    fn place(self, cursor: &Cursor<'_>) -> Place {
        if self.binary {
            cursor.byte_place()
        } else {
            cursor.line_place()
        }
    }

    /// Returns a whole number that takes four bytes in a binary file.
    fn int(self, cursor: &mut Cursor<'_>, what: &str) -> Result<i64, Fault> {
        if !self.binary {
            return cursor.integer(what);
        }
        let bytes = cursor.take(what)?;
        Ok(i64::from(if self.big_endian {
            i32::from_be_bytes(bytes)
        } else {
            i32::from_le_bytes(bytes)
        }))
    }

    /// Returns a whole number that takes eight bytes in a binary file.
    fn long(self, cursor: &mut Cursor<'_>, what: &str) -> Result<i64, Fault> {
        if !self.binary {
            return cursor.integer(what);
        }
        let bytes = cursor.take(what)?;
        Ok(if self.big_endian {
            i64::from_be_bytes(bytes)
        } else {
            i64::from_le_bytes(bytes)
        })
    }

    fn double(self, cursor: &mut Cursor<'_>, what: &str) -> Result<f64, Fault> {
        if !self.binary {
            return cursor.number(what);
        }
        let bytes = cursor.take(what)?;
        Ok(if self.big_endian {
            f64::from_be_bytes(bytes)
        } else {
            f64::from_le_bytes(bytes)
        })
    }

    fn tag(self, cursor: &mut Cursor<'_>, read: i64) -> Result<u64, Fault> {
        u64::try_from(read).map_err(|_| {
            Fault::malformed(self.place(cursor), format!("the tag of a node is {read}"))
        })
    }

    fn point(self, cursor: &mut Cursor<'_>) -> Result<Point3<f64>, Fault> {
        let x = self.double(cursor, "the x coordinate")?;
        let y = self.double(cursor, "the y coordinate")?;
        Ok(Point3::new(x, y, self.double(cursor, "the z coordinate")?))
    }

    fn read_nodes(self, cursor: &mut Cursor<'_>, draft: &mut Draft) -> Result<(), Fault> {
        if self.version == Version::Two {
            let count = cursor.count("the number of nodes", 8)?;
            if self.binary {
                cursor.line();
            }
            for _ in 0..count {
                let tag = self.int(cursor, "the tag of a node")?;
                draft.tags.push(self.tag(cursor, tag)?);
                draft.positions.push(self.point(cursor)?);
            }
            return Ok(());
        }
        let blocks = self.head(cursor)?;
        for _ in 0..blocks {
            let dimension = self.int(cursor, "the dimension of a block")?;
            self.int(cursor, "the tag of a block")?;
            let parametric = self.int(cursor, "whether a block is parametric")?;
            let count = self.long(cursor, "the number of nodes")?;
            let count = cursor.check_room("the number of nodes", count, 8)?;
            for _ in 0..count {
                let tag = self.long(cursor, "the tag of a node")?;
                draft.tags.push(self.tag(cursor, tag)?);
            }
            for _ in 0..count {
                draft.positions.push(self.point(cursor)?);
                let further = if parametric == 1 {
                    dimension.clamp(0, 3)
                } else {
                    0
                };
                for _ in 0..further {
                    self.double(cursor, "a parameter")?;
                }
            }
        }
        Ok(())
    }

    /// Returns the number of blocks of a section of version 4.
    fn head(self, cursor: &mut Cursor<'_>) -> Result<usize, Fault> {
        if self.binary {
            cursor.line();
        }
        let blocks = self.long(cursor, "the number of blocks")?;
        for what in ["the number of items", "the smallest tag", "the largest tag"] {
            self.long(cursor, what)?;
        }
        cursor.check_room("the number of blocks", blocks, 8)
    }

    fn read_cells(self, cursor: &mut Cursor<'_>, draft: &mut Draft) -> Result<(), Fault> {
        match (self.version, self.binary) {
            (Version::Two, false) => {
                let count = cursor.count("the number of elements", 8)?;
                for _ in 0..count {
                    cursor.integer("the tag of an element")?;
                    let (kind, nodes) = self.kind(cursor)?;
                    let tags = cursor.count("the number of tags", 2)?;
                    for _ in 0..tags {
                        cursor.integer("a tag")?;
                    }
                    self.read_cell(cursor, kind, nodes, draft)?;
                }
            }
            (Version::Two, true) => {
                let count = cursor.count("the number of elements", 8)?;
                cursor.line();
                let mut read = 0;
                while read < count {
                    let (kind, nodes) = self.kind(cursor)?;
                    let block = self.int(cursor, "the number of elements of a block")?;
                    let block = cursor.check_room("the number of elements of a block", block, 8)?;
                    let tags = self.int(cursor, "the number of tags")?;
                    for _ in 0..block {
                        for _ in 0..=tags.clamp(0, i64::from(i32::MAX)) {
                            self.int(cursor, "a tag")?;
                        }
                        self.read_cell(cursor, kind, nodes, draft)?;
                    }
                    read += block.max(1);
                }
            }
            (Version::Four, _) => {
                for _ in 0..self.head(cursor)? {
                    self.int(cursor, "the dimension of a block")?;
                    self.int(cursor, "the tag of a block")?;
                    let (kind, nodes) = self.kind(cursor)?;
                    let count = self.long(cursor, "the number of elements")?;
                    let count = cursor.check_room("the number of elements", count, 4)?;
                    for _ in 0..count {
                        self.long(cursor, "the tag of an element")?;
                        self.read_cell(cursor, kind, nodes, draft)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn kind(self, cursor: &mut Cursor<'_>) -> Result<(Kind, usize), Fault> {
        let number = self.int(cursor, "the type of an element")?;
        let known = u64::try_from(number).ok().and_then(gmsh_kind);
        match known {
            Some((Kind::Other(name), _)) => Err(refuse(self.place(cursor), name)),
            Some(known) => Ok(known),
            None => {
                let problem = format!("an element is of type {number}, which is not known here");
                Err(Fault::malformed(self.place(cursor), problem))
            }
        }
    }

    fn read_cell(
        self,
        cursor: &mut Cursor<'_>,
        kind: Kind,
        nodes: usize,
        draft: &mut Draft,
    ) -> Result<(), Fault> {
        let mut corners = [0; 4];
        for node in 0..nodes {
            let tag = match self.version {
                Version::Two => self.int(cursor, "a node of an element")?,
                Version::Four => self.long(cursor, "a node of an element")?,
            };
            if let Some(corner) = corners.get_mut(node) {
                *corner = self.tag(cursor, tag)?;
            }
        }
        if kind == Kind::Tetrahedron {
            draft.cells.push(corners);
        }
        Ok(())
    }
}
