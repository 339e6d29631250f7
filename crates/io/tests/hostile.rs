//! Damaged bytes: an answer, never a panic, in memory bounded by the size of the file.
//!
//! One test in a program of its own, since it counts what the whole program allocates.

use std::path::Path;

use msplines_common::mesh::PolygonSoup;
use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::mesh::tet::TetSoup;
use msplines_io::{
    Array, Creases, ReadError, parse_creases, parse_curves, parse_npy, parse_soup, parse_tetgen,
    parse_tets,
};
use peak_alloc::PeakAlloc;
use proptest::prelude::*;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// One byte of text or binary can become one number or one index, and a growing array is twice
/// as large as its content while it moves.
const BYTES_PER_BYTE: usize = 64;

/// Messages, and what the test program itself does meanwhile.
const SLACK: usize = 1 << 16;

fn curve_seeds() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        (
            "a.curves",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0 # top\nc 1 2 3 1\nk 0 1 0\nc 1 2 3\n".to_vec(),
        ),
        (
            "a.svg",
            b"<svg><g transform='rotate(30 1 2)' id='crease'><path d='M 0 0 c 1 2 3 4 5 6 z'/>\n\
              <polygon points='0 0 1 0 1 1'/></g><line x1='3' y2='4e0'/></svg>"
                .to_vec(),
        ),
        ("a.creases", b"# i j s\n1 2 3.5\n2 2 10\n".to_vec()),
    ]
}

const XML: &str = "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece>\n";

/// End of a grid in text, after its points.
const CELLS: &str = "<Cells><DataArray type='Int64' Name='connectivity'>0 1 2 3</DataArray>\
    <DataArray type='Int64' Name='offsets'>4</DataArray>\
    <DataArray type='UInt8' Name='types'>10</DataArray></Cells></Piece>\n</UnstructuredGrid>";

/// One tetrahedron in the text of each format of solids; TetGen's files stand one after another.
fn solid_seeds() -> Vec<(&'static str, Vec<u8>)> {
    let points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let marked = points.replace('\n', " 0\n");
    let nodes = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n9 0 0 1\n$EndNodes";
    let texts = [
        (
            "a.mesh",
            format!(
                "MeshVersionFormatted 2 Dimension 3 Vertices 4\n{marked}Triangles 1 1 2 3 0\n\
                     Tetrahedra\n1\n1 2 3 4 0\nEnd"
            ),
        ),
        (
            "a.msh",
            format!(
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{nodes}\n$Elements\n2\n\
                     1 2 1 0 1 2 3\n2 4 2 0 1 1 2 3 9\n$EndElements\n"
            ),
        ),
        (
            "a.msh",
            format!(
                "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n\
                     {points}$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"
            ),
        ),
        (
            "a.vtk",
            format!(
                "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n\
                     POINTS 4 float\n{points}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
            ),
        ),
        (
            "a.vtu",
            format!(
                "{XML}<Points><DataArray type='Float64'>{points}</DataArray></Points>\n\
                     {CELLS}</VTKFile>"
            ),
        ),
        (
            "a.ele",
            "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n|1 4 0\n1 1 2 3 4\n".to_owned(),
        ),
    ];
    texts.map(|(name, text)| (name, text.into_bytes())).to_vec()
}

fn compressed_grid() -> Vec<u8> {
    let packed = XML.replace("Grid'>", "Grid' compressor='vtkZLibDataCompressor'>");
    let zlib = format!(
        "{packed}<Points><DataArray type='Float32' format='binary'>AQAAADAAAAAwAAAAEAAAAA==\
         eJxjYEAGDfYMBPgAJ70CPg==</DataArray></Points>\n{CELLS}</VTKFile>"
    );
    zlib.into_bytes()
}

fn raw_grid() -> Vec<u8> {
    let mut raw = format!(
        "{XML}<Points><DataArray type='Float64' format='appended' offset='0'/></Points>\n\
         {CELLS}<AppendedData encoding=\"raw\">_"
    )
    .into_bytes();
    raw.extend([96, 0, 0, 0]);
    raw.extend([0; 96]);
    raw
}

