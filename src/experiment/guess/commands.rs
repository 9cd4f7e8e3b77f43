//! Inputs that are commands: a share of the battery's voltage, or a pulse of a servo.

use super::beside::is_output;
use super::centred;
use super::guessed::{Guess, Guessed};
use super::model_key::effects_of;
use super::names::named;
use super::plain_inputs::is_command;
use super::values::{largest, short, values_of, whole};
use crate::conditioning::IMPORT;
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Words of a command that denote a share of the battery voltage, and ambiguous ones.
const SHARES: [&str; 5] = ["duty", "pwm", "power", "pwr", "throttle"];
const PERHAPS: [&str; 3] = ["motor", "mot", "output"];
/// Full scales of controllers: a share, percent, 7 and 8 bits, of Pololu, per mille, 10, 12 and 15 bits.
const FULL: [f64; 9] = [1.0, 100.0, 127.0, 255.0, 400.0, 1000.0, 1023.0, 4095.0, 32767.0];
/// Full scale of the PWM that most boards have: 8 bits.
const PWM: f64 = 255.0;
/// Full scales that a question lists.
const POSSIBLE: usize = 4;
/// Pulse width of a servo, and its neutral value [us].
const PULSE: (f64, f64, f64) = (900.0, 1500.0, 2100.0);
/// Smaller values are PWM values rather than voltages in millivolts.
const LEAST_MILLIVOLTS: f64 = 1000.0;
/// Largest battery voltage of small robots \[V\]; larger numbers may be percent.
const BATTERY_OF_MOST: f64 = 30.0;
/// Voltages of batteries of robots \[V\].
const BATTERIES: (f64, f64) = (2.0, 100.0);

/// Whether all values are pulse widths of a servo.
fn is_pulse(values: &[f64]) -> bool {
    let mut values = values.iter().filter(|v| v.is_finite()).peekable();
    values.peek().is_some() && values.all(|v| (PULSE.0..=PULSE.2).contains(v))
}

/// Subtracts the neutral pulse width of a servo.
fn set_neutral(one: &mut Guessed) {
    one.offset = Some(-PULSE.1);
    one.evidence.push(format!(
        "{:.0} to {:.0} us: a servo pulse with the neutral position {:.0}",
        PULSE.0, PULSE.2, PULSE.1
    ));
}

/// Takes inputs as a share of the voltage of a battery column, of which `full` is the whole.
fn take_share(inputs: &mut [&mut Guessed], column: &PreviewColumn, factor: f64, range: &Range) {
    let full = range.full;
    for one in inputs {
        one.times = Some(column.name.clone());
        if !range.is_shown {
            one.scale_open = true;
            continue;
        }
        one.scale = Some(factor / full).filter(|f| *f != 1.0);
        // what is added stands behind the factor
        one.offset = one.offset.map(|offset| offset * factor / full);
        let milli = if factor == 1.0 { "" } else { ", which is in mV" };
        one.evidence.push(format!("{full} is the full battery voltage{milli}"));
    }
}

/// Completes inputs that are commands: neutral pulse width of a servo, full scale, column of the battery; or
/// adds the questions.
pub(super) fn apply(
    columns: &[PreviewColumn],
    battery: Option<(&PreviewColumn, Option<&str>)>,
    guess: &mut Guess,
) {
    let of = |name: &str| values_of(columns, name);
    if guess.drive_unit == DriveUnit::NewtonMetre {
        let asked = battery.and_then(|(battery, _)| effort(columns, battery, guess));
        guess.ask_all(asked);
    }
    if guess.drive_unit != DriveUnit::Volt {
        return;
    }
    let mut inputs: Vec<&mut Guessed> =
        guess.columns.iter_mut().filter(|c| c.key.starts_with('M')).collect();
    if !are_commands(&inputs) {
        let asked = millivolts(&mut inputs, of);
        guess.ask_all(asked);
        return;
    }
    inputs.iter_mut().for_each(|one| one.is_share = true);
    if is_command(&named(&inputs[0].name)) {
        let why =
            "whole numbers that the speeds do not follow: a PWM, and no set-point of the speed";
        inputs[0].evidence.push(why.into());
    }
    let range = Range::taken(columns, &mut inputs);
    let name = inputs[0].name.clone();
    let volts = battery.and_then(|(column, unit)| Some((column, to_volts(column, unit)?)));
    let asked = if let Some((column, factor)) = volts.filter(|_| !range.is_pulse) {
        take_share(&mut inputs, column, factor, &range);
        range.question_of_battery(&name, column, factor)
    } else if range.rest.is_none()
        && is_volt_sized(range.top, &name, inputs.iter().map(|one| of(&one.name)))
    {
        format!(
            "`{name}` reaches {}: is it in volts, as assumed? For a share of the battery voltage write the volts per unit as scale in M1 and M2",
            range.reaches()
        )
    } else {
        inputs.iter_mut().for_each(|one| one.scale_open = true);
        range.question_of_scale(&name)
    };
    guess.ask(asked);
}

