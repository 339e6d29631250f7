//! npy files: kinds of numbers, orders, and what is refused.

use std::io::Cursor;
use std::path::Path;

use msplines_io::{Array, ReadError, WriteError, parse_npy, parse_soup, read_npy, write_npy};
use npyz::WriterBuilder as _;
use proptest::prelude::*;

use crate::common::scratch;

/// Returns a file of version 1.0 with this header text and these data.
fn file(header: &str, data: &[u8]) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(data);
    file
}

fn header(kind: &str, order: &str, shape: &str) -> String {
    format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}\n")
}

fn array(bytes: &[u8]) -> Array {
    parse_npy(Path::new("a.npy"), bytes).unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    parse_npy(Path::new("a.npy"), bytes)
        .unwrap_err()
        .to_string()
}

fn written(array: &Array) -> Vec<u8> {
    let (_directory, path) = scratch("a.npy");
    write_npy(&path, array).unwrap();
    assert_eq!(
        bits(&read_npy(&path).unwrap()),
        bits(array),
        "what is written is read back"
    );
    std::fs::read(&path).unwrap()
}

fn bits(array: &Array) -> (Vec<usize>, Vec<u64>) {
    let values = array.values.iter().map(|value| value.to_bits());
    (array.shape.clone(), values.collect())
}

#[test]
fn every_kind_of_number_is_read_in_both_byte_orders() {
    let expected = [1.0, -2.0, 100.0];
    type Bytes = fn(i8) -> Vec<u8>;
    let cases: [(&str, Bytes); 12] = [
        ("<f4", |x| f32::from(x).to_le_bytes().to_vec()),
        (">f4", |x| f32::from(x).to_be_bytes().to_vec()),
        ("<f8", |x| f64::from(x).to_le_bytes().to_vec()),
        (">f8", |x| f64::from(x).to_be_bytes().to_vec()),
        ("|i1", |x| x.to_le_bytes().to_vec()),
        ("<i1", |x| x.to_le_bytes().to_vec()),
        ("<i2", |x| i16::from(x).to_le_bytes().to_vec()),
        (">i2", |x| i16::from(x).to_be_bytes().to_vec()),
        ("<i4", |x| i32::from(x).to_le_bytes().to_vec()),
        (">i4", |x| i32::from(x).to_be_bytes().to_vec()),
        ("<i8", |x| i64::from(x).to_le_bytes().to_vec()),
        (">i8", |x| i64::from(x).to_be_bytes().to_vec()),
    ];
    for (kind, bytes) in cases {
        let data: Vec<u8> = [1, -2, 100].into_iter().flat_map(bytes).collect();
        let found = array(&file(&header(&format!("'{kind}'"), "False", "(3,)"), &data));
        assert_eq!(
            (found.shape, found.values),
            (vec![3], expected.to_vec()),
            "{kind}"
        );
    }
    for (kind, data, expected) in [
        ("|u1", vec![200], 200.0),
        ("<u2", vec![0, 255], 65_280.0),
        (">u2", vec![255, 0], 65_280.0),
        ("<u4", vec![0, 0, 0, 128], 2f64.powi(31)),
        (">u8", vec![255; 8], 2f64.powi(64)),
    ] {
        let found = array(&file(&header(&format!("'{kind}'"), "False", "(1,)"), &data));
        assert_eq!(found.values, [expected], "{kind}");
    }
}

#[test]
fn an_array_stored_by_columns_is_turned_into_rows() {
    let cube = |order| {
        array(&file(
            &header("'|u1'", order, "(2, 3, 2)"),
            &(0..12).collect::<Vec<u8>>(),
        ))
    };
    let by_rows: Vec<f64> = (0..12).map(f64::from).collect();
    assert_eq!(cube("False").values, by_rows);
    // Number (i, j, k) stands at i + 2 j + 6 k.
    let turned = [0., 6., 2., 8., 4., 10., 1., 7., 3., 9., 5., 11.];
    assert_eq!(cube("True").values, turned);
    assert_eq!(cube("True").shape, [2, 3, 2]);
    let matrix = array(&file(&header("'|u1'", "True", "(2, 2)"), &[0, 1, 2, 3]));
    assert_eq!(matrix.values, [0.0, 2.0, 1.0, 3.0]);
    let row = array(&file(&header("'|u1'", "True", "(3,)"), &[5, 6, 7]));
    assert_eq!(row.values, [5.0, 6.0, 7.0]);
}

