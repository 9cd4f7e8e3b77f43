//! Names above a table: in one line or two, in comments, above a line of units; and statements of a header on the time.

use super::attributes::{
    alternating_units, are_of_one_key, is_attribute, known_units, times_named,
};
use super::described::described;
use super::lines::{Columns, SEPARATORS, cells, is_blank, is_comment, made_up};
use crate::io::csv::{ABSENT, Style, is_units, value, with_unit};

/// Lines above the rows among which the names are looked for.
const ABOVE: usize = 3;
/// Number of lines within which the header of LabVIEW must be.
const PREAMBLE: usize = 60;
/// First cell of the line of units of LabVIEW.
const UNITS: &str = "Y_Unit_Label";
/// First words of a measurement file of LabVIEW.
const LABVIEW: &str = "LabVIEW Measurement";

/// The names of `count` columns above the first row and the number of their line; generated names where there are none.
/// Separators at the end of that line name nothing.
pub(super) fn names(
    lines: &[&str],
    first: usize,
    separator: char,
    count: usize,
) -> (Option<usize>, Vec<String>) {
    let no_number = |cells: &[String]| {
        let named =
            |c: &String| ABSENT.contains(&c.as_str()) || value(c, Style::of(separator)).is_none();
        cells.len() == count && cells.iter().all(named) && cells.iter().any(|c| !c.is_empty())
    };
    let named_cells = |line: &str, separator: char| {
        let mut cells = with_subscripts(cells(line, separator), separator);
        if separator == ' ' && cells.len() > count {
            cells = with_their_units(&cells);
        }
        // nor does the column of LabVIEW for comments, of which rows have none
        let is_none = |c: &String| c.is_empty() || c == "Comment";
        while cells.len() > count && cells.last().is_some_and(is_none) {
            cells.pop();
        }
        cells
    };
    // the first line of all, whatever stands between: rows may be broken
    let top = (0..first).find(|k| !is_blank(lines[*k]) && !lines[*k].starts_with('#'));
    if let Some(k) = top {
        let cells = named_cells(lines[k], separator);
        let below = || {
            let lines = lines[k + 1..first].iter().filter(|line| !is_blank(line));
            lines.map(|line| named_cells(line, separator)).filter(|cells| cells.len() == count)
        };
        // names that come again are those of groups above the names
        let is_group_of = |c: &Vec<String>| no_number(c) && !is_units(c) && !are_of_one_key(c);
        let is_group = is_repeated(&cells) && below().any(|c| is_group_of(&c));
        if no_number(&cells) && cells.iter().all(|c| !c.is_empty()) && !is_group {
            let units = below().find(|cells| is_units(cells)).unwrap_or_default();
            let units = units.iter().map(String::as_str).chain(std::iter::repeat(""));
            let names = cells.iter().zip(units).map(|(name, unit)| with_unit(name, unit));
            return (Some(k), names.collect());
        }
    }
    if let Some((k, names)) = described(&lines[..first], count) {
        return (Some(k), names);
    }
    let rows = Above { lines: &lines[..first], separator, count };
    rows.named(&named_cells, &no_number, true)
        .or_else(|| rows.named(&named_cells, &no_number, false))
        .or_else(|| longer(lines, first, separator, count))
        .unwrap_or_else(|| (None, (0..count).map(made_up).collect()))
}

/// Whether the commas in subscripts of MATLAB are those between the names of a line too.
pub(super) fn has_bare_subscripts(line: &str, separator: char) -> bool {
    let subscripts = ["(:,", ",:)"].iter().any(|part| line.contains(part));
    separator == ',' && subscripts && !line.contains('"')
}

/// Names of MATLAB with the commas of their subscripts, which separate no cells: `velocity(:,1)`, `velocity(1,:)`.
fn with_subscripts(cells: Vec<String>, separator: char) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    for cell in cells {
        match out.last_mut() {
            Some(last) if separator == ',' && (last.ends_with("(:") || cell == ":)") => {
                *last = format!("{last},{cell}");
            }
            _ => out.push(cell),
        }
    }
    out
}

/// Names in words with the units in brackets behind them: `t [s] speed [rad/s]` are two.
fn with_their_units(words: &[String]) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    for word in words {
        match out.last_mut() {
            Some(last) if word.starts_with(['[', '(']) => *last = format!("{last} {word}"),
            _ => out.push(word.clone()),
        }
    }
    out
}

/// The lines above a table of `count` columns.
struct Above<'a> {
    lines: &'a [&'a str],
    separator: char,
    count: usize,
}