/// Whether inputs without a unit have the names of commands, and none that of volts.
fn are_commands(inputs: &[&mut Guessed]) -> bool {
    let is_command = |one: &&mut Guessed| {
        let is_named = has_one(&SHARES, &one.name) || has_one(&PERHAPS, &one.name);
        let name = named(&one.name);
        one.unit.is_none() && (is_named || is_output(&name) || is_command(&name))
    };
    let is_volt = |one: &&mut Guessed| is_volt(&one.name);
    !inputs.is_empty() && inputs.iter().all(is_command) && !inputs.iter().any(is_volt)
}

/// The values of a command.
struct Range {
    /// Whether it is the pulse width of a servo.
    is_pulse: bool,
    /// Value at rest, if it is not zero.
    rest: Option<f64>,
    /// Largest deviation from rest.
    top: f64,
    /// Deviation for the full voltage.
    full: f64,
    /// Whether name or values show this, and the usual scales of controllers do not only allow it.
    is_shown: bool,
}

impl Range {
    /// The range of inputs, from which their value at rest is subtracted.
    fn taken(columns: &[PreviewColumn], inputs: &mut [&mut Guessed]) -> Self {
        let of = |name: &str| values_of(columns, name);
        let is_pulse = inputs.iter().all(|one| is_pulse(of(&one.name)));
        if is_pulse {
            inputs.iter_mut().for_each(|one| set_neutral(one));
            let top = PULSE.1 - 1000.0;
            return Self { is_pulse, rest: Some(PULSE.1), top, full: top, is_shown: true };
        }
        if let Some(centre) = centred::centre(columns, inputs) {
            centred::shift(inputs, centre);
            return Self {
                is_pulse,
                rest: Some(centre),
                top: centre,
                full: centre,
                is_shown: true,
            };
        }
        let top = inputs.iter().map(|one| largest(of(&one.name))).fold(0.0, f64::max);
        let full = full_scale(top, &inputs[0].name);
        // values reach the end of a scale where the controller limits them to it
        let is_shown =
            full <= 1.0 || says_percent(&inputs[0].name) || top >= (1.0 - IMPORT.full_scale) * full;
        Self { is_pulse, rest: None, top, full, is_shown }
    }

    /// Its largest deviation as it is printed.
    fn reaches(&self) -> String {
        let top = (1e4 * self.top).round() / 1e4;
        if top < 1e7 { top.to_string() } else { short(top, 0) }
    }

    /// The question whether the full scale that is assumed is the voltage of the battery in `column`.
    fn question_of_battery(&self, name: &str, column: &PreviewColumn, factor: f64) -> String {
        if !self.is_shown {
            let possible = FULL.iter().filter(|full| **full >= self.top).take(POSSIBLE);
            let possible: Vec<String> =
                possible.map(|full| format!("{:.3e} for {full}", factor / full)).collect();
            return format!(
                "`{name}` reaches {}: which value is the full voltage of `{}` ({})? Write {factor} divided by it as scale in \
                 M1 and M2, for example {}",
                self.reaches(),
                column.name,
                volts_of(column, factor),
                possible.join(", ")
            );
        }
        format!(
            "`{name}` reaches {}: is {} the full voltage of `{}` ({})? Otherwise write another scale in M1 and M2",
            self.reaches(),
            self.full,
            column.name,
            volts_of(column, factor)
        )
    }

    /// The question for the scale of a share of a battery voltage that is not recorded.
    fn question_of_scale(&self, name: &str) -> String {
        let volts = 12.0 / self.full;
        // more than any battery has would be taken for millivolts
        let (unit, what) = match self.full > BATTERIES.1 {
            true => (format!("{:.3e}", 1.0 / self.full), "the full command"),
            false => ("1.0".into(), "one unit of the command"),
        };
        let (reaches, offset) = match self.rest {
            // what is added stands behind the factor
            Some(rest) => (String::new(), format!(", offset = {}", -rest * 12.0 / self.full)),
            None => (format!(" and reaches {}", self.reaches()), String::new()),
        };
        format!(
            "`{name}` is a share of the battery voltage{reaches}: with {} for the full 12 V write \
             scale = {volts:.5}{offset} in M1 and M2; with scale = {unit} one volt of the results is {what}",
            self.full
        )
    }
}