#[test]
fn headers_of_all_versions_and_spellings_are_read() {
    let text = "{\"shape\":(2L ,1), 'fortran_order' : False,\n'descr':'<f4'}";
    assert_eq!(array(&file(text, &[0; 8])).shape, [2, 1]);
    for version in [2, 3] {
        let mut long = b"\x93NUMPY".to_vec();
        long.extend([version, 0]);
        long.extend((text.len() as u32).to_le_bytes());
        long.extend(text.as_bytes());
        long.extend([0; 8]);
        assert_eq!(array(&long).values, [0.0; 2]);
    }
    let huge = "99999999999999999999";
    for shape in [format!("(0, {huge})"), format!("({huge}, {huge}, 0)")] {
        assert!(
            array(&file(&header("'<f8'", "True", &shape), &[]))
                .values
                .is_empty()
        );
    }
}

#[test]
fn not_a_number_is_data() {
    let values = vec![f64::NAN, f64::INFINITY, -0.0, 1e-310];
    let read = array(&written(&Array {
        shape: vec![4],
        values,
    }));
    assert!(read.values[0].is_nan());
    assert_eq!(read.values[1], f64::INFINITY);
    assert_eq!(read.values[2].to_bits(), (-0.0f64).to_bits());
}

#[test]
fn other_kinds_of_data_are_refused_with_a_remedy() {
    let refused = |kind: &str, shape: &str| refusal(&file(&header(kind, "False", shape), &[0; 64]));
    let cases = [
        (
            refused("'|O'", "(8,)"),
            "byte 20: the type `|O` is not supported",
        ),
        (
            refused("[('x', '<f8'), ('y', '<f8')]", "(4,)"),
            "a structured type is not supported",
        ),
        (
            refused("'<c16'", "(4,)"),
            "the type `<c16` is not supported",
        ),
        (refused("'<f2'", "(4,)"), "the type `<f2` is not supported"),
        (refused("'|f8'", "(4,)"), "the type `|f8` is not supported"),
        (refused("'<U8'", "(4,)"), "the type `<U8` is not supported"),
        (
            refused("'<f8'", "()"),
            "an array without dimensions is not supported",
        ),
        (
            refused("'<f8'", "(1, 2, 2, 2)"),
            "more than 3 dimensions is not supported",
        ),
        (
            refused("'<f8'", &format!("({})", "1,".repeat(9_000))),
            "more than 3 dimensions",
        ),
    ];
    for (text, expected) in cases {
        assert!(text.starts_with("a.npy (npy), byte"), "{text}");
        assert!(text.contains(expected), "{text}");
    }
    assert!(refused("'|O'", "(8,)").ends_with("such as `array.astype(float)`"));
    assert!(refused("'<f8'", "()").ends_with("reshape it to one, two or three dimensions"));
}

#[test]
fn a_shape_beyond_the_file_is_refused_before_memory_is_taken() {
    let huge = "18446744073709551615";
    for shape in [
        format!("({huge}, {huge}, {huge})"),
        format!("({huge},)"),
        format!("(9{huge},)"),
        "(4294967296, 4294967296)".to_owned(),
        "(2305843009213693952, 1)".to_owned(),
        "(3,)".to_owned(),
    ] {
        for order in ["True", "False"] {
            let error = parse_npy(
                Path::new("a.npy"),
                &file(&header("'<f8'", order, &shape), &[0; 16]),
            );
            let error = error.unwrap_err();
            assert!(matches!(error, ReadError::Truncated { .. }), "{error}");
            assert!(error.to_string().contains("16 bytes are there"), "{error}");
        }
    }
    let more = refusal(&file(&header("'<f8'", "False", "(1,)"), &[0; 16]));
    assert!(
        more.contains("further bytes follow; save one array in each file"),
        "{more}"
    );
}

#[test]
fn damaged_files_are_refused_with_the_place() {
    let whole = file(&header("'<f8'", "False", "(2,)"), &[0; 16]);
    for length in 1..whole.len() {
        let text = refusal(&whole[..length]);
        assert!(text.starts_with("a.npy (npy), byte"), "{text}");
    }
    assert_eq!(refusal(b""), "a.npy is empty; export it again");
}