/// One tetrahedron in each binary format of solids.
fn binary_solid_seeds() -> Vec<(&'static str, Vec<u8>)> {
    let longs = |values: &[i64]| {
        values
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let ints = |values: &[i32]| {
        values
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let gmsh = [
        b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec(),
        [
            longs(&[1, 4, 1, 4]),
            ints(&[3, 1, 0]),
            longs(&[4, 1, 2, 3, 4]),
        ]
        .concat(),
        vec![0; 96],
        b"\n$EndNodes\n$Elements\n".to_vec(),
        [
            longs(&[1, 1, 1, 1]),
            ints(&[3, 1, 4]),
            longs(&[1, 1, 1, 2, 3, 4]),
        ]
        .concat(),
        b"\n$EndElements\n".to_vec(),
    ];
    let big = |values: &[i64]| {
        values
            .iter()
            .flat_map(|x| x.to_be_bytes())
            .collect::<Vec<u8>>()
    };
    let legacy = [
        b"# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
            .to_vec(),
        vec![0; 48],
        b"\nCELLS 2 4\nOFFSETS vtktypeint64\n".to_vec(),
        big(&[0, 4]),
        b"\nCONNECTIVITY vtktypeint64\n".to_vec(),
        big(&[0, 1, 2, 3]),
        b"\nCELL_TYPES 1\n\0\0\0\x0a".to_vec(),
    ];
    vec![
        ("a.msh", gmsh.concat()),
        ("a.vtk", legacy.concat()),
        ("a.vtu", compressed_grid()),
        ("a.vtu", raw_grid()),
    ]
}

fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let ply = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar red\nelement face 2\n\
             property list uchar int vertex_indices\nelement tristrips 1\n\
             property list int int vertex_indices\nend_header\n"
        )
        .into_bytes()
    };
    let binary = |mut file: Vec<u8>, int: fn(i32) -> [u8; 4]| {
        (0..3).for_each(|red| file.extend([[0; 12].as_slice(), &[red]].concat()));
        for corner in [&[0, 1, 2], &[2, 1, 0]] {
            file.push(3);
            file.extend(corner.iter().copied().flat_map(int));
        }
        file.extend([5, 0, 1, 2, -1, 1].into_iter().flat_map(int));
        file
    };
    let mut text = ply("ascii");
    text.extend(b"0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n3 2 1 0\n5 0 1 2 -1 1\n");
    let npy = |shape: &str| {
        let header = format!("{{'descr': '>i2', 'fortran_order': True, 'shape': {shape}, }}\n");
        let length = [header.len() as u8, 0];
        [
            b"\x93NUMPY\x01\x00",
            &length[..],
            header.as_bytes(),
            &[7; 12],
        ]
        .concat()
    };
    let mut stl = b"solid".to_vec();
    stl.resize(80, 0);
    stl.extend([2, 0, 0, 0]);
    stl.resize(184, 1);
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                 endloop\nendfacet\n";
    vec![
        ("a.ply", text),
        (
            "a.ply",
            binary(ply("binary_little_endian"), i32::to_le_bytes),
        ),
        ("a.ply", binary(ply("binary_big_endian"), i32::to_be_bytes)),
        ("a.stl", stl),
        (
            "a.stl",
            format!("solid a\n{facet}{facet}endsolid a\n").into_bytes(),
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0 1 1 1\nv 0 1 0\nf 1/1 2//2 3\nf -1 -2 \\\n-3\n".to_vec(),
        ),
        (
            "a.off",
            b"COFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n".to_vec(),
        ),
        ("a.npy", npy("(2, 3)")),
        ("a.npy", npy("(3, 1, 2)")),
    ]
}

/// One blow to a file; places are fractions of its length.
#[derive(Clone, Debug)]
enum Damage {
    Set(f64, u8),
    Insert(f64, Vec<u8>),
    Remove(f64, usize),
    Repeat(f64, usize),
    Truncate(f64),
}

