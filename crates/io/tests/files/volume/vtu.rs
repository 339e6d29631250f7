//! VTU in all its forms.

use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use msplines_io::parse_tets;

use super::{POINTS, expected, tets};

/// Arrays of a grid with a triangle beside the tetrahedra, as bytes.
fn streams() -> [(&'static str, &'static str, Vec<u8>); 4] {
    let points = POINTS
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let list = [0i32, 1, 2, 0, 1, 2, 3, 0, 2, 1, 4]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let ends = [3i64, 7, 11].iter().flat_map(|x| x.to_le_bytes()).collect();
    [
        ("Points", "Float64", points),
        ("connectivity", "Int32", list),
        ("offsets", "Int64", ends),
        ("types", "UInt8", vec![5, 10, 10]),
    ]
}

fn vtu_file(attributes: &str, arrays: [String; 4], appended: &[u8]) -> Vec<u8> {
    let [points, cells @ ..] = arrays;
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\" {attributes}>\n\
         <UnstructuredGrid><FieldData><DataArray type=\"String\" Name=\"note\" format=\"ascii\">1 2</DataArray></FieldData>\n\
         <Piece NumberOfPoints=\"5\" NumberOfCells=\"3\"><PointData/>\n<Points>{points}</Points>\n<Cells>{}</Cells>\n</Piece></UnstructuredGrid>\n",
        cells.concat()
    )
    .into_bytes();
    if !appended.is_empty() {
        file.extend(appended);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn length(bytes: &[u8], wide: bool) -> Vec<u8> {
    if wide {
        (bytes.len() as u64).to_le_bytes().to_vec()
    } else {
        (bytes.len() as u32).to_le_bytes().to_vec()
    }
}

fn compressed(bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let mut header = Vec::new();
    let mut body = Vec::new();
    let blocks: Vec<&[u8]> = bytes.chunks(64).collect();
    let mut sizes = vec![blocks.len() as u32, 64, (bytes.len() % 64) as u32];
    for block in blocks {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(block).unwrap();
        let packed = encoder.finish().unwrap();
        sizes.push(packed.len() as u32);
        body.extend(packed);
    }
    sizes
        .iter()
        .for_each(|size| header.extend(size.to_le_bytes()));
    (header, body)
}

fn array(kind: &str, name: &str, more: &str, content: &str) -> String {
    format!("<DataArray type=\"{kind}\" Name=\"{name}\" {more}>\n{content}\n</DataArray>")
}

/// The grid with its arrays in one block that begins with `start`.
fn appended(code: fn(&[u8]) -> Vec<u8>, start: &str) -> Vec<u8> {
    let mut block = start.as_bytes().to_vec();
    let first = block.len();
    let arrays = streams().map(|(name, kind, bytes)| {
        let more = format!("format=\"appended\" offset=\"{}\"", block.len() - first);
        block.extend(code(&[length(&bytes, true), bytes].concat()));
        array(kind, name, &more, "")
    });
    vtu_file("header_type=\"UInt64\"", arrays, &block)
}

/// The same grid in every form.
fn vtu_forms() -> Vec<(&'static str, Vec<u8>)> {
    let words = [
        "0 0 0 1 0 0 0 1 0 0.1 -2.5e-300 1 .3 .3 -1",
        "0 1 2 0 1 2 3\n0 2 1 4",
        "3 7 11",
        "5 10 10",
    ];
    let mut number = 0;
    let text = streams().map(|(name, kind, _)| {
        number += 1;
        array(kind, name, "format=\"ascii\"", words[number - 1])
    });
    let inline = |wide: bool| {
        streams().map(|(name, kind, bytes)| {
            let stream = [length(&bytes, wide), bytes].concat();
            array(kind, name, "format=\"binary\"", &base64(&stream))
        })
    };
    let zlib = streams().map(|(name, kind, bytes)| {
        let (header, body) = compressed(&bytes);
        array(
            kind,
            name,
            "format=\"binary\"",
            &(base64(&header) + &base64(&body)),
        )
    });
    vec![
        ("text", vtu_file("", text, b"")),
        (
            "narrow",
            vtu_file("header_type=\"UInt32\"", inline(false), b""),
        ),
        (
            "wide",
            vtu_file("header_type=\"UInt64\"", inline(true), b""),
        ),
        (
            "zlib",
            vtu_file("compressor=\"vtkZLibDataCompressor\"", zlib, b""),
        ),
        (
            "raw",
            appended(<[u8]>::to_vec, "<AppendedData encoding=\"raw\">\n_"),
        ),
        (
            "appended",
            appended(
                |bytes| base64(bytes).into_bytes(),
                "<AppendedData encoding=\"base64\">\n_",
            ),
        ),
    ]
}

#[test]
fn vtu_is_read_in_every_form_and_refused_when_cut() {
    for (form, file) in vtu_forms() {
        assert_eq!(tets("a.vtu", &file), expected(), "{form}");
        assert_eq!(tets("any.name", &file), expected(), "{form}");
        for length in (200..file.len() - 60).step_by(7) {
            // What is cut behind the last array may be read; it is the same then.
            match parse_tets(Path::new("a.vtu"), &file[..length]) {
                Ok(soup) => assert_eq!(soup, expected(), "{form} {length}"),
                Err(error) => assert!(error.to_string().contains("a.vtu")),
            }
        }
    }
}

/// VTK tells the range of an array in an element inside of it.
#[test]
fn vtu_arrays_may_hold_elements_about_themselves() {
    let note = "\n<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\">\
                <Value index=\"0\">0</Value><Value index=\"1\">1.75</Value>\
                <Value index=\"2\">2</Value></InformationKey>\n</DataArray>";
    for (form, file) in vtu_forms() {
        // What is appended raw is no text, and holds no elements.
        if let Ok(text) = String::from_utf8(file) {
            let told = text.replace("\n</DataArray>", note);
            assert_eq!(tets("a.vtu", told), expected(), "{form}");
        }
    }
}

#[test]
fn vtu_faults_name_the_line_and_the_array() {
    let text = String::from_utf8(vtu_forms().remove(0).1).unwrap();
    let cases = [
        (
            text.replace(">\n3 7 11", ">\n3 7 x"),
            "array `offsets`: `x` is no number",
        ),
        (
            text.replace("5 10 10", "5 10 12"),
            "a cell that is a hexahedron",
        ),
        (
            text.replace("UnstructuredGrid\" v", "PolyData\" v"),
            "line 2: a file of type `PolyData`",
        ),
        (
            text.replace("version=\"0.1\"", "compressor=\"vtkLZ4DataCompressor\""),
            "the compressor `vtkLZ4DataCompressor` is not supported; save it uncompressed",
        ),
        (
            text.replace("Float64", "Complex"),
            "line 5: the type of an array is `Complex`",
        ),
        (
            text.replace("3 7 11", "3 7 99"),
            "cell 2 has vertices 7 to 99 of the list",
        ),
        (text.replace("</Points>", "</Pints>"), ""),
    ];
    for (text, expected) in cases {
        if let Err(error) = parse_tets(Path::new("a.vtu"), text.as_bytes()) {
            assert!(error.to_string().contains(expected), "{expected}: {error}");
        } else {
            assert!(expected.is_empty(), "{expected}");
        }
    }
}

#[test]
fn two_pieces_are_one_solid() {
    let one = String::from_utf8(vtu_forms().remove(0).1).unwrap();
    let (from, to) = (
        one.find("<Piece").unwrap(),
        one.find("</UnstructuredGrid>").unwrap(),
    );
    let two = format!("{}{}{}", &one[..to], &one[from..to], &one[to..]);
    let soup = tets("a.vtu", two);
    assert_eq!((soup.positions.len(), soup.cells.len()), (10, 4));
    assert_eq!(soup.cells[3], [5, 7, 6, 9]);
}