impl Above<'_> {
    /// The lowest line with names, with the units of a line between it and the rows or in the preamble. Lines of one
    /// attribute of all columns are passed over where they are to be, as `Data-Type,REAL64,Data-Type,REAL64`, and lines
    /// that are mostly empty.
    fn named(
        &self,
        cells_of: &dyn Fn(&str, char) -> Vec<String>,
        no_number: &dyn Fn(&[String]) -> bool,
        passes_over: bool,
    ) -> Option<(Option<usize>, Vec<String>)> {
        let (mut units, mut seen): (Option<Vec<String>>, usize) = (None, 0);
        for k in (0..self.lines.len()).rev().filter(|k| !is_blank(self.lines[*k])) {
            let line = within_bracket(self.lines[k]).trim_start_matches(['#', '%', '/', ' ']);
            let is_remark = is_comment(self.lines[k]) || line.len() < self.lines[k].len();
            let ways: &[char] = if is_remark { &SEPARATORS } else { &[self.separator] };
            let all = || ways.iter().map(|s| cells_of(line, *s));
            let held = || all().filter(|c| c.len() == self.count);
            if units.is_none()
                && let Some(found) = held().find_map(|c| {
                    let alternate = || alternating_units(&c).filter(|_| passes_over);
                    if is_units(&c) { Some(known_units(&c)) } else { alternate() }
                })
            {
                units = Some(found);
                continue;
            }
            if passes_over && all().any(|c| c.len() == self.count && is_attribute(&c)) {
                continue;
            }
            seen += 1;
            if seen > ABOVE {
                return None;
            }
            if let Some(cells) = all().find(|c| no_number(c)) {
                return Some((Some(k), self.completed(k, &times_named(&cells), units)));
            }
        }
        None
    }

    /// Names with their units, which may be given anywhere in the preamble after a keyword, and the groups of
    /// the line above them.
    fn completed(&self, k: usize, cells: &[String], units: Option<Vec<String>>) -> Vec<String> {
        let above = || self.lines[..k].iter().rev().map(|line| self::cells(line, self.separator));
        let preamble = || {
            let line = above().find(|c| c.len() == self.count && is_units(c))?;
            Some(known_units(&line))
        };
        let labelled = || above().find_map(|row| labelled(&row, cells)).map(|c| known_units(&c));
        let units = units.or_else(labelled).or_else(preamble).unwrap_or_default();
        let unit = |k: usize| units.get(k).map_or("", String::as_str);
        let name = |(k, cell): (usize, &String)| {
            if cell.is_empty() { made_up(k) } else { with_unit(cell, unit(k)) }
        };
        let named: Vec<String> = cells.iter().enumerate().map(name).collect();
        let groups = is_repeated(cells)
            .then(|| groups(&self.lines[..k], self.separator, self.count))
            .flatten();
        groups.map_or_else(|| named.clone(), |groups| grouped(&named, &groups))
    }
}

/// The text after the bracket that opens a matrix of MATLAB and after its comment sign: `data = [ % t wl wr`.
fn within_bracket(line: &str) -> &str {
    let behind = line.split_once("= [").map(|(_, rest)| rest.trim_start());
    behind.filter(|rest| rest.starts_with('%')).unwrap_or(line)
}

/// The names of a header with more columns than the rows below it; the last columns are empty.
fn longer(
    lines: &[&str],
    first: usize,
    separator: char,
    count: usize,
) -> Option<(Option<usize>, Vec<String>)> {
    let k = (0..first).rev().find(|k| !is_blank(lines[*k]))?;
    let found = cells(lines[k], separator);
    let is_name = |c: &String| !c.is_empty() && value(c, Style::of(separator)).is_none();
    let is_header = separator != ' '
        && !is_comment(lines[k])
        && count > 2
        && found.len() > count
        && found.len() <= 2 * count
        && found.iter().all(is_name)
        && !is_repeated(&found);
    is_header.then_some((Some(k), found))
}

/// The units of columns by the line of LabVIEW that has one for each channel, and none for times and comments.
fn labelled(row: &[String], names: &[String]) -> Option<Vec<String>> {
    let (_, units) = row.split_first().filter(|(first, _)| *first == UNITS)?;
    let mut units: Vec<&String> = units.iter().filter(|unit| !unit.is_empty()).rev().collect();
    let is_channel = |name: &String| !name.starts_with("X_Value") && name != "Comment";
    if names.iter().filter(|name| is_channel(name)).count() != units.len() {
        return None;
    }
    let unit = |name: &String| if is_channel(name) { units.pop().cloned() } else { None };
    Some(names.iter().map(unit).map(Option::unwrap_or_default).collect())
}

