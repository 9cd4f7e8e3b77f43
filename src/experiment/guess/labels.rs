//! Columns of words, by which the motor of a row is identified.

use crate::io::{PreviewColumn, is_owner};

/// Names of columns of words that identify the motor of a row, in addition to those of columns of numbers.
const OWNERS: [&str; 2] = ["joint_name", "name"];
/// Motors at most, by numbers.
const MOTORS: usize = 4;

/// The question of a table whose rows are those of several motors in turn.
pub(super) fn owners(columns: &[PreviewColumn]) -> Option<String> {
    let (column, words) = columns.iter().find_map(|c| Some((c, whose(c)?)))?;
    Some(format!(
        "`{}` names the motor of each row ({}): were the motors measured one after the other? The two wheels must be measured at the same time, in separate columns",
        column.name,
        words.join(", ")
    ))
}

/// The question on names that several columns have, of which none can be used.
pub(super) fn repeated(columns: &[PreviewColumn]) -> Option<String> {
    let is_first = |k: &usize| columns[..*k].iter().all(|c| c.name != columns[*k].name);
    let is_again = |k: &usize| columns[k + 1..].iter().any(|c| c.name == columns[*k].name);
    let names: Vec<String> = (0..columns.len())
        .filter(|k| is_first(k) && is_again(k))
        .map(|k| format!("`{}`", columns[k].name))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "several columns are called {}: is it one of these? Then rename them in the header",
            names.join(", ")
        )
    })
}

/// A remark on the columns at the end of the header that no row has cells for; of LabVIEW that for comments has none.
pub(super) fn without_cells(columns: &[PreviewColumn]) -> Option<String> {
    let is_empty = |c: &&PreviewColumn| {
        c.name != "Comment"
            && c.values.iter().all(|v| v.is_nan())
            && c.texts.iter().all(String::is_empty)
    };
    let empty: Vec<String> =
        columns.iter().rev().take_while(is_empty).map(|c| format!("`{}`", c.name)).collect();
    let names = empty.iter().rev().cloned().collect::<Vec<_>>().join(", ");
    (!empty.is_empty())
        .then(|| format!("the rows have no cells for {names}: the names before them are used"))
}

/// The motors, as words or numbers, of a column that identifies the motor of a row.
fn whose(column: &PreviewColumn) -> Option<Vec<String>> {
    let name = column.name.trim().to_lowercase();
    if column.words.len() > 1 && (is_owner(&name) || OWNERS.contains(&name.as_str())) {
        return Some(column.words.clone());
    }
    let numbers = || column.values.iter().filter(|v| v.is_finite());
    let changes = column.values.windows(2).filter(|w| w[0] != w[1]).count();
    let is_number = |name: &str| is_owner(name) && !["channel", "ch"].contains(&name);
    if !is_number(&name) || changes == 0 || changes >= MOTORS || numbers().any(|v| v.fract() != 0.0)
    {
        return None;
    }
    let mut found: Vec<String> = numbers().map(f64::to_string).collect();
    found.dedup();
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    fn column(name: &str, words: &[&str]) -> PreviewColumn {
        let value = |k: i32| if words.is_empty() { f64::from(k % 17) } else { f64::NAN };
        let words = words.iter().map(ToString::to_string).collect();
        PreviewColumn {
            name: name.into(),
            values: (0..100).map(value).collect(),
            words,
            ..PreviewColumn::default()
        }
    }

    #[test]
    fn a_name_that_stands_twice_is_said_where_a_wheel_is_missing() {
        let twice = [column("t", &[]), column("w_l", &[]), column("w_l", &[]), column("i_l", &[])];
        let asked = guess(&twice).asked();
        assert!(asked.contains("several columns are called `w_l`: is it one"), "{asked}");
    }

    #[test]
    fn rows_of_several_motors_are_said() {
        let log = [column("motor", &["M1", "M2"]), column("pwm", &[]), column("speed", &[])];
        let g = guess(&log);
        assert!(g.asked().contains("`motor` names the motor of each row (M1, M2)"));
        assert!(!g.one_axis && g.columns.is_empty(), "{:?}", g.columns);
        let numbers = PreviewColumn {
            values: (0..100).map(|k| f64::from(1 + k / 50)).collect(),
            ..column("motor_id", &[])
        };
        let g = guess(&[numbers, column("pwm", &[]), column("rpm", &[])]);
        assert!(g.asked().contains("`motor_id` names the motor of each row (1, 2)"));
    }
}
