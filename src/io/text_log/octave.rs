//! Files that Octave writes by `save -text`: `# name: w`, `# type: matrix`, and the values.
//!
//! Source: GNU Octave manual, simple file I/O.

use super::lines::Columns;

/// Largest number of columns of a matrix that are read as signals.
const WIDTH: usize = 64;

/// Whether the comments at the beginning are those of Octave.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let head: Vec<&&str> = lines.iter().take_while(|line| line.starts_with('#')).collect();
    let has = |key: &str| head.iter().any(|line| comment(line, key).is_some());
    has("name") && has("type")
}

fn comment<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.strip_prefix('#')?.trim_start().strip_prefix(key)?.strip_prefix(':').map(str::trim)
}

/// A vector under its name, a matrix as `name(:,1)`, `name(:,2)`, …; ranges and scalars are not signals.
pub(super) fn columns(text: &str) -> Columns {
    let mut out: Columns = vec![];
    let mut name = "";
    let mut rows: Vec<Vec<f64>> = vec![];
    for line in text.lines().chain(["# name: "]) {
        if let Some(next) = comment(line, "name") {
            put(&mut out, name, &std::mem::take(&mut rows));
            name = next;
        } else if !line.starts_with('#') && !line.trim().is_empty() {
            rows.push(
                line.split_whitespace().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect(),
            );
        }
    }
    out
}

fn put(out: &mut Columns, name: &str, rows: &[Vec<f64>]) {
    let width = rows.first().map_or(0, Vec::len);
    if name.is_empty() || width == 0 || rows.iter().any(|row| row.len() != width) {
        return;
    }
    match (rows.len(), width) {
        (1, 1) => {}
        // a vector that lies
        (1, _) => out.push((name.into(), rows[0].clone())),
        (_, 1) => out.push((name.into(), rows.iter().map(|row| row[0]).collect())),
        _ => out.extend((0..width.min(WIDTH)).map(|k| {
            (format!("{name}(:,{})", k + 1), rows.iter().map(|row| row[k]).collect::<Vec<f64>>())
        })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_are_columns_under_their_names() {
        let text = "# Created by Octave 6.4.0\n# name: t\n# type: matrix\n# rows: 3\n# columns: 1\n 0\n 0.1\n 0.2\n\n\n\
                    # name: r\n# type: scalar\n0.05\n\n# name: w\n# type: matrix\n# rows: 3\n# columns: 2\n 1 2\n 3 NA\n 5 6\n";
        assert!(is_one(&text.lines().collect::<Vec<_>>()) && !is_one(&["# t w", "1 2"]));
        let found = columns(text);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["t", "w(:,1)", "w(:,2)"]);
        assert_eq!(found[1].1, [1.0, 3.0, 5.0]);
    }
}
