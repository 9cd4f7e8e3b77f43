//! The experiment file that `experiment new` writes.

use std::fmt::{Display, Write as _};
use std::path::{Path, PathBuf};

use super::guessed::{About, Guess, Guessed, Question};
use super::lengths::{Length, Lengths};
use super::model_key::effects_of;
use super::names::named;
use super::samples::{never_varies, short};
use super::stated::si;
use crate::diagnose;
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Columns whose first values a question shows at most.
const SHOWN: usize = 40;

/// Content of an experiment file to be written.
pub(in crate::experiment) struct Written<'a> {
    /// Recordings with their use: whether they are of validation.
    pub(in crate::experiment) recordings: &'a [(PathBuf, bool)],
    /// Folder of the file.
    pub(in crate::experiment) folder: &'a Path,
    /// The detected columns.
    pub(in crate::experiment) guess: &'a Guess,
    /// Observations on the recordings, one sentence each.
    pub(in crate::experiment) remarks: &'a [String],
    /// All columns of the first recording.
    pub(in crate::experiment) columns: &'a [PreviewColumn],
    /// Lengths of the robot that are known from the recordings.
    pub(in crate::experiment) lengths: &'a Lengths,
    /// Rows to be held in memory so that errors are corrected, and the memory \[GB\], if more than by default.
    pub(in crate::experiment) hold: Option<(usize, f64)>,
}

impl Guessed {
    /// Whether the counts per turn are needed and not known.
    pub(in crate::experiment) fn needs_per_turn(&self) -> bool {
        self.per_turn.is_none() && self.unit.as_deref().is_some_and(|u| u.starts_with("ticks"))
    }

    /// Whether it counts the turns of the motor's field, of which a turn of the wheel has many.
    pub(in crate::experiment) fn is_electrical(&self) -> bool {
        self.name.to_lowercase().contains("erpm")
    }

    /// The question for its unit, which continues with the `values` and the choice of units.
    pub(super) fn unit_question(&self, values: &str) -> Question {
        let about = About::Unit(self.name.clone());
        Question { about, text: format!("`{}` has values {values}", self.name) }
    }

    /// Whether lengths need the radius of the wheels.
    pub(in crate::experiment) fn is_in_metres(&self) -> bool {
        const LENGTHS: [&str; 11] =
            ["m", "cm", "mm", "ft", "in", "m/s", "cm/s", "mm/s", "km/h", "ft/s", "in/s"];
        self.unit.as_deref().is_some_and(|unit| LENGTHS.contains(&unit))
    }
}

impl Guess {
    /// Whether an input was found.
    pub(in crate::experiment) fn has_input(&self) -> bool {
        self.columns.iter().any(|c| c.key.starts_with('M'))
    }

    /// Whether something of the columns must be filled in.
    pub(in crate::experiment) fn is_open(&self) -> bool {
        columns(self).contains("\"?\"")
    }

    /// Description of the detected columns.
    pub(in crate::experiment) fn words(&self) -> String {
        let mut out = String::from("guessed from names and values of the columns (check them):\n");
        for one in &self.columns {
            let scale = one.scale.map_or(String::new(), |x| format!("{x:.6} "));
            let unit = one.unit.as_ref().map(|u| format!(" in {scale}{u}"));
            let open = if one.unit_open { " in \"?\"" } else { "" };
            let unit = unit.unwrap_or_else(|| open.into());
            let times = one.times.as_ref().map_or(String::new(), |n| format!(" times {n}"));
            let plus: String = one.plus.iter().map(|n| format!(" + {n}")).collect();
            let and = one.nanoseconds.as_ref().map_or(String::new(), |n| format!(" and {n}"));
            let unit = format!("{plus}{and}{times}{unit}");
            let why = one.evidence.join("; ");
            let why = if why.is_empty() { why } else { format!("   ({why})") };
            let _ = writeln!(out, "  {:<8} = {}{unit}{why}", one.key, one.name);
        }
        let _ = match self.has_input() {
            true => writeln!(out, "  input in {}", self.drive_unit.symbol()),
            false => writeln!(out, "  input: not found"),
        };
        if let Some(assumed) = self.assumed() {
            let _ = writeln!(out, "  {assumed}");
        }
        if self.one_axis {
            let _ = writeln!(
                out,
                "  one axis is used for both wheels: a1 is its inertia, a2 and a3 are fixed at zero"
            );
        }
        for question in &self.questions {
            let _ = writeln!(out, "  question: {}", question.text);
        }
        out
    }

