//! Files by SciPy, and what they do not hold.

use super::*;
use crate::io::tests::{ROWS, data, input, position, recording, refused, time, velocity};
use crate::io::{IoError, headers, read_recording};
use crate::recording::DriveUnit;

const COLUMNS: [(&str, &str, f64); 6] = [
    ("alpha1", "q(:,1)", 1.0),
    ("alpha2", "q(:,2)", 1.0),
    ("dalpha1", "dq(1,:)", 1.0),
    ("dalpha2", "dq(2,:)", 1.0),
    ("M1", "tau_128th(:,1)", 1.0 / 128.0),
    ("M2", "tau_128th(:,2)", 1.0 / 128.0),
];

#[test]
fn files_by_scipy_are_read_to_the_last_digit() {
    for name in ["v6.mat", "v7.mat"] {
        let r = recording(name, &COLUMNS);
        assert_eq!(r.len(), ROWS);
        for k in 0..ROWS {
            assert_eq!(r.t()[k], time(k), "{name}, row {k}");
            assert_eq!((r.alpha()[k], r.omega()[k]), (position(k), velocity(k)), "{name}, row {k}");
            assert_eq!(r.torque()[k], input(k), "{name}, row {k}");
        }
    }
}

#[test]
fn vectors_and_matrices_of_numbers_are_columns_and_nothing_else() {
    let names = headers(&data("v7.mat")).unwrap().names;
    let expected = [
        "t",
        "q(:,1)",
        "q(:,2)",
        "dq(1,:)",
        "dq(2,:)",
        "tau_128th(:,1)",
        "tau_128th(:,2)",
        "on",
        "short",
    ];
    assert_eq!(names, expected);
    assert_eq!(headers(&data("v6.mat")).unwrap().names, expected);
}

#[test]
fn vectors_of_different_length_are_refused_by_name() {
    let unit = DriveUnit::NewtonMetre;
    let mut columns = COLUMNS.to_vec();
    columns[5].1 = "short";
    let map = crate::io::tests::map(unit, &columns);
    let e = read_recording(&data("v7.mat"), &map, unit).unwrap_err();
    assert!(matches!(e, IoError::Unequal { length: 5, others: 60, .. }), "{e}");
    assert!(e.to_string().contains("`short` has 5 values and `t` has 60"), "{e}");
}

#[test]
fn other_versions_are_refused_with_how_to_save() {
    let mut v73 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: ".to_vec();
    v73.resize(512, 0);
    v73[124..128].copy_from_slice(&[0, 2, b'I', b'M']);
    v73.extend(b"\x89HDF\r\n\x1a\n");
    for bytes in [&v73[..], &v73[512..]] {
        let e = refused("x.mat", bytes);
        assert!(e.contains("version 7.3 (HDF5)") && e.contains("'-v7') or '-v6'"), "{e}");
    }
    // level 4 begins with the type of the first matrix
    let e = refused("x.mat", &[0; 200]);
    assert!(e.contains("not those of level 5") && e.contains("'-v7'"), "{e}");
}

/// A file with one variable `x` of this class, size and data, in either order of bytes.
fn file(class: u32, size: [u32; 2], kind: u32, data: &[u8], big_endian: bool) -> Vec<u8> {
    let int = |n: u32| if big_endian { n.to_be_bytes() } else { n.to_le_bytes() };
    let mut body = [6, 8, class, 0, 5, 8, size[0], size[1]].map(int).concat();
    // the name in the short form: size and type in one word
    body.extend(int(1 << 16 | 1));
    body.extend(b"x\0\0\0");
    body.extend([kind, data.len() as u32].map(int).concat());
    body.extend(data);
    body.resize(body.len().next_multiple_of(8), 0);
    let mut out = vec![b' '; 124];
    out.extend(if big_endian { [1, 0, b'M', b'I'] } else { [0, 1, b'I', b'M'] });
    out.extend([14, body.len() as u32].map(int).concat());
    out.extend(body);
    out
}

fn columns(bytes: &[u8], big_endian: bool) -> Vec<Column> {
    variables(bytes, big_endian).unwrap().into_iter().flat_map(|v| v.columns).collect()
}

#[test]
fn numbers_are_read_from_the_smallest_type_that_matlab_stores_them_in() {
    // a vector of doubles stored as signed 16 bits, from the high byte on
    let bytes = file(6, [3, 1], 3, &[0, 1, 0xff, 0xfe, 1, 0], true);
    assert_eq!(columns(&bytes, true), [("x".to_string(), vec![1.0, -2.0, 256.0])]);
    let bytes = file(6, [1, 3], 1, &[1, 0xff, 0x80], false);
    assert_eq!(columns(&bytes, false), [("x".to_string(), vec![1.0, -1.0, -128.0])]);
    let bytes = file(12, [1, 2], 5, &[1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff], false);
    assert_eq!(columns(&bytes, false), [("x".to_string(), vec![1.0, -1.0])]);
}

#[test]
fn damage_is_named_with_byte_variable_and_what_was_expected() {
    let e = refused("x.mat", &file(6, [4, 1], 1, &[1, 2, 3], false));
    assert!(e.contains("the variable at byte 128, variable `x`"), "{e}");
    assert!(e.contains("expected 4 x 1 numbers of 1 bytes, found 3 bytes"), "{e}");
    let e = refused("x.mat", &file(6, [u32::MAX, u32::MAX], 9, &[0; 8], false));
    assert!(e.contains("expected 4294967295 x 4294967295 numbers"), "{e}");
    let e = refused("x.mat", &file(6, [3, 1], 99, &[1, 2, 3], false));
    assert!(e.contains("expected a type of numbers, found type 99"), "{e}");
    let whole = file(6, [3, 1], 1, &[1, 2, 3], false);
    let e = refused("x.mat", &whole[..whole.len() - 1]);
    assert!(e.contains("byte 136: expected 56 bytes of a variable, found 55 bytes"), "{e}");
    let e = refused("x.mat", &file(2, [3, 1], 1, &[1, 2, 3], false));
    assert!(e.contains("no vectors of numbers") && e.contains("it contains: x (struct)"), "{e}");
    assert!(e.contains("'-struct'"), "{e}");
}

