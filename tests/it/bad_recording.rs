//! Wrong recordings and odd formats: a clear message and the right exit code, or the right
//! result; never a panic and never half a result.

use crate::support::{Folder, HEADER, Row, csv, motion, on, text};
use amigo_ident::io::{TableColumn, write_parquet_table};

/// Runs an experiment on a recording of these bytes and expects code 2 with these words.
fn refused(bytes: impl AsRef<[u8]>, words: &[&str]) {
    let folder = Folder::new();
    folder.write("run.csv", bytes).write("e.toml", on("run.csv"));
    folder.run(&["e.toml"]).says(2, words);
    assert!(!folder.has("reports"), "nothing may be written before the data are right");
    folder.run(&["check", "e.toml"]).says(2, words);
}

/// The same where nothing is to be corrected.
fn strictly_refused(rows: &[Row], words: &[&str]) {
    let folder = Folder::new();
    let file = format!("[conditioning]\nrows = false\nspikes = false\n\n{}", on("run.csv"));
    folder.write("run.csv", csv(rows)).write("e.toml", file);
    folder.run(&["e.toml"]).says(2, words);
}

/// Runs an experiment on a recording under this name and returns its parameters.
fn parameters(name: &str, bytes: impl AsRef<[u8]>) -> Vec<(String, f64)> {
    let folder = Folder::new();
    folder.write(name, bytes).write("e.toml", on(name));
    folder.run(&["e.toml"]).says(0, &["e: "]);
    let results = folder.results("reports/e");
    let parameters = results["methods"][0]["parameters"].as_array().unwrap().clone();
    let pair = |p: &serde_json::Value| {
        (p["symbol"].as_str().unwrap().to_string(), p["value"].as_f64().unwrap())
    };
    parameters.iter().map(pair).collect()
}

fn changed(row: usize, column: usize, value: f64) -> Vec<Row> {
    let mut rows = motion();
    rows[row - 1][column] = value;
    rows
}

#[test]
fn an_empty_recording_is_named() {
    refused("", &["run.csv", "is empty"]);
    refused("\n\n", &["run.csv", "is empty"]);
}

#[test]
fn a_header_without_rows_is_named() {
    refused(format!("{HEADER}\n"), &["run.csv", "no row of data"]);
}

#[test]
fn a_missing_column_is_named_with_the_nearest() {
    let rows = motion();
    let header = HEADER.replace("M2", "M_2");
    let words =
        ["no column `M2`", "did you mean `M_2`?", "t, dalpha1, dalpha2, M1, M_2", "columns"];
    refused(text(&rows, &header, ",", |x| x.to_string(), "\n"), &words);
}

#[test]
fn text_in_place_of_a_number_is_named_with_row_and_column() {
    let mut lines: Vec<String> = csv(&motion()).lines().map(String::from).collect();
    // more than 1 % of the rows
    (7..14).for_each(|k| lines[k] = "0.06,1.0,broken,0.1,0.1".into());
    refused(lines.join("\n"), &["run.csv, row 7", "dalpha2", "`broken`", "expected a number"]);
}

#[test]
fn values_that_are_not_finite_are_named_with_row_and_column() {
    strictly_refused(&changed(12, 3, f64::NAN), &["run.csv, row 12", "M1 is NaN", "finite"]);
    strictly_refused(
        &changed(5, 1, f64::INFINITY),
        &["run.csv, row 5", "dalpha1 is inf", "finite"],
    );
    strictly_refused(&changed(5, 0, f64::NAN), &["run.csv, row 5", "t is NaN", "finite"]);
}

#[test]
fn time_that_goes_backwards_or_stands_still_is_named_with_its_row() {
    let words = ["run.csv, row 100", "t = 0.5 s does not exceed"];
    strictly_refused(&changed(100, 0, 0.5), &words);
    let rows = changed(100, 0, motion()[98][0]);
    strictly_refused(&rows, &["run.csv, row 100", "does not exceed"]);
}

#[test]
fn one_sample_and_two_are_too_few() {
    refused(csv(&motion()[..1]), &["run.csv", "1 samples", "at least"]);
    refused(csv(&motion()[..2]), &["run.csv", "2 samples", "at least"]);
}

#[test]
fn a_folder_or_nothing_in_place_of_a_recording_is_named() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("run.csv")).unwrap();
    folder.write("e.toml", on("run.csv")).write("gone.toml", on("gone.csv"));
    folder.run(&["e.toml"]).says(2, &["run.csv", "is a directory"]);
    folder.run(&["gone.toml"]).says(2, &["gone.csv", "No such file"]);
    folder.run(&["nothing.toml"]).says(2, &["nothing.toml", "No such file"]);
    folder.run(&["."]).says(2, &["directory"]);
    assert!(!folder.has("reports"));
}