    /// The units of columns of which neither name nor values state one. Of commands there is a question.
    fn assumed(&self) -> Option<String> {
        let assumed = |c: &Guessed| {
            let is_open = c.unit_open || c.scale_open || c.is_share;
            // the name of a time may state its rate only
            let is_known = c.unit.is_some() && c.key != "t";
            let is_given = is_known || c.scale.is_some() || c.nanoseconds.is_some();
            let unit = assumed_unit(c.key, &c.name, self.drive_unit)?;
            (!is_open && !is_given).then(|| (c.key, c.unit.clone().unwrap_or(unit.into())))
        };
        assumed_units(self.columns.iter().filter_map(assumed))
    }
}

/// The unit in which a column is read if the file states none; `None` where its name does.
pub(in crate::experiment) fn assumed_unit(
    key: &str,
    name: &str,
    input: DriveUnit,
) -> Option<&'static str> {
    (name != key && named(name).unit.is_none()).then(|| si(key, input))
}

/// The sentence on quantities and their assumed units; `None` where there are none.
pub(in crate::experiment) fn assumed_units<K: Display, U: Display>(
    all: impl Iterator<Item = (K, U)>,
) -> Option<String> {
    let words: Vec<String> = all.map(|(key, unit)| format!("{key} in {unit}")).collect();
    (!words.is_empty()).then(|| format!("assumed, because no unit is stated: {}", words.join(", ")))
}

/// The text of a commented experiment file.
pub(in crate::experiment) fn file_text(w: &Written) -> String {
    let files = |validation: bool| {
        let of = w.recordings.iter().filter(|(_, v)| *v == validation);
        let names: Vec<String> = of.map(|(path, _)| quoted(path, w.folder)).collect();
        names.join(", ")
    };
    let hint = if w.recordings.iter().any(|(_, v)| *v) {
        ""
    } else {
        "   # add one: errors are then computed on it"
    };
    let mut out = String::from("# Observations:\n");
    for line in w.remarks {
        let _ = writeln!(out, "#   {line}");
    }
    for one in &w.guess.columns {
        for why in &one.evidence {
            let _ = writeln!(out, "#   {}: {}", in_a_line(&one.name), in_a_line(why));
        }
    }
    if let Some(assumed) = w.guess.assumed() {
        let _ = writeln!(out, "#   {assumed}");
    }
    questions(&mut out, w);
    let _ = write!(
        out,
        "\ntitle = \"\"                  # heading of the report\n\n{ROBOT}{}\n\
         [recordings]\ntrain      = [{}]\nvalidation = [{}]{hint}\n{}\n{}",
        lengths(w),
        files(false),
        files(true),
        columns(w.guess),
        held_rows(w.hold)
    );
    out.push_str(&other_input(w.guess));
    let _ = write!(
        out,
        "drive_unit = {:?}           # \"N m\", \"V\" or \"A\": parameters are estimated per that unit\n{}",
        w.guess.drive_unit.symbol(),
        input_words(w.guess.drive_unit)
    );
    let diagnose::Settings { false_alarm, max_effects, .. } = diagnose::Settings::default();
    let _ = write!(
        out,
        "\n# [conditioning]             # corrections of the signals, all on; `experiment check` lists them\n\
         # unwrap = true               # also rows, spikes, units, signs, speeds\n\n\
         [model]\n{}                # `experiment effects` lists them\n\n\
         [[method]]\nname = \"prediction_error\"   # `experiment methods` lists them\n\n\
         [[method]]\nname = \"torque_regression\"\n\n\
         [diagnosis]\ncandidates  = \"all\"\nfalse_alarm = {false_alarm}\nmax_effects = {max_effects}\n",
        effects_of(w.guess.drive_unit)
    );
    out
}

