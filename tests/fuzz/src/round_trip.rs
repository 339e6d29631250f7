//! What is written is read back, bit for bit.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use msplines_common::mesh::tet::TetSoup;
use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use msplines_io::{
    Array, Surface, Volume, VolumeCells, read_npy, read_soup, read_tets, write_npy, write_surface,
    write_volume,
};
use nalgebra::Point3;
use tempfile::TempDir;

/// Writes a soup that is made of triangles and compares what is read from the files.
pub(crate) fn surface(soup: &PolygonSoup) {
    let Some(faces) = triangles(soup) else { return };
    for (name, attributes) in [("a.ply", soup.attributes.as_slice()), ("a.obj", &[])] {
        let path = place(name);
        let surface = Surface {
            positions: &soup.positions,
            faces: &faces,
            attributes,
            ..Surface::default()
        };
        // A soup need not be fit to be written: coordinates that are not finite, names with spaces.
        if write_surface(&path, &surface).is_err() {
            continue;
        }
        let read = read_soup(&path).unwrap_or_else(|error| panic!("what was written: {error}"));
        assert_eq!(bits(&read.positions), bits(&soup.positions), "{name}");
        assert_eq!(read.face_vertices, soup.face_vertices, "{name}");
        assert_eq!(
            named_bits(&read.attributes),
            named_bits(attributes),
            "{name}"
        );
    }
}

/// Writes a solid and compares what is read from the files.
pub(crate) fn solid(soup: &TetSoup) {
    let vertex = |&v: &i64| u32::try_from(v).ok();
    let cells: Option<Vec<u32>> = soup.cells.as_flattened().iter().map(vertex).collect();
    let Some(cells) = cells else { return };
    let (cells, _) = cells.as_chunks::<4>();
    for name in ["a.mesh", "a.msh", "a.vtu"] {
        let path = place(name);
        let volume = Volume {
            positions: &soup.positions,
            cells: VolumeCells::Tetrahedra(cells),
            point_data: &[],
            cell_data: &[],
        };
        if write_volume(&path, &volume).is_err() {
            continue;
        }
        let read = read_tets(&path).unwrap_or_else(|error| panic!("what was written: {error}"));
        assert_eq!(bits(&read.positions), bits(&soup.positions), "{name}");
        assert_eq!(read.cells, soup.cells, "{name}");
    }
}

/// Writes an array and compares what is read from the file.
pub(crate) fn array(array: &Array) {
    let path = place("a.npy");
    if write_npy(&path, array).is_err() {
        return;
    }
    let read = read_npy(&path).unwrap_or_else(|error| panic!("what was written: {error}"));
    assert_eq!(read.shape, array.shape);
    let bits = |array: &Array| -> Vec<u64> { array.values.iter().map(|x| x.to_bits()).collect() };
    assert_eq!(bits(&read), bits(array));
}

/// Returns the faces of a soup of triangles whose indices are vertices of some mesh.
fn triangles(soup: &PolygonSoup) -> Option<Vec<[u32; 3]>> {
    (0..soup.face_count())
        .map(|face| {
            let corners: [i64; 3] = soup.face(face).try_into().ok()?;
            let [a, b, c] = corners.map(|corner| u32::try_from(corner).ok());
            Some([a?, b?, c?])
        })
        .collect()
}

fn bits(positions: &[Point3<f64>]) -> Vec<[u64; 3]> {
    let of = |p: &Point3<f64>| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()];
    positions.iter().map(of).collect()
}

fn named_bits(attributes: &[VertexAttribute]) -> Vec<(&str, Vec<u64>)> {
    let of = |a: &VertexAttribute| a.values.iter().map(|x| x.to_bits()).collect();
    attributes
        .iter()
        .map(|a| (a.name.as_str(), of(a)))
        .collect()
}

thread_local! {
    static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
}

/// Returns a path in a folder that lasts as long as the thread.
fn place(name: &str) -> PathBuf {
    let made = || tempfile::tempdir().unwrap_or_else(|error| panic!("a temporary folder: {error}"));
    FOLDER.with(|folder| folder.get_or_init(made).path().join(Path::new(name)))
}
