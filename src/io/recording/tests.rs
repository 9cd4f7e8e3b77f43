//! Right files in every dress, and every way to get one wrong.

use std::f64::consts::TAU;
use std::path::PathBuf;

use super::*;
use crate::io::{Column, TableColumn, write_csv, write_parquet_table, write_whole};

const HEADER: &str = "t,alpha1,alpha2,dalpha1,dalpha2,M1,M2";

/// A file in a folder of its own.
struct Scratch {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Scratch {
    fn new(name: &str, bytes: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        write_whole(&path, bytes.as_ref()).unwrap();
        Self { _folder: folder, path }
    }

    fn read(&self) -> Result<Recording, IoError> {
        self.read_as(&ColumnMap::default())
    }

    fn read_as(&self, map: &ColumnMap) -> Result<Recording, IoError> {
        read_recording(&self.path, map, DriveUnit::NewtonMetre).map(|(r, _)| r)
    }
}

/// Row k of an ordinary recording, from 0.
fn row(k: usize) -> [f64; 7] {
    let t = 0.01 * k as f64;
    [t, t.sin(), 0.5 * t, t.cos(), 0.5, 0.1 * t, -0.25]
}

fn text(row: &[f64]) -> String {
    row.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

fn lines(count: usize) -> Vec<String> {
    std::iter::once(HEADER.to_string()).chain((0..count).map(|k| text(&row(k)))).collect()
}

/// What is said of an ordinary recording with a line replaced; line 0 is the header.
fn with_line(line: usize, text: &str) -> String {
    let mut lines = lines(40);
    lines[line] = text.into();
    refused(lines.join("\n"))
}

fn refused(bytes: impl AsRef<[u8]>) -> String {
    Scratch::new("run.csv", bytes).read().unwrap_err().to_string()
}

fn assert_same(a: &Recording, b: &Recording) {
    assert_eq!(a.t(), b.t());
    assert_eq!(a.alpha(), b.alpha());
    assert_eq!(a.omega(), b.omega());
    assert_eq!(a.torque(), b.torque());
}

#[test]
fn what_is_written_is_read_back_to_the_last_digit() {
    let first = Scratch::new("run.csv", lines(40).join("\n")).read().unwrap();
    assert_eq!(first.alpha()[17], [row(17)[1], row(17)[2]]);
    let again = Scratch::new("run.csv", write_csv(&first)).read().unwrap();
    assert_same(&first, &again);
    let columns: Vec<TableColumn> = HEADER
        .split(',')
        .enumerate()
        .map(|(j, name)| TableColumn::Number(name.into(), (0..40).map(|k| row(k)[j]).collect()))
        .collect();
    let bytes = write_parquet_table(Path::new("run.parquet"), &columns).unwrap();
    assert_same(&first, &Scratch::new("run.parquet", bytes).read().unwrap());
}

#[test]
fn the_dress_of_a_table_changes_nothing() {
    let plain = Scratch::new("run.csv", lines(40).join("\n")).read().unwrap();
    let semicolons = lines(40).join("\n").replace(',', ";");
    let mut commented = lines(40);
    commented.insert(20, "# a wheel was touched here".into());
    commented.insert(0, "# floor run".into());
    commented.push("\n\n".into());
    let dresses = [
        semicolons.clone(),
        semicolons.replace('.', ","),
        lines(40).join("\n").replace(',', "\t"),
        lines(40).join("\n").replace(',', " , "),
        format!("\u{feff}{}", lines(40).join("\r\n")),
        commented.join("\n"),
        lines(40).join(",\n"),
        lines(40).join(",other\n").replace("-0.25,other", "-0.25,words") + ",words",
        HEADER.split(',').map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(",")
            + "\n"
            + &lines(40)[1..].join("\n"),
    ];
    for dress in dresses {
        assert_same(&plain, &Scratch::new("run.csv", &dress).read().expect(&dress[..200]));
    }
}

#[test]
fn names_units_factors_and_offsets_are_applied() {
    let rows = (0..40).map(|k| {
        let [t, a1, a2, w1, w2, m1, m2] = row(k);
        let cells = [1e3 * t, a1 / TAU * 500.0, a2.to_degrees(), w1 * 60.0 / TAU, w2 * 0.05];
        format!(
            "{};{}",
            text(&cells).replace(',', ";"),
            text(&[-10.0 * m1, m2 + 0.5]).replace(',', ";")
        )
    });
    let header = "ms;enc;left [deg];rpm;v [m/s];current;tau";
    let body = rows.collect::<Vec<_>>().join("\n");
    let mut map = ColumnMap::new(DriveUnit::NewtonMetre, Some(0.05));
    map.set("t", "ms", Some("ms"), 1.0).unwrap();
    map.put("alpha1", Column { per_turn: Some(500.0), ..Column::new("enc") }).unwrap();
    map.set("alpha2", "left", None, 1.0).unwrap();
    map.set("dalpha1", "rpm", Some("rpm"), 1.0).unwrap();
    map.set("dalpha2", "v", None, 1.0).unwrap();
    let current = Column { torque_constant: Some(0.1), scale: -1.0, ..Column::new("current") };
    map.put("M1", current).unwrap();
    map.put("M2", Column { offset: -0.5, ..Column::new("tau") }).unwrap();
    let read = Scratch::new("run.csv", format!("{header}\n{body}")).read_as(&map).unwrap();
    for k in 0..40 {
        let [t, a1, a2, w1, w2, m1, m2] = row(k);
        let read = [
            (read.t()[k], t),
            (read.alpha()[k][0], a1),
            (read.alpha()[k][1], a2),
            (read.omega()[k][0], w1),
            (read.omega()[k][1], w2),
            (read.torque()[k][0], m1),
            (read.torque()[k][1], m2),
        ];
        // a few roundings of numbers of size one
        assert!(read.iter().all(|(a, b)| (a - b).abs() < 1e-14), "{k}: {read:?}");
    }
}

#[test]
fn the_torques_of_two_motors_of_a_side_are_added() {
    let row = |k: usize| {
        let t = 0.01 * k as f64;
        // the second motor of the left side is written in every other row
        let slow = if k.is_multiple_of(2) { "0.25" } else { "" };
        format!("{t},{},1,{t},0.5,-0.25,{slow}", 1.0 + t)
    };
    let rows = (0..40).map(row).collect::<Vec<_>>().join("\n");
    let text = |unit: &str| format!("t,dalpha1,dalpha2,a [mN m],b [{unit}],c,d\n{rows}");
    let map = |plus: &str| {
        let mut map = ColumnMap::default();
        let column =
            |name: &str, plus: &str| Column { plus: vec![plus.into()], ..Column::new(name) };
        map.put("M1", column("a", plus)).unwrap();
        map.put("M2", Column { offset: 0.5, scale: 2.0, ..column("c", "d") }).unwrap();
        map
    };
    let r = Scratch::new("run.csv", text("mN m")).read_as(&map("b [mN m]")).unwrap();
    for k in 0..40 {
        let [a, b] = r.torque()[k];
        assert!((a - 1e-3 * (0.01 * k as f64 + 0.5)).abs() < 1e-15 && b == 0.5, "{a} {b}");
    }
    let refused = |unit: &str, plus: &str| {
        Scratch::new("run.csv", text(unit)).read_as(&map(plus)).unwrap_err().to_string()
    };
    let e = refused("N m", "b [N m]");
    assert!(e.contains("columns.M1.plus: the header states `mN m` for `a [mN m]`"), "{e}");
    let e = refused("mN m", "e [mN m]");
    assert!(e.contains("no column `e [mN m]`") && e.contains("M1.plus = [\"…\"]"), "{e}");
}

#[test]
fn thousands_and_quoted_decimal_commas_are_read() {
    let number = |x: f64, is_german: bool| {
        let digits = format!("{:.2}", x.abs() % 1000.0);
        let thousands = (x.abs() / 1000.0).floor();
        let text = if thousands > 0.0 { format!("{thousands},{digits:0>6}") } else { digits };
        let sign = if x < 0.0 { "-" } else { "" };
        let swapped = |c: char| match c {
            ',' => '.',
            '.' => ',',
            c => c,
        };
        format!("{sign}{}", if is_german { text.chars().map(swapped).collect() } else { text })
    };
    let rows = |separator: &str, is_german: bool, factor: f64| {
        let row = |k: u32| {
            let x = f64::from(k);
            let cells =
                [10.0 * x, factor * (x - 150.0), 0.63, -0.25, 0.5].map(|x| number(x, is_german));
            cells.map(|c| format!("\"{c}\"")).join(separator)
        };
        (0..300).map(row).collect::<Vec<_>>().join("\n")
    };
    let mut map = ColumnMap::default();
    map.set("t", "t", Some("ms"), 1.0).unwrap();
    for (separator, is_german, factor) in
        [(",", false, 9.5), (";", true, 9.5), (";", false, 9.5), (",", true, 0.5)]
    {
        let header = ["t", "dalpha1", "dalpha2", "M1", "M2"].join(separator);
        let text = format!("{header}\n{}", rows(separator, is_german, factor));
        let r = Scratch::new("run.csv", text).read_as(&map).unwrap();
        assert!((r.t()[299] - 2.99).abs() < 1e-12, "{separator} {is_german}: {}", r.t()[299]);
        assert_eq!((r.omega()[299], r.torque()[0]), ([149.0 * factor, 0.63], [-0.25, 0.5]));
    }
}

#[test]
fn units_below_the_names_beside_lines_of_types_are_read() {
    let rows: Vec<String> = (0..40).map(|k| format!("{},90,180,0.1,-0.2", 10 * k)).collect();
    let head = "t,dalpha1,dalpha2,M1,M2\nSimTime: double,double,double,double,double\n\
                Units: ms,Units: deg/s,Units: deg/s,Units: N*m,Units: N*m\n\
                Interp: linear,Interp: linear,Interp: linear,Interp: zoh,Interp: zoh";
    let r = Scratch::new("run.csv", format!("{head}\n{}", rows.join("\n"))).read().unwrap();
    assert_eq!((r.len(), r.t()[39], r.torque()[39]), (40, 0.39, [0.1, -0.2]));
    assert!((r.omega()[0][0] - TAU / 4.0).abs() < 1e-12);
}

#[test]
fn one_column_may_stand_for_both_wheels_and_a_calendar_starts_at_zero() {
    let body: Vec<String> = (0..30)
        .map(|k| format!("{},{},{}", 1_700_000_000_000_000_000_i64 + 10_000_000 * k, k, 0.5))
        .collect();
    let file = Scratch::new("run.csv", format!("stamp,q,tau\n{}", body.join("\n")));
    let mut map = ColumnMap::default();
    map.set("t", "stamp", Some("ns"), 1.0).unwrap();
    for (key, name) in [("alpha1", "q"), ("alpha2", "q"), ("M1", "tau"), ("M2", "tau")] {
        map.set(key, name, None, 1.0).unwrap();
    }
    let r = file.read_as(&map).unwrap();
    assert!(r.is_single_axis() && r.t()[0] == 0.0);
    // doubles near 1.7e18 are 256 apart
    assert!((r.t()[29] - 0.29).abs() < 3e-7);
}

#[test]
fn files_without_data_are_named() {
    assert!(refused("").contains("run.csv is empty"));
    assert!(refused("# nothing\n\n").contains("is empty"));
    assert!(refused(format!("{HEADER}\n")).contains("no row of data below it"));
    assert!(refused(HEADER).contains("no row of data below it"));
    assert!(refused(lines(1).join("\n")).contains("1 samples; at least 10"));
    assert!(refused(lines(2).join("\n")).contains("2 samples; at least 10"));
    assert!(refused(lines(40)[1..].join("\n")).contains("the first line contains numbers"));
    let folder = tempfile::tempdir().unwrap();
    let read = |p: &Path| {
        read_recording(p, &ColumnMap::default(), DriveUnit::Volt).unwrap_err().to_string()
    };
    assert!(read(folder.path()).contains("is a directory; expected a recording"));
    assert!(read(&folder.path().join("gone.csv")).contains("gone.csv: No such file"));
}

#[test]
fn missing_and_repeated_columns_are_named() {
    let e = with_line(0, "t,alpha1,alpha2,dalpha1,dalpha2,M1,M_2");
    assert!(e.contains("no column `M2` (did you mean `M_2`?)") && e.contains("dalpha2, M1"), "{e}");
    let e = with_line(0, "t,x,y,z,dalpha2,M1,M2");
    assert!(e.contains("no column `dalpha1`"), "{e}");
    let e = with_line(0, "t,alpha1,alpha2,dalpha1,M1,M1,M2");
    assert!(e.contains("two columns are called `M1`"), "{e}");
    let e = with_line(0, "t,alpha1,alpha2,dalpha1 [furlongs],dalpha2,M1,M2");
    assert!(e.contains("`furlongs` is not a known unit"), "{e}");
}

#[test]
fn wrong_cells_are_named_with_row_line_and_column() {
    let e = with_line(7, "0.06,1,1,fast,1,0,0");
    assert!(e.contains("run.csv, row 7 (line 8 of the file): dalpha1 is `fast`"), "{e}");
    let e = with_line(7, "0.06,1,1,,1,0,0");
    assert!(e.contains("row 7") && e.contains("dalpha1 is NaN"), "{e}");
    let e = with_line(40, "0.39,1,1");
    assert!(e.contains("row 40") && e.contains("is NaN"), "{e}");
    let e = with_line(7, "0.06,1,1,NaN,1,0,0");
    assert!(e.contains("run.csv, row 7: dalpha1 is NaN") && e.contains("line 8"), "{e}");
    let e = with_line(7, "0.06,1,1,1,1,0,-inf");
    assert!(e.contains("run.csv, row 7: M2 is -inf"), "{e}");
    let e = with_line(7, "0,06,1,1,1,1,0,0");
    let words = "row 7 (line 8) `0,06,1,1,1,1,0,0`: 8 cells, and the header has 7";
    assert!(e.contains(words), "{e}");
    let e = with_line(7, "0.05,1,1,1,1,0,0");
    assert!(e.contains("row 7: t = 0.05 s does not exceed 0.05 s"), "{e}");
    // comments and blank lines are lines and no rows
    let mut lines = lines(40);
    lines[30] = "0.01,1,1,1,1,0,0".into();
    lines.insert(3, "# note\n".into());
    let e = refused(lines.join("\n"));
    assert!(e.contains("row 30: t = 0.01 s does not") && e.contains("line 33 of the"), "{e}");
}

#[test]
fn files_of_another_encoding_are_read_and_those_that_are_no_parquet_are_named() {
    let utf16: Vec<u8> = lines(20).join("\n").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [&[0xff, 0xfe][..], &utf16].concat();
    assert_eq!(Scratch::new("run.csv", marked).read().unwrap().len(), 20);
    let e = Scratch::new("run.parquet", lines(20).join("\n")).read().unwrap_err().to_string();
    assert!(e.contains("run.parquet cannot be read as Parquet"), "{e}");
    let words = TableColumn::Text("t".into(), vec!["a".into(); 20]);
    let other = |name: &str| TableColumn::Number(name.into(), vec![0.0; 20]);
    let columns = [words, other("dalpha1"), other("dalpha2"), other("M1"), other("M2")];
    let bytes = write_parquet_table(Path::new("x"), &columns).unwrap();
    let e = Scratch::new("run.parquet", bytes).read().unwrap_err().to_string();
    assert!(e.contains("row 1: t is `a`; expected a number"), "{e}");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(400))]