#[test]
fn torques_that_are_all_zero_are_no_data_and_on_one_wheel_a_warning() {
    let rows: Vec<Row> = motion().iter().map(|r| [r[0], r[1], r[2], 0.0, 0.0]).collect();
    refused(csv(&rows), &["e.toml", "M1 and M2 are zero", "run.csv"]);
    let rows: Vec<Row> = motion().iter().map(|r| [r[0], r[1], r[2], r[3], 0.0]).collect();
    let folder = Folder::new();
    folder.write("run.csv", csv(&rows)).write("e.toml", on("run.csv"));
    folder.run(&["check", "e.toml"]).says(0, &["M2 is zero throughout"]);
    let ran = folder.run(&["e.toml"]);
    ran.says(0, &[]);
    assert!(ran.err.contains("warning: e: run.csv: M2 is zero throughout"), "{}", ran.err);
}

#[test]
fn a_wheel_that_never_moves_is_named() {
    let rows: Vec<Row> = motion().iter().map(|r| [r[0], r[1], 0.0, r[3], 0.0]).collect();
    let folder = Folder::new();
    folder.write("run.csv", csv(&rows)).write("e.toml", on("run.csv"));
    folder.run(&["check", "e.toml"]).says(0, &["wheel 2 (left) never moves"]);
    let ran = folder.run(&["e.toml"]);
    // the methods may refuse such data; then the reasons are given, also in the report
    let words = if ran.code == 0 { "e: 2 s simulation error" } else { "the wheels stand still" };
    ran.says(ran.code.clamp(0, 1), &["warning: e: run.csv: wheel 2 (left) never moves", words]);
    assert!(folder.has("reports/e/report.html"));
}

#[test]
fn a_recording_that_is_not_utf_8_is_named() {
    let mut bytes = csv(&motion()).into_bytes();
    bytes[0] = 0xff;
    refused(&bytes, &["run.csv", "no column `t`"]);
    let mut bytes = csv(&motion()).into_bytes();
    let middle = bytes.len() / 2;
    bytes[middle] = 0xff;
    let folder = Folder::new();
    folder.write("run.csv", &bytes).write("e.toml", on("run.csv"));
    folder.run(&["check", "e.toml"]).says(0, &["1 row without a number"]);
}

#[test]
fn separators_decimal_commas_bom_crlf_and_units_in_headers_change_nothing() {
    let rows = motion();
    let plain = parameters("run.csv", csv(&rows));
    assert!(plain.iter().any(|(s, v)| s == "a1" && (v - 0.0319).abs() < 2e-3), "{plain:?}");
    let point = |x: f64| x.to_string();
    let comma = |x: f64| x.to_string().replace('.', ",");
    let semicolon = HEADER.replace(',', ";");
    let units = "t [s],dalpha1 [rad/s],dalpha2 [rad/s],M1 [N m],M2 [N m]";
    let spaced = HEADER.replace(',', ", ");
    let ways = [
        ("semicolon, comma", text(&rows, &semicolon, ";", comma, "\n")),
        ("semicolon, point", text(&rows, &semicolon, ";", point, "\n")),
        ("tab", text(&rows, &HEADER.replace(',', "\t"), "\t", point, "\n")),
        ("tab, comma", text(&rows, &HEADER.replace(',', "\t"), "\t", comma, "\n")),
        ("units", text(&rows, units, ",", point, "\n")),
        ("byte order mark", format!("\u{feff}{}", csv(&rows))),
        ("CRLF", text(&rows, HEADER, ",", point, "\r\n")),
        (
            "BOM, CRLF, semicolon",
            format!("\u{feff}{}", text(&rows, &semicolon, ";", comma, "\r\n")),
        ),
        ("spaces", text(&rows, &spaced, ", ", point, "\n")),
        ("comments", format!("# robot 3\n# floor\n{}", csv(&rows))),
        ("blank lines", format!("\n{}\n\n", csv(&rows))),
        ("quoted", text(&rows, "\"t\",\"dalpha1\",\"dalpha2\",\"M1\",\"M2\"", ",", point, "\n")),
    ];
    for (way, bytes) in ways {
        assert_eq!(parameters("run.csv", bytes), plain, "{way}");
    }
}

fn parquet(rows: &[Row]) -> Vec<u8> {
    let columns: Vec<TableColumn> = HEADER
        .split(',')
        .enumerate()
        .map(|(j, name)| TableColumn::Number(name.into(), rows.iter().map(|r| r[j]).collect()))
        .collect();
    write_parquet_table(std::path::Path::new("run.parquet"), &columns).unwrap()
}

#[test]
fn parquet_gives_the_same_results_as_csv() {
    let rows = motion();
    assert_eq!(parameters("run.parquet", parquet(&rows)), parameters("run.csv", csv(&rows)));
}

#[test]
fn half_a_parquet_file_is_named() {
    let bytes = parquet(&motion());
    for part in [&bytes[..bytes.len() / 2], &bytes[..3], &bytes[..0]] {
        let folder = Folder::new();
        folder.write("run.parquet", part).write("e.toml", on("run.parquet"));
        folder.run(&["e.toml"]).says(2, &["run.parquet"]);
        assert!(!folder.has("reports"));
    }
    let mut rows = motion();
    rows[20][4] = f64::NAN;
    let folder = Folder::new();
    let file = format!("[conditioning]\nrows = false\n\n{}", on("run.parquet"));
    folder.write("run.parquet", parquet(&rows)).write("e.toml", file);
    folder.run(&["e.toml"]).says(2, &["run.parquet, row 21", "M2 is NaN"]);
}

