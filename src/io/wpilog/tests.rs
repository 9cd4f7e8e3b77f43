//! A log by WPILib, and logs made of bytes as the specification prints them.

use super::*;
use crate::io::headers;
use crate::io::tests::{ROWS, data, input, position, recording, refused, velocity};

#[test]
fn a_log_by_wpilib_is_read_to_the_last_digit() {
    let r = recording(
        "drive.wpilog",
        &[
            ("alpha1", "/drive/position[0]", 1.0),
            ("alpha2", "/drive/position[1]", 1.0),
            ("dalpha1", "/drive/right/velocity", 1.0),
            ("dalpha2", "/drive/left/velocity", 1.0),
            ("M1", "/drive/right/torque_128th", 1.0 / 128.0),
            ("M2", "/drive/left/torque_128th", 1.0 / 128.0),
        ],
    );
    assert_eq!(r.len(), ROWS);
    for k in 0..ROWS {
        // whole microseconds over a million: the nearest float
        assert_eq!(r.t()[k], (10_000 * k) as f64 / 1e6);
        assert_eq!((r.alpha()[k], r.omega()[k]), (position(k), velocity(k)), "row {k}");
        // recorded at every second row, 1 ms before it, and held
        assert_eq!(r.torque()[k], input(k - k % 2), "row {k}");
    }
}

#[test]
fn every_entry_of_numbers_is_a_column() {
    let names = headers(&data("drive.wpilog")).unwrap().names;
    let expected = [
        "t",
        "/drive/position[0]",
        "/drive/position[1]",
        "/drive/right/velocity",
        "/drive/left/velocity",
        "/drive/right/torque_128th",
        "/drive/left/torque_128th",
        "/enabled",
        "/fast",
    ];
    assert_eq!(names, expected);
}

/// The header and the start record that the specification prints, for entry 1, `test`, int64.
fn printed() -> Vec<u8> {
    let mut bytes = b"WPILOG\x00\x01\x00\x00\x00\x00".to_vec();
    bytes.extend(b"\x20\x00\x1a\x40\x42\x0f\x00\x01\x00\x00\x00\x04\x00\x00\x00test");
    bytes.extend(b"\x05\x00\x00\x00int64\x00\x00\x00\x00");
    bytes
}

/// The record that the specification prints: 3 at one second.
const THREE: &[u8] = b"\x20\x01\x08\x40\x42\x0f\x03\x00\x00\x00\x00\x00\x00\x00";

#[test]
fn the_records_that_the_specification_prints_are_understood() {
    let mut bytes = [&printed(), THREE].concat();
    // metadata and finish, as printed there too
    bytes
        .extend(b"\x20\x00\x18\x40\x42\x0f\x02\x01\x00\x00\x00\x0f\x00\x00\x00{\"source\":\"NT\"}");
    bytes.extend(b"\x20\x00\x05\x40\x42\x0f\x01\x01\x00\x00\x00");
    let signals = parse(&bytes).unwrap();
    let names = ["t".to_string(), "test".to_string()];
    assert_eq!(signals.names(), names);
    let frame = signals.frame(Path::new("x"), &names, |_| true).unwrap();
    assert_eq!(frame.column("test").unwrap().f64().unwrap().get(0), Some(3.0));
    // nothing may follow a finish
    bytes.extend(THREE);
    let e = parse(&bytes).unwrap_err();
    assert_eq!(e.found, "entry 1, which was not");
}

#[test]
fn a_last_record_that_was_cut_off_and_zeros_are_passed_over() {
    let whole = parse(&[&printed(), THREE].concat()).unwrap();
    for cut in 1..THREE.len() {
        let bytes = [&printed(), THREE, &THREE[..cut]].concat();
        assert_eq!(parse(&bytes).unwrap(), whole);
    }
    assert_eq!(parse(&[&printed(), THREE, &[0; 100]].concat()).unwrap(), whole);
}

#[test]
fn damage_is_named_with_byte_entry_and_what_was_expected() {
    let e = refused("x.wpilog", &[&printed(), &b"\x00\x01\x07\x00abcdefg"[..]].concat());
    // twelve bytes of header and 32 of the start record
    assert!(e.contains("x.wpilog is damaged or not a WPILOG file: the record at byte 44"), "{e}");
    assert!(e.contains("entry `test`: expected 8 bytes, found 7 bytes"), "{e}");
    let e = refused("x.wpilog", &[&printed(), &b"\x00\x02\x00\x00"[..]].concat());
    assert!(e.contains("started before, found entry 2, which was not"), "{e}");
    let e = refused("x.wpilog", &[&printed(), &b"\x80\x02\x00\x00"[..]].concat());
    assert!(e.contains("byte 44: expected a record"), "{e}");
    let e = refused("x.wpilog", &[&printed(), &b"\x0c\x01\xff\xff\xff\xff\x00"[..]].concat());
    assert!(e.contains("byte 51: expected 4294967295 bytes of payload"), "{e}");
    let e =
        refused("x.wpilog", &[&printed(), &b"\x00\x00\x05\x00\x09\x01\x00\x00\x00"[..]].concat());
    assert!(e.contains("control record: expected 0 (start)"), "{e}");
    let e = refused("x.wpilog", &[&printed(), &b"\x00\x00\x03\x00\x00ab"[..]].concat());
    assert!(e.contains("4 bytes of entry, found 2 bytes before the end"), "{e}");
    let e = refused("x.wpilog", b"WPILOG\x00\x02\x00\x00\x00\x00");
    assert!(e.contains("byte 6: expected version 1, found version 2.0"), "{e}");
    let e = refused("x.wpilog", &printed());
    assert!(e.contains("this WPILOG file contains no entries of numbers"), "{e}");
}
