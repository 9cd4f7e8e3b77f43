//! Guesses which column of a log is what, and says so.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::recording::DriveUnit;

/// What the columns of a log seem to be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guess {
    /// Contract key, name in the file, unit where it is not that of the contract.
    pub(super) columns: Vec<(&'static str, String, Option<String>)>,
    /// Unit of the drive.
    pub(super) drive_unit: DriveUnit,
}

/// Words that stand for a quantity, the best first; `1` and `2` or right and left are added.
const TIME: [&str; 6] = ["t", "time", "timestamp", "time_s", "t_s", "seconds"];
const ANGLE: [&str; 6] = ["alpha", "angle", "position", "pos", "theta", "enc"];
const SPEED: [&str; 8] = ["dalpha", "omega", "velocity", "speed", "vel", "rpm", "w", "wheel_speed"];
const DRIVE: [&str; 10] =
    ["M", "moment", "torque", "tau", "effort", "current", "i", "voltage", "volt", "V"];
/// Words of a name that is what the robot was told and not what it did.
const WISHED: [&str; 8] =
    ["command", "commands", "cmd", "target", "setpoint", "reference", "desired", "goal"];
const RIGHT: [&str; 5] = ["1", "_1", "_r", "_right", "right"];
const LEFT: [&str; 5] = ["2", "_2", "_l", "_left", "left"];

/// Guesses from the names alone; a name of the contract wins over any other.
pub(super) fn guess(names: &[String]) -> Guess {
    let mut columns = Vec::new();
    let mut put = |key: &'static str, name: Option<&String>| {
        if let Some(name) = name {
            columns.push((key, name.clone(), unit(key, name)));
        }
    };
    put("t", TIME.iter().find_map(|w| find(names, |n| n == *w)));
    let sides = [("alpha1", "alpha2", &ANGLE[..]), ("dalpha1", "dalpha2", &SPEED[..])];
    for (right, left, words) in sides {
        let [r, l] = sides_of(names, words, false);
        put(right, r);
        put(left, l);
    }
    let [drive, other] = sides_of(names, &DRIVE, true);
    put("M1", drive);
    put("M2", other);
    let drive_unit = drive.map_or(DriveUnit::NewtonMetre, |n| drive_unit(n));
    Guess { columns, drive_unit }
}

fn find(names: &[String], fits: impl Fn(&str) -> bool) -> Option<&String> {
    names.iter().find(|n| fits(bare(n).to_lowercase().as_str()))
}

/// The name without a unit behind it.
fn bare(name: &str) -> &str {
    name.split(['[', '(']).next().unwrap_or(name).trim()
}

fn side<'a>(names: &'a [String], words: &[&str], ends: &[&str]) -> Option<&'a String> {
    words.iter().find_map(|word| {
        ends.iter().find_map(|end| {
            let word = word.to_lowercase();
            let trimmed = end.trim_start_matches('_');
            find(names, |n| n == format!("{word}{end}") || n == format!("{trimmed}_{word}"))
        })
    })
}

/// The names of a quantity at the right and at the left wheel: short names such as `vel_r`, or
/// else a pair of long ones that differ in the side only, such as `/drive/right_wheel.velocity`.
fn sides_of<'a>(names: &'a [String], words: &[&str], wished: bool) -> [Option<&'a String>; 2] {
    let short = [side(names, words, &RIGHT), side(names, words, &LEFT)];
    if short.iter().any(Option::is_some) {
        return short;
    }
    // a letter alone says too little inside a long name
    let words = words.iter().map(|w| w.to_lowercase()).filter(|w| w.len() > 1);
    let told = |p: &[String]| p.iter().any(|part| WISHED.contains(&part.as_str()));
    let parts = names.iter().map(|n| (n, parts(n)));
    let parts: Vec<_> = parts.filter(|(_, p)| wished || !told(p)).collect();
    for word in words {
        let says = |part: &String| *part == word || part.strip_suffix('s') == Some(&word);
        let mut fits: Vec<_> = parts.iter().filter(|(_, p)| p.iter().any(says)).collect();
        fits.sort_by_key(|(_, p)| p.len());
        for (right, p) in &fits {
            let mirror: Vec<&str> = p.iter().map(|part| mirrored(part)).collect();
            let left = fits.iter().find(|(_, q)| *q == mirror && q != p);
            if let Some((left, _)) = left {
                return [Some(*right), Some(*left)];
            }
        }
    }
    [None, None]
}

/// The part of a name that stands for the left where this one stands for the right.
fn mirrored(part: &str) -> &str {
    match part {
        "right" => "left",
        "r" => "l",
        _ => part,
    }
}

/// The words that a name is made of, `/drive/LeftVelocity[0]` of drive, left, velocity and 0.
fn parts(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut lower = false;
    for c in name.chars() {
        if !c.is_alphanumeric() || (lower && c.is_uppercase()) {
            out.push(String::new());
        }
        lower = c.is_lowercase();
        if let (true, Some(last)) = (c.is_alphanumeric(), out.last_mut()) {
            last.extend(c.to_lowercase());
        }
    }
    out.retain(|part| !part.is_empty());
    out
}

/// The unit that a name states, where it is not that of the contract.
fn unit(key: &str, name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let has = |w: &str| lower.contains(w);
    let unit = match key {
        "t" if has("ms") => "ms",
        "t" if has("us") => "us",
        "alpha1" | "alpha2" if has("deg") => "deg",
        "alpha1" | "alpha2" if has("rev") => "rev",
        "dalpha1" | "dalpha2" if has("rpm") => "rpm",
        "dalpha1" | "dalpha2" if has("deg") => "deg/s",
        "M1" | "M2" if has("mnm") => "mN m",
        _ => return None,
    };
    Some(unit.into())
}