/// Remark on the robot.
const ROBOT: &str = "[robot]
# The log does not contain the dimensions of the robot. The parameters a1 to a5 do not depend on them; the path,
# the heading (effect slope) and speeds in m/s do. Give a preset, or the two lengths with \"unknown\"; otherwise these
# are omitted.
preset = \"unknown\"            # amigobot, pioneer_3dx, turtlebot3_burger, e_puck, create_2, regbot, frc_tank_drive
";
const OPTIONAL_TRACK: &str =
    "# l1_m = 0.15                 # half the distance between the wheels [m]\n";
const OPTIONAL_RADIUS: &str = "# r_m  = 0.05                 # radius of the wheels [m]\n";
const RADIUS: &str = "r_m  = \"?\"                    # radius of the wheels [m], of speeds or angles in units of length\n";

/// The keys of the lengths: those that the recordings state or determine, others open or as comments.
fn lengths(w: &Written) -> String {
    let key = |key: &str, length: &Option<Length>, meaning: &str, unknown: &str| match length {
        Some(Length { metres, .. }) => {
            format!("{key:<4} = {metres:.4}               # {meaning} [m], guessed: see above\n")
        }
        None => unknown.to_owned(),
    };
    let in_metres = w.guess.columns.iter().any(Guessed::is_in_metres);
    let without_radius = if in_metres { RADIUS } else { OPTIONAL_RADIUS };
    let Lengths { radius, half_track } = w.lengths;
    key("l1_m", half_track, "half the distance between the wheels", OPTIONAL_TRACK)
        + &key("r_m", radius, "radius of the wheels", without_radius)
}

/// The keys for the currents or voltages that are logged beside the input.
fn other_input(guess: &Guess) -> String {
    let Some((pair, unit)) = &guess.other_input else { return String::new() };
    let [right, left] = pair.each_ref().map(entry);
    let hold = match unit {
        DriveUnit::Volt => ", hold = \"constant\"",
        _ => ", without hold",
    };
    format!(
        "# in place of the input above: {right}, {left}\n# with drive_unit = {:?}{hold}, and under [model] {}\n",
        unit.symbol(),
        effects_of(*unit)
    )
}

fn input_words(unit: DriveUnit) -> &'static str {
    match unit {
        DriveUnit::NewtonMetre => "",
        DriveUnit::Ampere => {
            "# With the torque per ampere at the wheel (motor constant x gear) parameters are in SI units:\n\
             # drive_unit = \"N m\" and torque_constant = 0.1 in M1 and M2 of columns\n"
        }
        DriveUnit::Volt => {
            "hold       = \"constant\"      # a voltage is a command and is held from row to row\n\
             # The input is a voltage: back-EMF is part of the model (kS = a4, kV = k_e, kA = a1 + a2, per radian)\n"
        }
    }
}

/// The key that holds all rows of a long recording.
fn held_rows(hold: Option<(usize, f64)>) -> String {
    hold.map_or_else(String::new, |(rows, gigabytes)| {
        format!(
            "hold_rows  = {rows}      # all rows in memory ({gigabytes:.1} GB): only then are the errors above corrected\n"
        )
    })
}