    #[test]
    fn any_bytes_give_a_recording_or_an_error(
        bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400),
        header in proptest::bool::ANY,
    ) {
        let mut all = if header { format!("{HEADER}\n").into_bytes() } else { vec![] };
        all.extend(bytes);
        let _ = Scratch::new("run.csv", &all).read();
        let _ = Scratch::new("run.parquet", &all).read();
    }

    #[test]
    fn any_text_below_a_header_gives_a_recording_or_an_error(
        body in "([0-9.,;\"#\\- eE]{0,40}\n){0,20}",
    ) {
        let _ = Scratch::new("run.csv", format!("{HEADER}\n{body}")).read();
    }

    #[test]
    fn a_parquet_file_that_was_cut_short_gives_an_error(cut in 1_usize..2000) {
        let column = |name: &str| TableColumn::Number(name.into(), (0..20).map(f64::from).collect());
        let columns: Vec<_> = HEADER.split(',').map(column).collect();
        let mut bytes = write_parquet_table(Path::new("x"), &columns).unwrap();
        bytes.truncate(bytes.len() - 1 - cut % (bytes.len() - 1));
        proptest::prop_assert!(Scratch::new("run.parquet", &bytes).read().is_err());
    }
}

#[test]
fn a_file_that_ends_in_an_open_quote_is_refused() {
    let error = refused(format!("{HEADER}\n\""));
    assert!(error.contains("run.csv") && !error.contains("no row of data"), "{error}");
}

#[test]
#[ignore = "writes 100 MB; prints the time that a million rows take"]
#[expect(clippy::print_stdout, reason = "a measurement that is run by hand")]
fn a_million_rows_are_read() {
    let count = 1_000_000;
    let body: String = (0..count).map(|k| text(&row(k)) + "\n").collect();
    let file = Scratch::new("run.csv", format!("{HEADER}\n{body}"));
    let start = std::time::Instant::now();
    assert_eq!(file.read().unwrap().len(), count);
    println!("{} MB in {:.2} s", body.len() >> 20, start.elapsed().as_secs_f64());
    let comma = file.path.with_file_name("comma.csv");
    let text = format!("{HEADER}\n{body}").replace(',', ";").replace('.', ",");
    write_whole(&comma, text.as_bytes()).unwrap();
    let start = std::time::Instant::now();
    read_recording(&comma, &ColumnMap::default(), DriveUnit::Volt).unwrap();
    println!("with decimal commas in {:.2} s", start.elapsed().as_secs_f64());
}
