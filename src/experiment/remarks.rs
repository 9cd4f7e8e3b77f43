//! Keys of an experiment file that are right by themselves and do not do what they seem to.

use toml::{Table, Value};

/// What a reader of the file would not expect of it, in sentences. `table` holds its keys as they
/// are written, since a key that was left out is no surprise.
pub(super) fn remarks(table: &Table) -> Vec<String> {
    [unused_length(table), other_gain(table)].into_iter().flatten().collect()
}

/// Length and top speed are those of a rich movement alone.
fn unused_length(table: &Table) -> Option<String> {
    let simulation = table.get("simulation")?.as_table()?;
    let movement = match simulation.get("movement")? {
        Value::String(name) if name == "paper" => {
            "\"paper\", which is as long and as fast as the paper's"
        }
        Value::Array(_) => "written out in segments, which say how long and how fast they are",
        _ => return None,
    };
    let grid = table.get("grid").and_then(Value::as_table);
    let varies = |key: &str| {
        grid.is_some_and(|g| g.contains_key(key) || g.contains_key(&format!("simulation.{key}")))
    };
    if varies("movement") {
        return None;
    }
    let keys = ["duration_s", "top_speed_rad_s"];
    let unused: Vec<String> = keys
        .into_iter()
        .filter(|key| simulation.contains_key(*key) || varies(key))
        .map(|key| format!("simulation.{key}"))
        .collect();
    let (verb, them) = if unused.len() == 1 { ("has", "it") } else { ("have", "them") };
    (!unused.is_empty()).then(|| {
        format!(
            "{} {verb} no effect: the movement is {movement}; take {them} out, or use movement = \
             \"rich\"",
            unused.join(" and ")
        )
    })
}

/// A fuzzy method is fitted in an emulator, with a gain of its own where the file's has none.
fn other_gain(table: &Table) -> Option<String> {
    let emulator = table.get("emulator").and_then(Value::as_table);
    let positive = |v: &Value| v.as_float().or(v.as_integer().map(|k| k as f64)) > Some(0.0);
    let states = |key: &str| emulator.is_some_and(|e| e.contains_key(key));
    if states("poles") || states("matrix") || emulator?.get("gain").is_none_or(positive) {
        return None;
    }
    let methods = table.get("method")?.as_array()?.iter().filter_map(Value::as_table);
    let names: Vec<&str> = methods
        .filter(|m| !m.contains_key("gain"))
        .filter_map(|m| m.get("name")?.as_str())
        .filter(|name| crate::identify::find(name).is_some_and(|m| m.fits_emulator()))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "emulator.gain = 0 is used to judge, not to fit, {}: a fuzzy method is fitted with a \
             gain of 1 1/s unless its [[method]] has a gain; write gain = 0.0 there to fit the free \
             simulation",
            names.join(", ")
        )
    })
}

/// Share of the rows with wheels that turn against each other beyond which it is asked whether a motor is
/// mounted mirrored: nobody but a test of turning drives so.
const OPPOSED: f64 = 2.0 / 3.0;
/// Share of the top speed below which a wheel rests.
const RESTS: f64 = 0.05;

/// The question whether one wheel counts the other way, where the wheels turn against each other nearly always in these
/// rows of speeds.
pub(super) fn opposed(rows: &[[f64; 2]]) -> Option<String> {
    let top = |i: usize| rows.iter().map(|w| w[i].abs()).fold(0.0, f64::max);
    let tops = [top(0), top(1)];
    let moving = rows.iter().filter(|w| (0..2).all(|i| w[i].abs() > RESTS * tops[i]));
    let (mut count, mut against) = (0, 0);
    for w in moving {
        count += 1;
        against += usize::from(w[0] * w[1] < 0.0);
    }
    let share = f64::from(against as u32) / f64::from(count.max(1));
    (share > OPPOSED).then(|| {
        format!(
            "the wheels turn against each other in {:.0} % of the rows: did the robot turn on the spot, or is a \
             motor mounted mirrored? Then write scale = -1 in every column of that wheel",
            100.0 * share
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        remarks(&toml::from_str(text).unwrap()).join("\n")
    }

    #[test]
    fn a_length_that_the_movement_does_not_take_is_named() {
        let text = "[simulation]\nmovement = \"paper\"\nduration_s = 60.0\n";
        assert!(
            said(text).starts_with("simulation.duration_s has no effect: the movement is \"pap")
        );
        assert!(
            said("[simulation]\nmovement = \"paper\"\n[grid]\nduration_s = [4, 8]\n")
                .contains("duration_s has")
        );
        assert_eq!(said("[simulation]\nmovement = \"rich\"\nduration_s = 60.0\n"), "");
        assert_eq!(said("[simulation]\nduration_s = 60.0\n"), "");
        assert_eq!(said(&format!("{text}[grid]\nmovement = [\"rich\", \"paper\"]\n")), "");
        assert_eq!(said("[simulation]\nmovement = \"paper\"\n"), "");
    }

    #[test]
    fn a_fuzzy_method_that_is_fitted_at_another_gain_is_named() {
        let method = "[[method]]\nname = \"fuzzy_anfis\"\n";
        let zero = "[emulator]\ngain = 0.0\n";
        assert!(said(&format!("{zero}{method}")).contains("not to fit, fuzzy_anfis: "));
        assert_eq!(said(&format!("{zero}{method}gain = 0.0\n")), "");
        assert_eq!(said(&format!("[emulator]\ngain = 2\n{method}")), "");
        assert_eq!(said(&format!("[emulator]\npoles = [-1.0, -2.0]\n{method}")), "");
        assert_eq!(said(&format!("{zero}[[method]]\nname = \"output_error\"\n")), "");
    }
}
