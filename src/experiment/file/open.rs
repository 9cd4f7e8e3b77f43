//! Open questions of `experiment new`: values written as `"?"`.

use toml::{Table, Value};

use super::FileError;

/// Refuses a file with open questions, listing all of them.
pub(super) fn refuse_open(file: &str, table: &Table) -> Result<(), FileError> {
    let mut open = vec![];
    for (table, key) in [(table.get("recordings"), "recordings"), (table.get("robot"), "robot")] {
        collect(key, table, &mut open);
    }
    let Some(first) = open.first().cloned() else { return Ok(()) };
    // keys with the same question are combined in one sentence
    let mut groups: Vec<(&str, Vec<&str>)> = vec![];
    for key in &open {
        let wanted = wanted(key);
        match groups.iter_mut().find(|(w, _)| *w == wanted) {
            Some((_, keys)) => keys.push(key),
            None => groups.push((wanted, vec![key])),
        }
    }
    let remedies =
        groups.iter().map(|(wanted, keys)| format!("{}: write {wanted}", keys.join(", ")));
    let remedies = remedies.collect::<Vec<_>>().join("; ");
    let message = format!("= \"?\" is still open. {remedies}");
    Err(FileError::Value { file: file.into(), key: first, message })
}

/// Dotted keys below `key` with a question mark as value.
fn collect(key: &str, value: Option<&Value>, out: &mut Vec<String>) {
    match value {
        Some(Value::String(text)) if text == "?" => out.push(key.into()),
        Some(Value::Table(table)) => {
            table.iter().for_each(|(k, v)| collect(&format!("{key}.{k}"), Some(v), out));
        }
        _ => {}
    }
}

/// The expected value in place of the question mark.
fn wanted(key: &str) -> &'static str {
    match key.rsplit('.').next().unwrap_or_default() {
        "per_turn" => "the counts of the encoder per turn of the wheel (lines x 4 x gear)",
        "unit" => "the unit of the column; the comments above list the possibilities",
        "scale" if key.ends_with(".t.scale") => {
            "the sampling period [s], because the column counts rows"
        }
        "scale" => {
            "the factor on the values, with its sign; the comments above list the possibilities"
        }
        "sign" => {
            "the name of the column with the direction, or remove `sign` if the values are signed; without \
             a direction, sign_from_speed = true under [conditioning] gives them the sign of the speed (wrong while braking)"
        }
        "backward" => "the content of the direction column for negative values, in quotes",
        "period" => "the sampling period [s], or t = \"…\" with the name of the time column",
        "r_m" => "the radius of the wheels [m]",
        _ => "the name of a column of the recording; the comments above list them",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_open_value_is_named_with_what_it_needs() {
        let text = "[recordings.columns]\nM1 = \"?\"\nalpha1 = { name = \"e\", per_turn = \"?\" }\n\
                    [robot]\nr_m = \"?\"\n";
        let said = |text: &str| refuse_open("e.toml", &toml::from_str(text).unwrap());
        let error = said(text).unwrap_err().to_string();
        for part in [
            "e.toml: recordings.columns.M1 = \"?\" is still open. recordings.columns.M1: write the name",
            "; recordings.columns.alpha1.per_turn: write the counts",
            "; robot.r_m: write the radius",
        ] {
            assert!(error.contains(part), "{error}");
        }
        assert_eq!(said("title = \"?\"\n"), Ok(()));
    }
}