#[test]
fn headers_that_break_the_rules_are_refused_with_what_was_expected() {
    let good = header("'<f8'", "False", "(2,)");
    let cases = [
        (
            b"\x7fNUMPY\x01\x00".to_vec(),
            "byte 0: the file does not start with `\\x93NUMPY`",
        ),
        (
            file("{'descr'", &[]),
            "the header ends where `:` behind a key is expected",
        ),
        (
            file(&good.replace("'shape'", "'spin'"), &[]),
            "`spin` is unknown or repeated",
        ),
        (
            file(&good.replace("'shape': (2,), ", ""), &[]),
            "the header has no `shape`",
        ),
        (
            file(&good.replace("False", "0"), &[]),
            "where `True` or `False` is expected",
        ),
        (
            file(&good.replace("(2,)", "2"), &[]),
            "`2, }` stands where a shape in brackets",
        ),
        (
            file(&good.replace("(2,)", "(2 2)"), &[]),
            "stands where `,` or `)` is expected",
        ),
        (
            file(&good.replace('}', ""), &[]),
            "the header ends where a key is expected",
        ),
        (
            file(&good.replace('}', "}}"), &[]),
            "`}` stands where the end of the header",
        ),
    ];
    for (bytes, expected) in cases {
        let text = refusal(&bytes);
        assert!(text.contains(expected), "{text}");
    }
    let negative = refusal(&file(&good.replace("(2,)", "(-2,)"), &[0; 16]));
    assert!(
        negative.contains("`-2,), }` stands where a dimension is expected"),
        "{negative}"
    );
    let future = refusal(b"\x93NUMPY\x04\x00\x00\x00");
    assert!(
        future.contains("npy version 4.0 is not supported"),
        "{future}"
    );
    let deep = refusal(&file(&"(".repeat(60_000), &[]));
    assert!(deep.contains("where a dictionary is expected"), "{deep}");
}

#[test]
fn an_array_is_no_mesh() {
    let bytes = file(&header("'<f8'", "False", "(2,)"), &[0; 16]);
    let text = parse_soup(Path::new("a.npy"), &bytes)
        .unwrap_err()
        .to_string();
    let expected = "a.npy (npy), byte 0: an array as a mesh is not supported; give an OBJ";
    assert!(text.starts_with(expected), "{text}");
}

#[test]
fn an_array_unfit_to_write_is_refused_and_leaves_nothing() {
    let (directory, path) = scratch("a.npy");
    for (shape, values) in [
        (vec![2, 3], 5),
        (vec![], 1),
        (vec![1; 4], 1),
        (vec![usize::MAX, 2, 1], 0),
    ] {
        let values = vec![0.0; values];
        let refused = write_npy(&path, &Array { shape, values }).unwrap_err();
        assert!(matches!(refused, WriteError::ArrayShape { .. }));
        let text = refused.to_string();
        assert!(text.contains("give one to three dimensions"), "{text}");
    }
    assert_eq!(directory.path().read_dir().unwrap().count(), 0);
}

#[test]
fn npyz_reads_what_we_write() {
    let values: Vec<f64> = (0..12).map(|i| f64::from(i).sqrt()).collect();
    for shape in [vec![12], vec![3, 4], vec![2, 1, 6]] {
        let bytes = written(&Array {
            shape: shape.clone(),
            values: values.clone(),
        });
        assert_eq!((bytes.len() - 8 * 12) % 64, 0, "the data are aligned");
        let read = npyz::NpyFile::new(&bytes[..]).unwrap();
        let expected: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
        assert_eq!(read.shape(), expected);
        assert_eq!(read.order(), npyz::Order::C);
        assert_eq!(read.into_vec::<f64>().unwrap(), values);
    }
}

#[test]
fn we_read_what_npyz_writes() {
    for order in [npyz::Order::C, npyz::Order::Fortran] {
        let mut bytes = Cursor::new(Vec::new());
        let options = npyz::WriteOptions::<i32>::new()
            .dtype(npyz::DType::new_scalar(">i4".parse().unwrap()))
            .order(order)
            .shape(&[2, 3])
            .writer(&mut bytes);
        let mut writer = options.begin_nd().unwrap();
        writer.extend([1, 2, 3, 4, 5, -6]).unwrap();
        writer.finish().unwrap();
        let found = array(bytes.get_ref());
        assert_eq!(found.shape, [2, 3]);
        assert_eq!(
            found.values,
            match order {
                npyz::Order::C => [1., 2., 3., 4., 5., -6.],
                npyz::Order::Fortran => [1., 3., 5., 2., 4., -6.],
            }
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_array_is_read_back_bit_by_bit(
        shape in prop::collection::vec(0usize..5, 1..4),
        seed in prop::collection::vec(any::<u64>(), 64),
    ) {
        let count = shape.iter().product::<usize>();
        let values = seed.iter().take(count).map(|&bits| f64::from_bits(bits)).collect();
        written(&Array { shape, values });
    }
}