#[test]
fn compressed_data_unfold_to_no_more_than_there_is_room_for() {
    use std::io::Write;
    let mut zlib = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::best());
    zlib.write_all(&[0; 100_000]).unwrap();
    let bytes = zlib.finish().unwrap();
    assert_eq!(unfold(&bytes, 100_000).unwrap().len(), 100_000);
    let e = unfold(&bytes, 99_999).unwrap_err();
    assert!(e.expected.contains("at most 1024 MiB"), "{e:?}");
}

/// An element of a file with little-endian numbers.
fn of_type(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut out = [kind, data.len() as u32].map(u32::to_le_bytes).concat();
    out.extend(data);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// A variable of this class with its content behind size and name.
fn variable(class: u32, size: [u32; 2], name: &str, content: &[Vec<u8>]) -> Vec<u8> {
    let head = [class, 0].map(u32::to_le_bytes).concat();
    let size = size.map(u32::to_le_bytes).concat();
    let parts = [of_type(6, &head), of_type(5, &size), of_type(1, name.as_bytes())];
    of_type(MATRIX, &[&parts[..], content].concat().concat())
}

#[test]
fn the_text_of_a_signal_is_the_name_of_its_values() {
    let numbers = |values: [f64; 2]| {
        let data = values.map(f64::to_le_bytes).concat();
        variable(6, [2, 1], "", &[of_type(9, &data)])
    };
    let text = |text: &str| {
        let letters: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        variable(4, [1, text.len() as u32], "", &[of_type(4, &letters)])
    };
    let signals = |fields: [&str; 2], labels: [&str; 2]| {
        let names: Vec<u8> = fields.iter().flat_map(|f| format!("{f:\0<8}").into_bytes()).collect();
        let mut content = vec![of_type(5, &8_u32.to_le_bytes()), of_type(1, &names)];
        content.extend([numbers([1.0, 2.0]), text(labels[0])]);
        content.extend([numbers([3.0, 4.0]), text(labels[1])]);
        let mut all = vec![b' '; 124];
        all.extend([0, 1, b'I', b'M']);
        all.extend(variable(2, [1, 2], "s", &content));
        columns(&all, false)
    };
    let right = ("right speed [rpm]".to_string(), vec![1.0, 2.0]);
    let of_dspace = signals(["Data", "Name"], ["right speed [rpm]", "left speed [rpm]"]);
    assert_eq!(of_dspace[0], right);
    // a signal without a name, and a text that is no name
    let unnamed = signals(["values", "label"], ["right speed [rpm]", ""]);
    assert_eq!(unnamed, [right, ("s(2).values".into(), vec![3.0, 4.0])]);
    let other = signals(["values", "title"], ["right", "left"]);
    assert_eq!(other[0].0, "s(1).values");
}

#[test]
fn a_list_of_texts_beside_a_matrix_names_its_columns() {
    let doubles = |values: &[f64]| {
        of_type(9, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    };
    let text = |size: [u32; 2], text: &str| {
        let letters: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        variable(4, size, "", &[of_type(4, &letters)])
    };
    let cell = |name: &str, texts: &[&str]| {
        let cells: Vec<Vec<u8>> = texts.iter().map(|t| text([1, t.len() as u32], t)).collect();
        variable(1, [1, texts.len() as u32], name, &cells)
    };
    let matrix =
        |name: &str| variable(6, [3, 2], name, &[doubles(&[0.0, 0.1, 0.2, 1.0, 2.0, 3.0])]);
    let of = |written: &[Vec<u8>]| {
        let mut all = vec![b' '; 124];
        all.extend([0, 1, b'I', b'M']);
        written.iter().for_each(|v| all.extend(v));
        let mut variables = variables(&all, false).unwrap();
        listed::name_columns(&mut variables);
        let columns = variables.into_iter().flat_map(|v| v.columns);
        columns.map(|(name, _)| name).collect::<Vec<_>>()
    };
    let names = || cell("names", &["time", "right speed"]);
    assert_eq!(of(&[matrix("data"), names()]), ["time", "right speed"]);
    let other = cell("authors", &["A", "B"]);
    assert_eq!(of(&[matrix("data"), names(), other]), ["data(:,1)", "data(:,2)"]);
    let units = cell("units", &["rad", "rad"]);
    assert_eq!(of(&[matrix("data"), names(), units]), ["time [rad]", "right speed [rad]"]);
    // rows of letters of equal length, stored column after column
    let rows = variable(4, [2, 2], "labels", &[of_type(4, &[b't', 0, b'w', 0, b' ', 0, b'r', 0])]);
    assert_eq!(of(&[matrix("data"), rows]), ["t", "wr"]);
    // whose names they are is open
    let open = ["a(:,1)", "a(:,2)", "b(:,1)", "b(:,2)"];
    assert_eq!(of(&[matrix("a"), matrix("b"), names()]), open);
    let three = cell("names", &["time", "right", "left"]);
    assert_eq!(of(&[matrix("a"), three]), ["a(:,1)", "a(:,2)"]);
}
