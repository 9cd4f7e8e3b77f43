use super::*;
use crate::io::{Column, TableColumn, read_recording, write_parquet_table, write_whole};

/// Rows of the files: more than one block.
const ROWS: usize = BLOCK + 500;

fn value(k: usize, j: usize) -> f64 {
    let t = 0.001 * k as f64;
    [t, (0.1 * t).sin(), 0.5 * t, 0.2, -0.1 * t][j]
}

const NAMES: [&str; 5] = ["t", "dalpha1", "dalpha2", "M1", "M2"];

/// A CSV with all that is allowed: comments, blank lines, quotes, a column that is passed over.
fn csv(separator: &str, comma: bool) -> String {
    let mut out = format!("# a remark\n\n{}{separator}\"a{separator}b\"\n", NAMES.join(separator));
    for k in 0..ROWS {
        let cells: Vec<String> = (0..5).map(|j| value(k, j).to_string()).collect();
        let mut line = cells.join(separator);
        if comma {
            line = line.replace('.', ",");
        }
        out += &format!("{line}{separator}\"x{separator}y\"\n");
        if k % 50_000 == 0 {
            out += "# between\n\n";
            out += &separator.repeat(5);
            out.push('\n');
        }
    }
    out
}

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write_whole(&path, bytes).unwrap();
    (folder, path)
}

fn long(
    path: &Path,
    hold_rows: usize,
) -> Result<Option<(Recording, LongRecording, String)>, IoError> {
    read_long_recording(path, &ColumnMap::default(), DriveUnit::NewtonMetre, hold_rows)
}

/// Both blocks of a file of so many rows one behind the other.
#[track_caller]
fn assert_reads_as_a_whole(path: &Path, rows: usize) {
    let (whole, sum) = read_recording(path, &ColumnMap::default(), DriveUnit::NewtonMetre).unwrap();
    let (windows, long, again) = long(path, 1000).unwrap().unwrap();
    assert_eq!((long.samples, long.duration, again), (rows, whole.duration(), sum));
    assert!(windows.len() < whole.len() + 1 && windows.measured() == whole.measured());
    let (mut t, mut omega, mut torque) = (vec![], vec![], vec![]);
    let mut blocks = 0;
    for block in long.rows.blocks() {
        let block = block.unwrap();
        assert!(block.alpha.is_none());
        t.extend(block.t);
        omega.extend(block.omega.unwrap());
        torque.extend(block.torque);
        blocks += 1;
    }
    assert_eq!(blocks, 2);
    assert!(t == whole.t() && omega == whole.omega() && torque == whole.torque());
}

#[test]
fn blocks_of_a_text_are_the_rows_of_the_whole() {
    for (separator, comma) in [(",", false), (";", true), ("\t", false)] {
        let (_folder, path) = written("run.csv", csv(separator, comma).as_bytes());
        assert_reads_as_a_whole(&path, ROWS);
    }
    // rows of plain numbers
    let plain = csv(",", false).replace("\"x,y\"", "-7.5");
    let (_folder, path) = written("run.csv", plain.as_bytes());
    assert_reads_as_a_whole(&path, ROWS);
}

#[test]
fn blocks_of_parquet_are_the_rows_of_the_whole() {
    let rows = GROUP + 500;
    let column =
        |j: usize| TableColumn::Number(NAMES[j].into(), (0..rows).map(|k| value(k, j)).collect());
    let columns: Vec<TableColumn> = (0..5).map(column).collect();
    let bytes = write_parquet_table(Path::new("run.parquet"), &columns).unwrap();
    let (_folder, path) = written("run.parquet", &bytes);
    assert_reads_as_a_whole(&path, rows);
}

#[test]
fn files_with_few_rows_are_left_to_be_read_as_a_whole() {
    let (_folder, path) = written("run.csv", csv(",", false).as_bytes());
    assert!(long(&path, ROWS + 100).unwrap().is_none());
    assert!(long(Path::new("no/such.csv"), 1000).is_err());
}

#[test]
fn a_time_of_the_calendar_counts_from_the_first_row_in_every_block() {
    let mut text = String::from("t,dalpha1,dalpha2,M1,M2\n");
    for k in 0..ROWS {
        text += &format!("{},1,2,0.1,0.2\n", 1_700_000_000_000_u64 + k as u64);
    }
    let (_folder, path) = written("run.csv", text.as_bytes());
    let mut columns = ColumnMap::default();
    columns.put("t", Column { unit: Some("ms".into()), ..Column::new("t") }).unwrap();
    let read = read_long_recording(&path, &columns, DriveUnit::NewtonMetre, 1000);
    let (_, long, _) = read.unwrap().unwrap();
    let t: Vec<f64> = long.rows.blocks().flat_map(|block| block.unwrap().t).collect();
    assert!(t[0] == 0.0 && (t[ROWS - 1] - 0.001 * (ROWS - 1) as f64).abs() < 1e-9);
}

#[test]
fn what_is_wrong_in_a_later_block_is_named_with_row_and_line() {
    let line = |k: usize| (0..5).map(|j| value(k, j).to_string()).collect::<Vec<_>>().join(",");
    let mut lines = vec![NAMES.join(",")];
    lines.extend((0..ROWS).map(line));
    let bad = BLOCK + 100;
    for (text, words) in [
        ("1e9,x,0,0,0", "`x`"),
        ("1e9,1,0,0,0,7", "6"),
        ("131.1711,1,NaN,0,0", "dalpha2 is NaN"),
        ("131.1711,1,0,0", "M2"),
    ] {
        let mut lines = lines.clone();
        lines[bad] = text.into();
        let (_folder, path) = written("run.csv", lines.join("\n").as_bytes());
        let e = long(&path, 1000).err().unwrap().to_string();
        assert!(e.contains(words) && e.contains(&bad.to_string()), "{text}: {e}");
        assert!(e.contains(&format!("line {}", bad + 1)), "{text}: {e}");
    }
}