fn damages() -> impl Strategy<Value = Damage> {
    let place = || 0.0..1.0f64;
    let lies = [
        "4000000000",
        "-1",
        "nan",
        "inf",
        "1e999",
        "18446744073709551615",
        "\n",
        " ",
        "9",
    ];
    let lies = prop::sample::select(lies.map(|lie| lie.as_bytes().to_vec()).to_vec());
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        (place(), lies).prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        (place(), prop::collection::vec(any::<u8>(), 1..5))
            .prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        (place(), 1usize..20).prop_map(|(at, count)| Damage::Remove(at, count)),
        (place(), 1usize..200).prop_map(|(at, count)| Damage::Repeat(at, count)),
        place().prop_map(Damage::Truncate),
    ]
}

fn apply(damage: &Damage, file: &mut Vec<u8>) {
    let at = |fraction: f64| (fraction * file.len() as f64) as usize;
    match damage {
        Damage::Set(place, byte) => {
            let at = at(*place);
            file.iter_mut()
                .skip(at)
                .take(1)
                .for_each(|old| *old = *byte);
        }
        Damage::Insert(place, bytes) => {
            let at = at(*place);
            file.splice(at..at, bytes.iter().copied());
        }
        Damage::Remove(place, count) => {
            let at = at(*place);
            file.drain(at..(at + count).min(file.len()));
        }
        Damage::Repeat(place, count) => {
            let at = at(*place);
            file.extend_from_within(at..(at + count).min(file.len()));
        }
        Damage::Truncate(place) => file.truncate(at(*place)),
    }
}

/// What a file holds.
#[derive(Debug)]
enum Content {
    Soup(PolygonSoup),
    Tets(TetSoup),
    Array(Array),
    Curves(CurveNetwork),
    Creases(Creases),
}

fn parse(path: &Path, file: &[u8]) -> Result<Content, ReadError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension {
        Some("npy") => parse_npy(path, file).map(Content::Array),
        Some("curves" | "svg") => parse_curves(path, file).map(Content::Curves),
        Some("mesh" | "msh" | "vtk" | "vtu") => parse_tets(path, file).map(Content::Tets),
        Some("ele") => {
            let middle = file.iter().position(|&b| b == b'|').unwrap_or(file.len());
            let (node, ele) = file.split_at(middle);
            parse_tetgen((path, node), (path, ele.get(1..).unwrap_or_default())).map(Content::Tets)
        }
        Some("creases") => parse_creases(path, file).map(Content::Creases),
        _ => parse_soup(path, file).map(Content::Soup),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 10_000, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn damage_is_answered_in_bounded_memory(
        which in 0..22usize,
        damage in prop::collection::vec(damages(), 0..4),
    ) {
        let (name, mut file) = [seeds(), curve_seeds(), solid_seeds(), binary_solid_seeds()].concat().swap_remove(which);
        damage.iter().for_each(|damage| apply(damage, &mut file));
        let before = ALLOCATOR.current_usage();
        ALLOCATOR.reset_peak_usage();
        let answer = parse(Path::new(name), &file);
        let used = ALLOCATOR.peak_usage() - before;
        prop_assert!(answer.is_ok() || !damage.is_empty(), "{answer:?}");
        prop_assert!(used <= SLACK + BYTES_PER_BYTE * file.len(), "{used} for {}", file.len());
        match answer {
            Ok(Content::Soup(soup)) => {
                prop_assert_eq!(soup.face_offsets.last(), Some(&soup.face_vertices.len()));
                prop_assert!(soup.face_offsets.is_sorted());
                for attribute in &soup.attributes {
                    prop_assert_eq!(attribute.values.len(), soup.positions.len());
                }
            }
            Ok(Content::Tets(soup)) => prop_assert!(!soup.cells.is_empty()),
            Ok(Content::Array(array)) => {
                let count = array.shape.iter().fold(1, |product: usize, &n| product.saturating_mul(n));
                prop_assert_eq!(array.values.len(), count);
            }
            Ok(Content::Curves(network)) => {
                let points = network.points().len();
                for curve in network.curves() {
                    prop_assert!(curve.points.iter().all(|&p| (p as usize) < points));
                    prop_assert_eq!(curve.points.len(), curve.creases.len() + 1);
                }
            }
            Ok(Content::Creases(creases)) => {
                prop_assert_eq!(creases.tags.len(), creases.lines.len());
                prop_assert!(creases.tags.iter().all(|tag| tag.sharpness >= 0.0));
            }
            Err(error) => prop_assert!(error.to_string().contains(name)),
        }
    }
}
