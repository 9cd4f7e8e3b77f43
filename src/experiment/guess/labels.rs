//! Columns of words beside those of numbers.

use super::Guess;
use crate::io::PreviewColumn;

/// Names of a column that says whose row it is.
const OWNERS: [&str; 6] = ["motor", "joint", "wheel", "motor_id", "joint_name", "name"];

/// The question of a table whose rows are those of several motors in turn.
pub(super) fn owners(columns: &[PreviewColumn]) -> Option<String> {
    let is_owner = |c: &&PreviewColumn| {
        c.words.len() > 1 && OWNERS.contains(&c.name.trim().to_lowercase().as_str())
    };
    let column = columns.iter().find(is_owner)?;
    Some(format!(
        "`{}` says whose row it is ({}): were the motors measured one after the other? The two wheels must be measured at \
         the same time, in columns of their own",
        column.name,
        column.words.join(", ")
    ))
}

/// The question of directions in words, beside speeds or inputs that are never negative.
pub(super) fn directions(columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let is_direction =
        |c: &&PreviewColumn| c.words.len() == 2 && c.name.to_lowercase().contains("dir");
    let found: Vec<&PreviewColumn> = columns.iter().filter(is_direction).collect();
    let first = found.first()?;
    let is_unsigned = |name: &str| {
        let values = columns.iter().find(|c| c.name == name).map_or(&[][..], |c| &c.values);
        values.iter().all(|v| v.is_nan() || *v >= 0.0)
    };
    let signed =
        guess.columns.iter().filter(|c| c.key.starts_with("dalpha") || c.key.starts_with('M'));
    let unsigned: Vec<String> =
        signed.filter(|c| is_unsigned(&c.name)).map(|c| format!("`{}`", c.name)).collect();
    let names: Vec<String> = found.iter().map(|c| format!("`{}`", c.name)).collect();
    (!unsigned.is_empty()).then(|| {
        format!(
            "{} hold directions in words ({}), and {} are never negative: write the values with their signs into the file",
            names.join(" and "),
            first.words.join(", "),
            unsigned.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    fn column(name: &str, words: &[&str]) -> PreviewColumn {
        let value = |k: i32| if words.is_empty() { f64::from(k % 17) } else { f64::NAN };
        let words = words.iter().map(ToString::to_string).collect();
        PreviewColumn { name: name.into(), values: (0..100).map(value).collect(), words }
    }

    #[test]
    fn directions_in_words_and_rows_of_several_motors_are_said() {
        let log = [
            column("dirL", &["F", "R"]),
            column("dirR", &["F", "R"]),
            column("rpmL", &[]),
            column("rpmR", &[]),
            column("pwmL", &[]),
            column("pwmR", &[]),
        ];
        let said = guess(&log).questions.join("\n");
        assert!(said.contains("`dirL` and `dirR` hold directions in words (F, R)"), "{said}");
        let log = [column("motor", &["M1", "M2"]), column("pwm", &[]), column("speed", &[])];
        let g = guess(&log);
        assert!(g.questions.join("\n").contains("`motor` says whose row it is (M1, M2)"));
        assert!(!g.one_axis && g.columns.is_empty(), "{:?}", g.columns);
    }
}
