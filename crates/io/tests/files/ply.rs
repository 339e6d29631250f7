//! PLY dialects.

use crate::common::{bits, faces, refusal, soup, values};

const TEXT: &str = "ply
format ascii 1.0
comment made by hand
obj_info num_cols 2
element vertex 4
property float x
property float y
property float z
property uchar red
property double quality
element face 2
property list uchar int vertex_indices
end_header
0 0 0 255 1e-3
1 0 0 0 .5
1 1 0 7 2.
0 1 0.1 8 nan
4 0 1 2 3
3 0 1 -2
";

#[test]
fn text_with_comments_and_further_properties_is_read() {
    let soup = soup("a.ply", TEXT);
    assert_eq!(
        soup.positions[3].z, 0.1,
        "text keeps more digits than its declared float"
    );
    assert_eq!(faces(&soup), [vec![0, 1, 2, 3], vec![0, 1, -2]]);
    assert_eq!(values(&soup, "red"), [255.0, 0.0, 7.0, 8.0]);
    assert_eq!(values(&soup, "quality")[..3], [1e-3, 0.5, 2.0]);
    assert!(values(&soup, "quality")[3].is_nan());
}

#[test]
fn line_endings_and_line_breaks_mean_nothing() {
    let expected = bits(&soup("a.ply", TEXT));
    for ending in ["\r\n", "\r"] {
        assert_eq!(bits(&soup("a.ply", TEXT.replace('\n', ending))), expected);
    }
    let (header, body) = TEXT.split_once("end_header\n").unwrap();
    let flat = format!("{header}end_header\n{}", body.replace('\n', " "));
    assert_eq!(bits(&soup("a.ply", flat)), expected);
    let split = format!("{header}end_header\n{}", body.replace(' ', "\n"));
    assert_eq!(bits(&soup("a.ply", split)), expected);
}

/// Returns a file with a triangle in binary, its numbers in the order that `big` says.
fn binary(big: bool, count: &str, item: &str, header_end: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\n\
         property double y\nproperty short z\nproperty list uint8 float skipped\n\
         element unknown 2\nproperty int32 a\nproperty list ushort double b\n\
         element face 1\nproperty uchar flags\nproperty list {count} {item} vertex_index\n\
         property list uchar float texcoord\nelement edge 1\nproperty int a\nend_header\n"
    )
    .replace('\n', header_end)
    .into_bytes();
    let mut put = |kind: &str, value: f64| {
        let mut bytes = match kind {
            "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
            "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
            "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
            "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
            "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
            "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
            "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for vertex in 0..3 {
        let x = f64::from(vertex);
        for (kind, value) in [("float", x + 0.5), ("double", 0.1 * x), ("short", -x)] {
            put(kind, value);
        }
        put("uchar", x);
        (0..vertex).for_each(|_| put("float", 9.0));
    }
    for _ in 0..2 {
        for (kind, value) in [("int", 1.0), ("ushort", 1.0), ("double", 2.0)] {
            put(kind, value);
        }
    }
    for (kind, value) in [
        ("uchar", 1.0),
        (count, 3.0),
        (item, 2.0),
        (item, 0.0),
        (item, 1.0),
    ] {
        put(kind, value);
    }
    for (kind, value) in [("uchar", 1.0), ("float", 5.0), ("int", 6.0)] {
        put(kind, value);
    }
    file
}

#[test]
fn both_byte_orders_and_every_list_width_are_read() {
    const WHOLE: [&str; 12] = [
        "char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32",
        "uint", "uint32",
    ];
    for big in [false, true] {
        for count in WHOLE {
            for item in WHOLE.iter().chain(&["float", "float64"]) {
                let soup = soup("a.ply", binary(big, count, item, "\n"));
                assert_eq!(faces(&soup), [[2, 0, 1]], "{count} {item}");
                let seen: Vec<[f64; 3]> = soup.positions.iter().map(|&p| p.into()).collect();
                assert_eq!(seen, [[0.5, 0.0, 0.0], [1.5, 0.1, -1.0], [2.5, 0.2, -2.0]]);
            }
        }
        assert_eq!(
            faces(&soup("a.ply", binary(big, "uchar", "int", "\r\n"))),
            [[2, 0, 1]]
        );
    }
}