impl Guess {
    /// The guesses in words.
    pub(super) fn words(&self) -> String {
        let mut out = String::from("guessed from the names of the columns (check them):\n");
        for (key, name, unit) in &self.columns {
            let unit = unit.as_ref().map_or(String::new(), |u| format!(" in {u}"));
            let _ = writeln!(out, "  {key:<8} = {name}{unit}");
        }
        let _ = writeln!(out, "  drive in {}", self.drive_unit.symbol());
        out
    }

    fn entry(&self) -> String {
        let entries: Vec<String> = self
            .columns
            .iter()
            .filter(|(key, name, unit)| name != key || unit.is_some())
            .map(|(key, name, unit)| match unit {
                Some(unit) => format!("{key} = {{ name = {}, unit = {unit:?} }}", text(name)),
                None => format!("{key} = {}", text(name)),
            })
            .collect();
        if entries.is_empty() {
            "# columns  = { t = \"time\", dalpha1 = { name = \"right_rpm\", unit = \"rpm\" } }"
                .into()
        } else {
            format!("columns    = {{ {} }}   # guessed: check", entries.join(", "))
        }
    }
}

/// The text of a commented experiment file; the last of several recordings judges the fit.
pub(super) fn file_text(
    recordings: &[PathBuf],
    folder: &Path,
    guess: &Guess,
    said: &[String],
) -> String {
    let names: Vec<String> = recordings.iter().map(|r| quoted(r, folder)).collect();
    let (train, validation) = if names.len() > 1 {
        (names[..names.len() - 1].join(", "), names[names.len() - 1].clone())
    } else {
        (names[0].clone(), String::new())
    };
    let hint = if names.len() > 1 { "" } else { "   # add one: errors are then judged on it" };
    format!(
        "# What was seen:\n{}\n\n\
         title = \"\"                  # heading of the report\n\n\
         [robot]\npreset = \"amigobot\"         # or construction data: l1_m, l2_m, r_m, …\n\n\
         [recordings]\n\
         train      = [{train}]\n\
         validation = [{validation}]{hint}\n\
         {}\n\
         drive_unit = {:?}           # \"N m\", \"V\" or \"A\": parameters come out per that unit\n\n\
         [model]\neffects = []                # `experiment effects` lists them\n\n\
         [[method]]\nname = \"prediction_error\"   # `experiment methods` lists them\n\n\
         [diagnosis]\ncandidates  = \"all\"\nfalse_alarm = 0.05\nmax_effects = 3\n",
        said.join("\n"),
        guess.entry(),
        guess.drive_unit.symbol(),
    )
}

/// The path of a recording as the file writes it: relative to the file's folder where it can be.
fn quoted(path: &Path, folder: &Path) -> String {
    let relative = if folder.as_os_str().is_empty() {
        path.to_path_buf()
    } else if let Ok(inner) = path.strip_prefix(folder) {
        inner.to_path_buf()
    } else {
        std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
    };
    text(&relative.to_string_lossy())
}

/// Text as TOML writes it; Rust's own escapes are others.
fn text(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The drive unit that a column name or unit stands for.
fn drive_unit(name: &str) -> DriveUnit {
    let lower = name.to_lowercase();
    let mut words = lower.split(|c: char| !c.is_alphabetic());
    let amperes = words.any(|w| matches!(w, "amp" | "amps" | "ampere" | "amperes"));
    if lower.contains("volt") || lower.starts_with('v') {
        DriveUnit::Volt
    } else if lower.contains("current") || amperes || lower.starts_with('i') {
        DriveUnit::Ampere
    } else {
        DriveUnit::NewtonMetre
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_names_and_units_are_guessed() {
        let names = ["time_ms", "right_rpm", "left_rpm", "tau_r", "tau_l"].map(String::from);
        let g = guess(&names);
        let of = |key: &str| g.columns.iter().find(|c| c.0 == key).cloned();
        assert_eq!(of("dalpha1").unwrap().1, "right_rpm");
        assert_eq!(of("dalpha1").unwrap().2.as_deref(), Some("rpm"));
        assert_eq!(of("M2").unwrap().1, "tau_l");
        let names = ["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "V1", "V2"].map(String::from);
        let g = guess(&names);
        assert_eq!(g.drive_unit, DriveUnit::Volt);
        assert_eq!(g.columns.len(), 7);
    }

    #[test]
    fn long_names_of_logs_are_guessed_in_pairs_that_differ_in_the_side_only() {
        let names = [
            "t",
            "/commands/wheel_left.velocity",
            "/commands/wheel_right.velocity",
            "/commands/wheel_left.effort",
            "/commands/wheel_right.effort",
            "/states/arm_right.position",
            "/states/wheel_left.velocity",
            "/states/wheel_right.velocity",
        ];
        let g = guess(&names.map(String::from));
        let found: Vec<_> = g.columns.iter().map(|(key, name, _)| (*key, name.as_str())).collect();
        let expected = [
            ("t", names[0]),
            ("dalpha1", names[7]),
            ("dalpha2", names[6]),
            ("M1", names[4]),
            ("M2", names[3]),
        ];
        assert_eq!(found, expected);
        let names = [
            "t",
            "/Drive/LeftVelocityRadPerSec",
            "/Drive/RightVelocityRadPerSec",
            "/Drive/LeftAppliedVolts",
            "/Drive/RightAppliedVolts",
        ];
        let g = guess(&names.map(String::from));
        assert_eq!((g.columns[3].1.as_str(), g.drive_unit), (names[4], DriveUnit::Volt));
        assert_eq!(g.columns[1].1, names[2]);
    }
}