#[test]
fn blank_lines_and_comments_may_stand_above_the_header_in_any_order() {
    let rows = csv(&motion());
    let plain = parameters("run.csv", &rows);
    for above in ["\n", "# a note\n\n", "\n\n# a, note\n\n"] {
        assert_eq!(parameters("run.csv", format!("{above}{rows}")), plain, "{above:?}");
    }
}

#[test]
fn names_in_quotes_may_hold_separators_quotes_and_markup() {
    for (name, written) in [("a,b", "\"a,b\""), ("a\"b", "\"a\"\"b\""), ("<b>ω</b>", "<b>ω</b>")]
    {
        let folder = Folder::new();
        let toml = on("run.csv");
        let (head, rest) = toml.split_once("\n\n").unwrap();
        let columns = format!("columns = {{ dalpha1 = {} }}", toml::Value::from(name));
        folder
            .write("run.csv", csv(&motion()).replacen("dalpha1", written, 1))
            .write("e.toml", format!("{head}\n{columns}\n\n{rest}"));
        folder.run(&["check", "e.toml"]).says(0, &["run.csv: 600 samples"]);
    }
}

#[test]
fn values_and_steps_that_no_robot_has_are_refused_before_anything_runs() {
    let words = ["run.csv, row 100", "dalpha1 is 1e300", "wrong column"];
    strictly_refused(&changed(100, 1, 1e300), &words);
    strictly_refused(&changed(7, 3, -1e30), &["run.csv, row 7", "M1 is -1e30"]);
    let slow: Vec<Row> = motion().iter().map(|r| [1e5 * r[0], r[1], r[2], r[3], r[4]]).collect();
    refused(csv(&slow), &["t rises by 1000 s from row to row", "unit = \"us\""]);
    let folder = Folder::new();
    for (line, words) in [
        ("[simulation]\nnoise = { dalpha = 1e300 }", "simulation.noise"),
        ("[simulation]\nmovement = [{ speed_m_s = 1e300, blend_s = 2.0 }]", "speeds up to"),
        ("[simulation]\ntruth = { a4 = 1e300 }", "simulation.truth.a4"),
        ("[simulation]\n[model]\nfixed = { a3 = 1e300 }", "model.fixed.a3"),
        ("[simulation]\n[emulator]\npoles = [1e300, 1e300]", "an entry of K"),
        ("[simulation]\n[robot]\npreset = \"amigobot\"\nl1_m = 1e300", "l1_m = 1e300"),
    ] {
        folder.write("e.toml", line);
        folder.run(&["e.toml"]).says(2, &[words]);
    }
}

#[test]
fn control_characters_of_a_file_do_not_reach_the_terminal() {
    let folder = Folder::new();
    folder
        .write("run.csv", csv(&motion()).replacen("M1", "\u{1b}[31mM1", 1))
        .write("e.toml", on("run.csv"));
    let ran = folder.run(&["check", "e.toml"]);
    assert!(!ran.says(2, &["there is no column `M1`"]).err.contains('\u{1b}'));
}

/// A changed bit in the number of rows made the reader ask for more memory than there is.
#[test]
fn a_parquet_file_with_an_impossible_number_of_rows_is_refused() {
    let rows: Vec<Row> = motion();
    let column = |(k, name): (usize, &str)| {
        TableColumn::Number(name.into(), rows.iter().map(|row| row[k]).collect())
    };
    let columns: Vec<_> = HEADER.split(',').enumerate().map(column).collect();
    let bytes = write_parquet_table(std::path::Path::new("x"), &columns).unwrap();
    // 600 in zigzag is 1200: the varint b0 09
    let at = bytes.windows(2).rposition(|w| w == [0xb0, 0x09]).unwrap();
    let mut changed = bytes.clone();
    changed.splice(at..at + 2, [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x07]);
    let end = changed.len() - 8;
    let length = u32::from_le_bytes(changed[end..end + 4].try_into().unwrap()) + 7;
    changed[end..end + 4].copy_from_slice(&length.to_le_bytes());
    let folder = Folder::new();
    folder.write("run.parquet", changed).write("e.toml", on("run.parquet"));
    folder.run(&["check", "e.toml"]).says(2, &["run.parquet", "Parquet"]);
}

/// Reading them in threads that also wait for others once used up the stack and the open files.
#[test]
fn two_thousand_recordings_are_read_with_few_files_open() {
    let folder = Folder::new();
    let rows = csv(&motion()[..60]);
    std::fs::create_dir(folder.path("many")).unwrap();
    let names: Vec<String> = (0..2000).map(|k| format!("many/{k}.csv")).collect();
    for name in &names {
        folder.write(name, &rows);
    }
    folder.write("e.toml", format!("[recordings]\ntrain = {names:?}\n"));
    folder.run(&["check", "e.toml"]).says(0, &["1999.csv: 60 samples"]);
}