#[test]
fn every_cut_of_a_binary_file_is_told() {
    let whole = binary(true, "uint", "int", "\n");
    for length in 1..whole.len() {
        let text = refusal("cut.ply", &whole[..length]).to_string();
        assert!(text.contains("cut.ply (PLY), "), "{length}: {text}");
    }
}

fn strips(lists: &str) -> String {
    let rows = lists.lines().count();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
         property float z\nelement tristrips {rows}\nproperty list int int vertex_indices\n\
         end_header\n0 0 0\n{lists}\n"
    )
}

#[test]
fn strips_alternate_and_restart() {
    let read = |lists: &str| faces(&soup("a.ply", strips(lists)));
    assert_eq!(read("5 0 1 2 3 4"), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(
        read("9 0 1 2 3 -1 5 6 7 8"),
        [[0, 1, 2], [2, 1, 3], [5, 6, 7], [7, 6, 8]]
    );
    assert_eq!(
        read("4 0 1 2 3\n3 4 5 6"),
        [[0, 1, 2], [2, 1, 3], [4, 5, 6]]
    );
}

#[test]
fn a_repeated_index_steers_a_strip_and_is_no_face() {
    let read = faces(&soup("a.ply", strips("7 0 1 2 2 4 5 6")));
    assert_eq!(read, [[0, 1, 2], [4, 2, 5], [4, 5, 6]]);
}

#[test]
fn a_lying_header_is_told_before_anything_is_read() {
    for claim in ["4000000000", "18446744073709551615", "9223372036854775807"] {
        for element in ["vertex 4", "face 2"] {
            let (name, _) = element.split_once(' ').unwrap();
            let text = refusal("a.ply", TEXT.replace(element, &format!("{name} {claim}")));
            assert!(text.to_string().contains("a.ply (PLY), "), "{text}");
        }
    }
    // A record without properties takes no room, so any number of them fits.
    let empty = TEXT.replace("element face", "element void 4000000000\nelement face");
    assert_eq!(faces(&soup("a.ply", empty)).len(), 2);
}

/// A text of [`TEXT`], what it is replaced by, and what is then told.
const FAULTS: &[(&str, &str, &str)] = &[
    (
        "property uchar red",
        "property uchar x",
        "line 9: element `vertex` has property `x` twice",
    ),
    (
        "property uchar red",
        "property octet red",
        "line 9: `octet` is no PLY number type",
    ),
    (
        "element face 2",
        "element vertex 2",
        "line 11: element `vertex` is declared twice",
    ),
    (
        "element vertex 4",
        "element vertex -4",
        "line 5: the number of `vertex` elements is -4",
    ),
    (
        "element vertex 4",
        "element point 4",
        "the header has no element `vertex`",
    ),
    ("float z", "float w", "element `vertex` has no property `z`"),
    (
        "vertex_indices",
        "corners",
        "element `face` has no list `vertex_indices`",
    ),
    (
        "format ascii 1.0",
        "format morse 1.0",
        "line 2: the PLY encoding `morse`",
    ),
    (
        "format ascii 1.0",
        "format ascii 2.0",
        "line 2: PLY version `2.0`",
    ),
    ("format ascii 1.0\n", "", "the header has no `format` line"),
    (
        "obj_info",
        "object",
        "line 4: `object` is no header statement",
    ),
    (
        "1 1 0 7",
        "1 one 0 7",
        "vertex 2 (line 16): a value is `one`, which is no number",
    ),
    (
        "4 0 1 2 3",
        "4 0 1 2.5 3",
        "face 0 (line 18): a value is `2.5`, which is no whole",
    ),
    (
        "4 0 1 2 3",
        "-4 0 1 2 3",
        "face 0 (line 18): a list has length -4",
    ),
    (
        "3 0 1 -2\n",
        "3 0\n",
        "face 1 (line 19): the file ends early: 3 list items",
    ),
];

#[test]
fn faults_name_the_line_and_the_element() {
    for (from, to, expected) in FAULTS {
        let text = refusal("a.ply", TEXT.replacen(from, to, 1)).to_string();
        assert!(text.contains(expected), "{text}");
    }
}
