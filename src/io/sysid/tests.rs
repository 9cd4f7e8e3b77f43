//! A file in SysId's layout, and objects that are none.

use std::f64::consts::TAU;

use super::*;
use crate::io::tests::{data, input, map, position, refused, time, velocity};
use crate::io::{headers, read_recording};
use crate::recording::DriveUnit;

#[test]
fn the_tests_of_a_file_become_one_recording_with_a_gap() {
    let names = [
        ("alpha1", "right_position", 1.0),
        ("alpha2", "left_position", 1.0),
        ("dalpha1", "right_velocity", 1.0),
        ("dalpha2", "left_velocity", 1.0),
        ("M1", "right_voltage", 1.0),
        ("M2", "left_voltage", 1.0),
    ];
    let map = map(DriveUnit::Volt, &names);
    let (r, _) = read_recording(&data("sysid.json"), &map, DriveUnit::Volt).unwrap();
    // rows 0 to 23 are one test, rows 36 to 59 another, which stands first in the file
    let rows: Vec<usize> = (0..24).chain(36..60).collect();
    assert_eq!((r.len(), r.pieces().len()), (rows.len(), 2));
    for (j, k) in rows.into_iter().enumerate() {
        assert_eq!(r.t()[j], time(k));
        // turns in the file
        assert_eq!(r.alpha()[j], position(k).map(|x| TAU * x));
        assert_eq!(r.omega()[j], velocity(k).map(|x| TAU * x));
        assert_eq!(r.torque()[j], input(k));
    }
    assert_eq!(headers(&data("sysid.json")).unwrap().names, DRIVETRAIN);
}

#[test]
fn the_rows_of_frc_characterization_are_read() {
    let row = |t: f64| format!("[{t}, 12.5, 0.2, 1.5, -2.5, 10, 20, 30, 40, 0.5]");
    let test = |k: usize| format!("\"{}\": [{}, {}]", TESTS[k], row(k as f64), row(k as f64 + 0.5));
    let text = format!("{{{}}}", [0, 1, 2, 3].map(test).join(", "));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.json");
    std::fs::write(&path, &text).unwrap();
    let found = read(&path, Some("fast-backward")).unwrap();
    let of = |name: &str| found.iter().find(|(n, _)| n == name).unwrap().1.clone();
    assert_eq!(of("t"), [3.0, 3.5]);
    assert_eq!((of("right_voltage [V]")[0], of("left_velocity")[1]), (-2.5, 30.0));
    assert_eq!(super::tests(&path).unwrap().len(), 4);
    std::fs::write(&path, text.replace(", 0.5]", "]")).unwrap();
    assert_eq!(read(&path, None).unwrap().len(), 9);
}

#[test]
fn other_objects_are_refused_with_what_is_missing() {
    let e = refused("x.json", b"{\"slow-forward\": [[1, 2, 3, 4]]}");
    assert!(e.contains("neither a `sysid` that is true nor"), "{e}");
    let e = refused("x.json", b"{\"sysid\": true, \"slow-forward\": []}");
    assert!(e.contains("expected tests such as slow-forward"), "{e}");
    let e = refused("x.json", b"{\"sysid\": true, \"slow-forward\": [[1, 2, 3]]}");
    assert!(e.contains("expected rows of 9 numbers (a drivetrain) or 4, found 3"), "{e}");
    let e = refused("x.json", b"{\"sysid\": true, \"a\": [[1, 2, 3, 4], [1, 2, \"x\", 4]]}");
    assert!(e.contains("a, row 2: expected a list of numbers"), "{e}");
    let e = refused("x.json", b"{\"sysid\": true, \"a\": [[1, 2, 3, 4], [1, 2, 3]]}");
    assert!(e.contains("expected 4 numbers in every row, found 3"), "{e}");
    let e = refused("x.json", b"[1, 2]");
    assert!(e.contains("x.json cannot be read as JSON: it has neither a `sysid`"), "{e}");
}

#[test]
fn a_file_that_is_cut_off_is_one_of_sysid_by_its_keys() {
    let e = refused("x.json", b"{\"sysid\": true, \"slow-forward\": [[1, 2");
    assert!(e.contains("cannot be read as SysId JSON: it ends within a list"), "{e}");
    let e = refused("x.json", b"{\"t\": [1, 2");
    assert!(e.contains("cannot be read as JSON: it ends within a list"), "{e}");
}

#[test]
fn a_value_that_is_no_number_is_missing_in_its_row() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.json");
    std::fs::write(&path, r#"{"sysid": true, "a": [[1, NaN, 3, 4], [2, 2, 3, 4]]}"#).unwrap();
    let found = read(&path, None).unwrap();
    assert!(found[1].1[0].is_nan() && found[1].1[1] == 2.0);
    let e = refused("x.json", b"{\"sysid\": true, \"a\": [[NaN, 2, 3, 4]]}");
    assert!(e.contains("a, row 1: expected a list of numbers"), "{e}");
}

#[test]
fn tests_from_before_and_after_a_restart_are_not_joined() {
    let e = refused(
        "x.json",
        b"{\"sysid\": true, \"a\": [[1, 0, 0, 0], [3, 0, 0, 0]], \"b\": [[2, 0, 0, 0]]}",
    );
    assert!(e.contains("b: expected a start after a, which ends at 3 s, found 2 s"), "{e}");
}
