//! Columns of words beside those of numbers.

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
    fn rows_of_several_motors_are_said() {
        let log = [column("motor", &["M1", "M2"]), column("pwm", &[]), column("speed", &[])];
        let g = guess(&log);
        assert!(g.questions.join("\n").contains("`motor` says whose row it is (M1, M2)"));
        assert!(!g.one_axis && g.columns.is_empty(), "{:?}", g.columns);
    }
}
