//! Damaged bytes: an answer, never a panic, in memory bounded by the size of the file.
//!
//! One test in a program of its own, since it counts what the whole program allocates.

use std::path::Path;

use msplines_common::mesh::PolygonSoup;
use msplines_common::mesh::curves::CurveNetwork;
use msplines_io::{Array, Creases, ReadError, parse_creases, parse_curves, parse_npy, parse_soup};
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
    Array(Array),
    Curves(CurveNetwork),
    Creases(Creases),
}

fn parse(path: &Path, file: &[u8]) -> Result<Content, ReadError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension {
        Some("npy") => parse_npy(path, file).map(Content::Array),
        Some("curves" | "svg") => parse_curves(path, file).map(Content::Curves),
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
        which in 0..12usize,
        damage in prop::collection::vec(damages(), 0..4),
    ) {
        let (name, mut file) = [seeds(), curve_seeds()].concat().swap_remove(which);
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
