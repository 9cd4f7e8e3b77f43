//! Recordings that other programs wrote, through the same door as any other, and files that were
//! changed or cut short.

use std::path::{Path, PathBuf};

use super::*;
use crate::recording::{DriveUnit, Recording};

/// Rows of every file in `tests/data`.
pub(super) const ROWS: usize = 60;

/// A file of `tests/data`, which `make.py` there wrote.
pub(super) fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Wheel angles of row k, right first \[rad\]: the formula in `make.py`, as the next two.
pub(super) fn position(k: usize) -> [f64; 2] {
    let k = k as f64;
    [k * k / 64.0, k / 8.0]
}

/// Wheel speeds of row k [rad/s].
pub(super) fn velocity(k: usize) -> [f64; 2] {
    [k as f64 / 32.0, -0.5]
}

/// Torques of row k [N m].
pub(super) fn input(k: usize) -> [f64; 2] {
    [(k % 7) as f64 / 16.0, -(k as f64) / 128.0]
}

/// Time of row k where the file holds it as a float \[s\].
pub(super) fn time(k: usize) -> f64 {
    k as f64 / 128.0
}

/// A map from contract names to names in the file, with a factor.
pub(super) fn map(unit: DriveUnit, columns: &[(&str, &str, f64)]) -> ColumnMap {
    let mut map = ColumnMap::new(unit, None);
    for (key, name, scale) in columns {
        map.set(key, name, None, *scale).unwrap();
    }
    map
}

/// Reads a file of `tests/data`.
pub(super) fn recording(name: &str, columns: &[(&str, &str, f64)]) -> Recording {
    let unit = DriveUnit::NewtonMetre;
    read_recording(&data(name), &map(unit, columns), unit).unwrap().0
}

/// What is said of these bytes under this name.
pub(super) fn refused(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write_whole(&path, bytes).unwrap();
    headers(&path).unwrap_err().to_string()
}

/// Columns of the files in `tests/data`.
const FILES: [(&str, [(&str, &str); 6]); 6] = [
    (
        "drive.wpilog",
        [
            ("alpha1", "/drive/position[0]"),
            ("alpha2", "/drive/position[1]"),
            ("dalpha1", "/drive/right/velocity"),
            ("dalpha2", "/drive/left/velocity"),
            ("M1", "/drive/right/torque_128th"),
            ("M2", "/drive/left/torque_128th"),
        ],
    ),
    (
        "joint_states.mcap",
        [
            ("alpha1", "right_wheel.position"),
            ("alpha2", "left_wheel.position"),
            ("dalpha1", "right_wheel.velocity"),
            ("dalpha2", "left_wheel.velocity"),
            ("M1", "right_wheel.effort"),
            ("M2", "left_wheel.effort"),
        ],
    ),
    (
        "two_topics.mcap",
        [
            ("alpha1", "/states/right.position"),
            ("alpha2", "/states/left.position"),
            ("dalpha1", "/states/right.velocity"),
            ("dalpha2", "/states/left.velocity"),
            ("M1", "/commands/right.effort"),
            ("M2", "/commands/left.effort"),
        ],
    ),
    ("v6.mat", MAT),
    ("v7.mat", MAT),
    (
        "sysid.json",
        [
            ("alpha1", "right_position"),
            ("alpha2", "left_position"),
            ("dalpha1", "right_velocity"),
            ("dalpha2", "left_velocity"),
            ("M1", "right_voltage"),
            ("M2", "left_voltage"),
        ],
    ),
];

const MAT: [(&str, &str); 6] = [
    ("alpha1", "q(:,1)"),
    ("alpha2", "q(:,2)"),
    ("dalpha1", "dq(1,:)"),
    ("dalpha2", "dq(2,:)"),
    ("M1", "tau_128th(:,1)"),
    ("M2", "tau_128th(:,2)"),
];

/// Reads a file under every format's eyes; whatever comes out, it must come out.
fn read_all(name: &str, bytes: &[u8]) -> Option<Recording> {
    let (_, columns) = FILES.iter().find(|(file, _)| *file == name).unwrap();
    let unit = if name == "sysid.json" { DriveUnit::Volt } else { DriveUnit::NewtonMetre };
    let columns: Vec<_> = columns.iter().map(|(key, name)| (*key, *name, 1.0)).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write_whole(&path, bytes).unwrap();
    let read = read_recording(&path, &map(unit, &columns), unit);
    read.map(|(recording, _)| recording).ok()
}

fn original(name: &str) -> Vec<u8> {
    std::fs::read(data(name)).unwrap()
}

#[test]
fn the_files_themselves_are_read() {
    for (name, _) in FILES {
        assert!(read_all(name, &original(name)).is_some(), "{name}");
    }
}

#[test]
fn what_is_read_from_a_file_that_was_cut_is_its_beginning() {
    for (name, _) in FILES {
        let bytes = original(name);
        let whole = read_all(name, &bytes).unwrap();
        // a prime, so that cuts fall on every place within records
        for length in (0..bytes.len()).step_by(13) {
            let Some(part) = read_all(name, &bytes[..length]) else { continue };
            let rows = part.len();
            // only a WPILOG may end early; a MAT has no end mark, so variables may be missing
            assert!(rows == whole.len() || name == "drive.wpilog", "{name} cut to {length}");
            assert_eq!(part.t(), &whole.t()[..rows], "{name} cut to {length}");
            // in the last row the cut may part signals that were logged at the same moment
            let sure = rows - usize::from(rows < whole.len());
            assert_eq!(part.torque()[..sure], whole.torque()[..sure], "{name} cut to {length}");
        }
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(500))]

    #[test]
    fn changed_files_give_a_recording_or_an_error(
        edits in proptest::collection::vec((0_usize..10_000, proptest::num::u8::ANY), 1..20),
        cut in 0_usize..20_000,
    ) {
        for (name, _) in FILES {
            let mut bytes = original(name);
            for (at, byte) in &edits {
                let place = at % bytes.len();
                bytes[place] = *byte;
            }
            bytes.truncate(cut.max(1));
            let _ = read_all(name, &bytes);
        }
    }

    #[test]
    fn any_bytes_behind_a_right_beginning_give_a_recording_or_an_error(
        bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400),
        kept in 0_usize..200,
    ) {
        for (name, _) in FILES {
            let mut all = original(name)[..kept].to_vec();
            all.extend(&bytes);
            let _ = read_all(name, &all);
        }
    }
}