/// Whether a name occurs more than once.
fn is_repeated(names: &[String]) -> bool {
    names.iter().enumerate().any(|(k, name)| !name.is_empty() && names[..k].contains(name))
}

/// The words of a line above the names that say whose they are: `,right,right,left,left`; one word stands for the empty
/// cells behind it.
fn groups(above: &[&str], separator: char, count: usize) -> Option<Vec<String>> {
    let line = above.iter().rev().find(|line| !is_blank(line) && !is_comment(line))?;
    let mut found = cells(line, separator);
    let is_word = |cell: &String| cell.is_empty() || value(cell, Style::of(separator)).is_none();
    if found.len() != count || !found.iter().all(is_word) || found.iter().all(String::is_empty) {
        return None;
    }
    let mut last = String::new();
    for cell in &mut found {
        if cell.is_empty() {
            cell.clone_from(&last);
        }
        last.clone_from(cell);
    }
    Some(found)
}

/// A name before the bracket of its unit.
fn bare_of_unit(name: &str) -> &str {
    name.split(['[', '(']).next().unwrap_or(name).trim_end()
}

fn grouped(names: &[String], groups: &[String]) -> Vec<String> {
    let one = |(name, group): (&String, &String)| {
        let is_named = group.is_empty() || bare_of_unit(name) == group;
        if is_named { name.clone() } else { format!("{group} {name}") }
    };
    names.iter().zip(groups).map(one).collect()
}

