//! Laws of the readers of `io`.

use std::path::Path;

use msplines_common::mesh::PolygonSoup;
use msplines_common::mesh::curves::CurveNetwork;
use msplines_io::{
    ReadError, parse_creases, parse_curves, parse_npy, parse_points, parse_soup, parse_tetgen,
    parse_tets,
};

use crate::memory::{bounded, bounded_drawing};
use crate::round_trip;

/// What stands between the two files of TetGen in one input.
const BETWEEN: &[u8] = b"\n|";

/// Most corners that one byte can name: a row of a text file is a number and its separator, a binary STL
/// has 9 of its 50 bytes a triangle in coordinates, and a strip of a PLY has a triangle for each index.
const CORNERS_PER_BYTE: usize = 3;

/// Holds the readers of surfaces and points to their laws.
pub fn surface(name: &str, bytes: &[u8]) {
    let path = Path::new(name);
    let points = bounded(bytes.len(), || parse_points(path, bytes));
    if let Some(points) = answer(points) {
        assert!(points.len() <= bytes.len(), "{} points", points.len());
    }
    let soup = bounded(bytes.len(), || parse_soup(path, bytes));
    if let Some(soup) = answer(soup) {
        check_soup(&soup, bytes.len());
        round_trip::surface(&soup);
    }
}

fn check_soup(soup: &PolygonSoup, bytes: usize) {
    let corners = soup.face_vertices.len();
    assert!(corners <= CORNERS_PER_BYTE * bytes, "{corners} corners");
    assert_eq!(soup.face_offsets.first(), Some(&0));
    assert_eq!(soup.face_offsets.last(), Some(&corners));
    assert!(soup.face_offsets.is_sorted(), "offsets go back");
    for attribute in &soup.attributes {
        assert_eq!(attribute.values.len(), soup.positions.len());
    }
}

/// Holds the readers of polylines to their laws.
pub fn network(name: &str, bytes: &[u8]) {
    let network = bounded(bytes.len(), || parse_curves(Path::new(name), bytes));
    check_network(network);
}

/// Holds the reader of drawings to its laws.
pub fn drawing(bytes: &[u8]) {
    let network = bounded_drawing(bytes.len(), || parse_curves(Path::new("a.svg"), bytes));
    check_network(network);
}

fn check_network(network: Result<CurveNetwork, ReadError>) {
    let Some(network) = answer(network) else {
        return;
    };
    let points = network.points();
    assert!(points.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()));
    for curve in network.curves() {
        let outside = curve.points.iter().find(|&&v| v as usize >= points.len());
        assert_eq!(outside, None);
    }
}

/// Holds the reader of creases to its laws.
pub fn creases(bytes: &[u8]) {
    let read = bounded(bytes.len(), || parse_creases(Path::new("a.creases"), bytes));
    if let Some(creases) = answer(read) {
        assert_eq!(creases.tags.len(), creases.lines.len());
        assert!(creases.tags.len() <= bytes.len());
    }
}

/// Holds the readers of solids to their laws.
pub fn solid(name: &str, bytes: &[u8]) {
    let soup = bounded(bytes.len(), || parse_tets(Path::new(name), bytes));
    if let Some(soup) = answer(soup) {
        round_trip::solid(&soup);
    }
}

/// Holds the reader of TetGen's two files to its laws; both stand in one input.
pub fn tetgen(bytes: &[u8]) {
    let cut = bytes.windows(BETWEEN.len()).position(|at| at == BETWEEN);
    let (node, ele) = bytes.split_at(cut.unwrap_or(bytes.len()));
    let ele = &ele[BETWEEN.len().min(ele.len())..];
    let read = || parse_tetgen((Path::new("a.node"), node), (Path::new("a.ele"), ele));
    if let Some(soup) = answer(bounded(bytes.len(), read)) {
        round_trip::solid(&soup);
    }
}

/// Holds the reader of arrays to its laws.
pub fn array(bytes: &[u8]) {
    let read = bounded(bytes.len(), || parse_npy(Path::new("a.npy"), bytes));
    if let Some(array) = answer(read) {
        assert!(array.values.len() <= bytes.len());
        round_trip::array(&array);
    }
}

/// Holds all readers to their laws on a file without an extension.
pub fn anything(bytes: &[u8]) {
    surface("a", bytes);
    network("a", bytes);
    solid("a", bytes);
}

/// Returns what was read; a refusal must have a text.
fn answer<T>(read: Result<T, ReadError>) -> Option<T> {
    read.map_err(|error| assert!(!error.to_string().is_empty()))
        .ok()
}