fn questions(out: &mut String, w: &Written) {
    if w.guess.questions.is_empty() {
        return;
    }
    out.push_str("#\n# Open questions:\n");
    for question in &w.guess.questions {
        let _ = writeln!(out, "#   - {}", in_a_line(&question.text));
    }
    let is_used = |c: &Guessed, name: &str| {
        let beside = [&c.nanoseconds, &c.times, &c.sign].map(Option::as_deref);
        c.name == name || c.plus.iter().any(|n| n == name) || beside.contains(&Some(name))
    };
    let used = |name: &str| w.guess.columns.iter().any(|c| is_used(c, name));
    let mut open: Vec<&PreviewColumn> = w.columns.iter().filter(|c| !used(&c.name)).collect();
    if open.is_empty() {
        return;
    }
    if open.len() > SHOWN {
        // a column of one value is neither motion nor input
        open.sort_by_key(|c| (never_varies(c), named(&c.name).quantity.is_none()));
    }
    out.push_str("# Unused columns, with their first values and their range:\n");
    for column in open.iter().take(SHOWN) {
        let shown: Vec<String> = match &column.texts[..] {
            [] => column.values.iter().take(3).map(|v| first(*v)).collect(),
            texts => texts.iter().map(|text| format!("\"{}\"", in_a_line(text))).collect(),
        };
        let finite = || column.values.iter().copied().filter(|v| v.is_finite());
        let (low, high) =
            (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let range = if low <= high {
            format!("{} .. {}", first(low), first(high))
        } else {
            "no numbers".into()
        };
        let _ =
            writeln!(out, "#   {:<28} {:<32} {range}", in_a_line(&column.name), shown.join(", "));
    }
    if open.len() > SHOWN {
        let _ = writeln!(out, "#   and {} more", open.len() - SHOWN);
    }
}

fn first(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e6 { format!("{value}") } else { short(value, 5) }
}

/// The keys of `columns`; open values are written as `"?"`.
fn columns(guess: &Guess) -> String {
    let mut entries: Vec<String> = guess.columns.iter().filter(|c| says(c)).map(entry).collect();
    let there = |key: &str| guess.columns.iter().any(|c| c.key == key);
    let motion = there("alpha1") || there("dalpha1");
    // the question which columns are the wheels states the keys
    let is_angle = guess.asks_which("alpha1") && !guess.asks_which("dalpha1");
    let wheels = if is_angle { ["alpha1", "alpha2"] } else { ["dalpha1", "dalpha2"] };
    let needed = ["t", wheels[0], wheels[1], "M1", "M2"];
    let open = needed.iter().filter(|key| !(there(key) || wheels.contains(key) && motion));
    entries.extend(open.map(|key| match *key {
        "t" if guess.period.is_some() => {
            format!("t = {{ period = {:?} }}", guess.period.unwrap_or_default())
        }
        "t" if guess.period_open => "t = { period = \"?\" }".into(),
        key => format!("{key} = \"?\""),
    }));
    if entries.is_empty() {
        return "# columns  = { t = \"time\", dalpha1 = { name = \"right_rpm\", unit = \"rpm\" } }"
            .into();
    }
    // a table of its own lines is easier to correct than a long line
    format!("columns    = {{ {} }}   # guessed: check", entries.join(", "))
}

/// Whether an entry differs from the defaults of the program.
fn says(c: &Guessed) -> bool {
    let (name, evidence) = (c.name.clone(), c.evidence.clone());
    let (side_unsure, is_share) = (c.side_unsure, c.is_share);
    c.name != c.key
        || *c != Guessed { key: c.key, name, evidence, side_unsure, is_share, ..Guessed::default() }
}

fn entry(c: &Guessed) -> String {
    let mut keys = vec![format!("name = {}", text(&c.name))];
    keys.extend(c.nanoseconds.as_ref().map(|n| format!("nanoseconds = {}", text(n))));
    keys.extend(c.unit.as_ref().map(|u| format!("unit = {u:?}")));
    keys.extend(c.unit_open.then(|| "unit = \"?\"".into()));
    keys.extend(c.sum.then(|| "sum = true".into()));
    match c.per_turn {
        Some(n) => keys.push(format!("per_turn = {n:.1}")),
        None if c.needs_per_turn() => keys.push("per_turn = \"?\"".into()),
        None => {}
    }
    keys.extend(c.scale.filter(|_| !c.scale_open).map(|x| format!("scale = {x:?}")));
    keys.extend(c.scale_open.then(|| "scale = \"?\"".into()));
    keys.extend(c.offset.map(|x| format!("offset = {x:?}")));
    if !c.plus.is_empty() {
        let names: Vec<String> = c.plus.iter().map(|n| text(n)).collect();
        keys.push(format!("plus = [{}]", names.join(", ")));
    }
    keys.extend(c.times.as_ref().map(|n| format!("times = {}", text(n))));
    keys.extend(c.sign.as_ref().map(|n| format!("sign = {}", text(n))));
    keys.extend(c.sign_open.then(|| "sign = \"?\"".into()));
    keys.extend(c.backward.as_ref().map(|n| format!("backward = {}", text(n))));
    keys.extend(c.backward_open.then(|| "backward = \"?\"".into()));
    match &keys[..] {
        [_] => format!("{} = {}", c.key, text(&c.name)),
        _ => format!("{} = {{ {} }}", c.key, keys.join(", ")),
    }
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

/// Words in a comment, which a line break in them would end.
pub(in crate::experiment) fn in_a_line(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}