/// The question whether an effort between -1 and 1 is a torque or a share of the battery voltage.
fn effort(columns: &[PreviewColumn], battery: &PreviewColumn, guess: &Guess) -> Option<String> {
    let of =
        |name: &str| columns.iter().find(|c| c.name == name).map_or(0.0, |c| largest(&c.values));
    let inputs = || guess.columns.iter().filter(|c| c.key.starts_with('M'));
    let is_open = |c: &Guessed| {
        c.unit.is_none() && c.name.to_lowercase().contains("effort") && of(&c.name) <= 1.0
    };
    let first = inputs().next().filter(|_| inputs().all(is_open))?;
    Some(format!(
        "the values of `{}` are between -1 and 1: a torque in N m, as assumed, or a share of the battery voltage? For a share write \
         times = \"{}\" in M1 and M2, drive_unit = \"V\", hold = \"constant\" below it, and {} under [model]",
        first.name,
        battery.name,
        effects_of(DriveUnit::Volt)
    ))
}

/// The battery among columns whose names may denote it: the first with plausible values.
pub(super) fn battery<'a>(
    found: &[(&'a PreviewColumn, Option<&'static str>)],
) -> Option<(&'a PreviewColumn, Option<&'static str>)> {
    found.iter().find(|(column, unit)| to_volts(column, *unit).is_some()).copied()
}

/// Whether numbers are volts and not shares: fractions above one, with a name that states neither.
fn is_volt_sized<'a>(top: f64, name: &str, mut inputs: impl Iterator<Item = &'a [f64]>) -> bool {
    !has_one(&SHARES, name)
        && top > 1.001
        && top < BATTERY_OF_MOST
        && inputs.any(|values| !whole(values))
}

/// Converts voltages above those of any battery from millivolts; adds a question where they would not be
/// voltages either.
fn millivolts<'a>(inputs: &mut [&mut Guessed], of: impl Fn(&str) -> &'a [f64]) -> Option<String> {
    let top = inputs.iter().map(|one| largest(of(&one.name))).fold(0.0, f64::max);
    let is_open = |one: &&mut Guessed| one.unit.is_none() && one.scale.is_none();
    if top <= BATTERIES.1 || !inputs.iter().all(is_open) {
        return None;
    }
    if top < LEAST_MILLIVOLTS {
        let name = &inputs.first()?.name;
        return Some(format!(
            "`{name}` reaches {}, which cannot be volts: a share of the battery voltage, or millivolts? Write the volts per unit as scale in M1 and M2",
            short(top, 0)
        ));
    }
    for one in inputs {
        one.unit = Some("mV".into());
        one.evidence.push(format!("up to {}: millivolts", short(top, 0)));
    }
    None
}

/// Whether a name denotes a share of the battery voltage.
pub(super) fn is_share_word(name: &str) -> bool {
    has_one(&SHARES, name)
}

/// Whether one of the words is in a name.
fn has_one(words: &[&str], name: &str) -> bool {
    let name = name.to_lowercase();
    words.iter().any(|word| name.contains(word))
}

/// Whether a name denotes volts.
fn is_volt(name: &str) -> bool {
    name.to_lowercase().contains("volt") || named(name).unit == Some("V")
}

/// Whether a column name in lower case contains a word for percent.
pub(super) fn is_percent(name: &str) -> bool {
    ["percent", "pct"].iter().any(|word| name.contains(word))
}

/// Whether a name states percent.
fn says_percent(name: &str) -> bool {
    is_percent(&name.to_lowercase()) || name.contains('%')
}

/// The smallest full scale of controllers that contains the value; for PWM that of most boards.
fn full_scale(top: f64, name: &str) -> f64 {
    let lower = name.to_lowercase();
    // no robot moves by one percent: up to one, a share is named so
    if says_percent(name) && top > 1.0 && top <= 100.0 {
        return 100.0;
    }
    let is_pwm = lower.contains("pwm") && top > 1.0;
    if (is_pwm || is_command(&named(name))) && top <= PWM {
        return PWM;
    }
    FULL.into_iter().find(|full| top <= (1.0 + IMPORT.full_scale) * full).unwrap_or(top)
}

/// The range of a battery in words.
fn volts_of(column: &PreviewColumn, factor: f64) -> String {
    let held = || column.values.iter().filter(|v| v.is_finite()).map(|v| factor * v);
    let (low, high) = (held().fold(f64::INFINITY, f64::min), held().fold(0.0, f64::max));
    format!("{low:.1} to {high:.1} V")
}

/// Factor from the column of the battery to volts, if its values are plausible for a battery: no load halves
/// its voltage.
fn to_volts(column: &PreviewColumn, unit: Option<&str>) -> Option<f64> {
    let top = largest(&column.values);
    let low = column.values.iter().copied().filter(|v| v.is_finite()).fold(top, f64::min);
    if unit.is_none() && low < 0.5 * top {
        return None;
    }
    let factors: &[f64] = match unit {
        Some("V") => &[1.0],
        Some("mV") => &[1e-3],
        _ => &[1.0, 1e-3],
    };
    let is_battery = |factor: &&f64| (BATTERIES.0..BATTERIES.1).contains(&(**factor * top));
    factors.iter().find(is_battery).copied()
}