/// The columns with the time that the header of LabVIEW states, where the rows have none, and without columns that
/// stand there twice.
pub(super) fn completed(mut columns: Columns, text: &str) -> Columns {
    let number = |key: &str| -> Option<f64> {
        let line = text.lines().take(PREAMBLE).find(|line| line.starts_with(key))?;
        value(line.split('\t').nth(1)?, Style::Either).filter(|x| x.is_finite())
    };
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    if text.trim_start_matches('\u{feff}').starts_with(LABVIEW)
        && let Some(step) = number("Delta_X")
    {
        let start = number("X0").unwrap_or_default();
        let is_empty = |(_, values): &(String, Vec<f64>)| values.iter().all(|x| x.is_nan());
        let is_time = |(name, _): &(String, Vec<f64>)| name.starts_with("X_Value");
        if !columns.iter().any(|column| is_time(column) && !is_empty(column)) {
            columns.retain(|column| !is_time(column) && !is_empty(column));
            let time = (0..rows).map(|k| start + step * k as f64).collect();
            columns.insert(0, ("X_Value [s]".into(), time));
        }
    }
    let mut out: Columns = vec![];
    for (name, values) in columns {
        let same = |other: &[f64]| {
            other.iter().zip(&values).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
        };
        let times = out.iter().filter(|(other, _)| *other == name).count();
        match out.iter().any(|(other, v)| *other == name && same(v)) {
            true => {}
            false if times > 0 => out.push((format!("{name}.{}", times + 1), values)),
            false => out.push((name, values)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_two_lines_and_in_comments_are_put_together() {
        let two =
            [",right,,left,", "t,speed,current,speed,current", "s,rad/s,A,rad/s,A", "0,1,2,3,4"];
        let (at, found) = names(&two, 3, ',', 5);
        assert_eq!(at, Some(1));
        assert_eq!(found[1..3], ["right speed [rad/s]", "right current [A]"]);
        assert_eq!((found[0].as_str(), found[4].as_str()), ("t [s]", "left current [A]"));
        let comments = ["# log 7", "# column 1: time [s]", "# column 2: speed", "0 1"];
        assert_eq!(names(&comments, 3, ' ', 2).1, ["time [s]", "speed"]);
        let spaced = ["# t [s]   omega_R [rad/s]  I_R [A]", "0 1 2"];
        assert_eq!(names(&spaced, 1, ' ', 3).1, ["t [s]", "omega_R [rad/s]", "I_R [A]"]);
        assert_eq!(names(&["# 0) t", "# 1) w", "0 1"], 2, ' ', 2).1, ["t", "w"]);
        assert_eq!(names(&["# 3 of 2", "# 5 of 2", "0 1"], 2, ' ', 2).1, ["column1", "column2"]);
    }

    #[test]
    fn attributes_of_columns_are_no_names() {
        let twincat = [
            "Name\tScope",
            "",
            "Name\tAxisL.Velo\tName\tAxisR.Velo",
            "Comment\t\tComment\t",
            "Type\tREAL64\tType\tREAL64",
            "Unit\tdeg/s\tUnit\tdeg/s",
            "Scale\t1\tScale\t2",
            "",
            "0\t1\t0\t2",
        ];
        let (at, found) = names(&twincat, 8, '\t', 4);
        assert_eq!(at, Some(2));
        assert_eq!(found, ["Time", "AxisL.Velo [deg/s]", "Time", "AxisR.Velo [deg/s]"]);
        // an unknown unit remains that of its column
        let percent = twincat.map(|line| line.replacen("deg/s", "0.1%", 1));
        let found = names(&percent.each_ref().map(String::as_str), 8, '\t', 4).1;
        assert_eq!(found, ["Time", "AxisL.Velo [0.1%]", "Time", "AxisR.Velo [deg/s]"]);
        let dspace =
            ["meta,run 3,", "name,Time,w_l,w_r", "unit,s,rad/s,rad/s", "values,,,", ",0,1,2"];
        let found = names(&dspace, 4, ',', 4).1;
        assert_eq!(found, ["name", "Time [s]", "w_l [rad/s]", "w_r [rad/s]"]);
        // names that come again, with those of the sides above them
        let two = [",left,,right", "t,speed,t,speed", "0,1,0,2"];
        assert_eq!(names(&two, 2, ',', 4).1, ["t", "left speed", "left t", "right speed"]);
    }

    #[test]
    fn lines_below_the_names_whose_cells_begin_with_one_key_are_no_names() {
        // the Simulation Data Inspector of Simulink, with the time of each block
        let lines = [
            "time,wL:1,time,uL:1",
            "Type: double,Type: double,Type: double,Type: double",
            "Units: s,Units: rad/s,Units: s,Units: V",
            "BlockPath: m/Plant,BlockPath: m/Plant,BlockPath: m/C,BlockPath: m/C",
            "Interp: linear,Interp: linear,Interp: zoh,Interp: zoh",
            "0,1,0,2",
        ];
        let (at, found) = names(&lines, 5, ',', 4);
        assert_eq!(at, Some(0));
        assert_eq!(found, ["time [s]", "wL:1 [rad/s]", "time [s]", "uL:1 [V]"]);
    }

    #[test]
    fn the_commas_of_subscripts_separate_no_names() {
        let lines = ["time,velocity(:,1),velocity(:,2),torque(1,:)", "0,1,2,3"];
        let found = names(&lines, 1, ',', 4).1;
        assert_eq!(found, ["time", "velocity(:,1)", "velocity(:,2)", "torque(1,:)"]);
    }

    #[test]
    fn a_header_of_more_columns_than_the_rows_names_the_first_of_them() {
        let lines = ["v_l,v_r,w_l,w_r,yaw", "0,1,2,3"];
        assert_eq!(names(&lines, 1, ',', 4).1.len(), 5);
        let lines = ["data = [ % t wl wr", "0 1 2;"];
        assert_eq!(names(&lines, 1, ' ', 3).1, ["t", "wl", "wr"]);
    }

    #[test]
    fn units_in_the_header_of_labview_stand_behind_the_names() {
        let lines = ["Y_Unit_Label\tdeg\tVolts", "X_Value\tEncoder\tMotor\tComment", "0\t1\t2\t"];
        let found = names(&lines, 2, '\t', 4).1;
        assert_eq!(found, ["X_Value", "Encoder [deg]", "Motor [Volts]", "Comment"]);
        let lines = ["Y_Unit_Label\tdeg\tV", "X_Value\ta\tX_Value\tb", "0\t1\t0\t2"];
        assert_eq!(names(&lines, 2, '\t', 4).1, ["X_Value", "a [deg]", "X_Value", "b [V]"]);
    }

    #[test]
    fn the_time_of_labview_and_columns_that_stand_twice_are_completed() {
        let text = "LabVIEW Measurement\nX0\t0.5\t0.5\nDelta_X\t0,1\t0,1\n";
        let none = || vec![f64::NAN; 3];
        let found = completed(vec![("X_Value".into(), none()), ("w".into(), vec![1.0; 3])], text);
        assert_eq!(found[0], ("X_Value [s]".into(), vec![0.5, 0.6, 0.7]));
        let twice =
            |other: f64| completed(vec![("t".into(), vec![1.0]), ("t".into(), vec![other])], "");
        assert_eq!((twice(1.0).len(), twice(2.0)[1].0.as_str()), (1, "t.2"));
    }
}