#[test]
fn a_name_that_says_another_format_is_refused_with_the_right_one() {
    let e = refused("run.csv", &original("drive.wpilog"));
    assert!(
        e.contains("run.csv does not have the format of its name") && e.contains("end in .wpilog"),
        "{e}"
    );
    let e = refused("run.mat", &original("joint_states.mcap"));
    assert!(e.contains("end in .mcap"), "{e}");
    let e = refused("run.wpilog", &original("v7.mat"));
    assert!(e.contains("end in .mat"), "{e}");
    assert!(refused("run.mcap", b"").contains("run.mcap is empty"));
    let e = refused("run.mcap", b"t,dalpha1,dalpha2,M1,M2\n0,0,0,0,0\n");
    assert!(e.contains("run.mcap cannot be read as MCAP") && e.contains("mark of an MCAP"), "{e}");
    let e = refused("run.wpilog", b"t,dalpha1,dalpha2,M1,M2\n0,0,0,0,0\n");
    assert!(e.contains("byte 0: expected `WPILOG`"), "{e}");
}

#[test]
fn bags_that_need_another_program_first_name_it() {
    let e = refused("bag.db3", b"SQLite format 3\0 and so on");
    assert!(e.contains("ros2 bag convert"), "{e}");
    let e = refused("run.bag", b"#ROSBAG V2.0\n and so on");
    assert!(e.contains("rosbags-convert"), "{e}");
}

/// Reads a text as a recording.
fn text(content: &str, map: &ColumnMap) -> Result<Recording, IoError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    write_whole(&path, content.as_bytes()).unwrap();
    read_recording(&path, map, DriveUnit::NewtonMetre).map(|(recording, _)| recording)
}

#[test]
fn a_column_without_unit_leaves_those_of_the_others() {
    for none in ["-", "none", "n/a", "1", "[-]", "hh:mm:ss", "", "degC", "°C"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let rows: String = (0..40).map(|k| format!("{k},1.5,-2,16.2,-15,{}\n", k % 3)).collect();
        let text = format!("Time,rpm L,rpm R,Tq L,Tq R,State\ns,rpm,rpm,mNm,mNm,{none}\n{rows}");
        write_whole(&path, text.as_bytes()).unwrap();
        let found = preview(&path).unwrap();
        let names: Vec<&str> = found.iter().map(|c| c.name.as_str()).collect();
        let expected = ["Time [s]", "rpm L [rpm]", "rpm R [rpm]", "Tq L [mNm]", "Tq R [mNm]"];
        assert_eq!((&names[..5], found[0].values.len()), (&expected[..], 40), "{none}");
    }
}

#[test]
fn a_line_of_units_below_the_names_counts() {
    let mut log = String::from("# logger 3\nt,dalpha1,dalpha2,M1,M2\nms,rpm,rpm,Nm,mNm\n");
    for k in 0..30 {
        log += &format!("{},{},{},{},{}\n", 20 * k, 60 * (k % 5), 30, k, 1000 * k);
    }
    let read = text(&log, &ColumnMap::default()).unwrap();
    assert_eq!(read.len(), 30);
    assert!((read.t()[29] - 0.58).abs() < 1e-12);
    let turn = std::f64::consts::TAU;
    assert!((read.omega()[4][0] - 4.0 * turn).abs() < 1e-9);
    assert!((read.torque()[7][0] - 7.0).abs() < 1e-12 && (read.torque()[7][1] - 7.0).abs() < 1e-12);
    // rows count from the first row of numbers, and lines from the top
    let wrong = log.replace("40,120", "x,120");
    let error = text(&wrong, &ColumnMap::default()).unwrap_err().to_string();
    assert!(error.contains("row 3") && error.contains("line 6"), "{error}");
}

#[test]
fn rows_of_one_joint_each_are_put_side_by_side() {
    let mut log = String::from("stamp,joint,position,velocity,effort\n");
    for k in 0..40 {
        let t = 0.02 * f64::from(k);
        let (right, left) = (0.1 * f64::from(k), 0.2 * f64::from(k));
        log += &format!("{t:.2},left_wheel,{left},{},0.3\n", f64::from(k % 3));
        log += &format!("{t:.2},right_wheel,{right},{},0.4\n", f64::from(k % 4));
    }
    let map = map(
        DriveUnit::NewtonMetre,
        &[
            ("t", "stamp", 1.0),
            ("alpha1", "position.right_wheel", 1.0),
            ("alpha2", "position.left_wheel", 1.0),
            ("dalpha1", "velocity.right_wheel", 1.0),
            ("dalpha2", "velocity.left_wheel", 1.0),
            ("M1", "effort.right_wheel", 1.0),
            ("M2", "effort.left_wheel", 1.0),
        ],
    );
    let read = text(&log, &map).unwrap();
    assert_eq!(read.len(), 40);
    assert_eq!(read.omega()[7], [3.0, 1.0]);
    assert_eq!(read.torque()[39], [0.4, 0.3]);
}
