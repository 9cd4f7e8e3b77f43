//! Interpretation of the values of columns: time units, counts, milliamperes, and open questions.

use super::electrical;
use super::guessed::{About, Guess, Guessed, Question};
use super::model_key::effects_of;
use super::names::named;
use crate::io::PreviewColumn;
use crate::math::median_high;
use crate::recording::DriveUnit;

/// Rates that logs of robots have \[Hz\].
const RATES: (f64, f64) = (2.0, 2e4);
/// Slower logs of steps of an input \[Hz\], and the slowest where a name states seconds.
const SLOWEST: f64 = 0.5;
const STATED: f64 = 0.1;
/// Shortest duration of a log \[s\].
const SHORTEST: f64 = 4.0;
/// Beyond this a stamp is that of a calendar \[s\]: the year 2001.
const CALENDAR: f64 = 1e9;
/// Values of a counter of 32 bits.
const COUNTER: f64 = 4_294_967_296.0;
/// Larger than the current of any motor of a small robot \[A\].
const AMPERES: f64 = 200.0;

/// What metres need.
pub(super) const RADIUS: &str =
    "what is the radius of the wheels? Angles or speeds are in metres: write r_m under [robot]";

/// Whether a column increases in nearly all rows.
pub(super) fn increases(values: &[f64]) -> bool {
    let up = values.windows(2).filter(|w| w[1] > w[0]).count();
    values.len() > 2 && 20 * up > 19 * (values.len() - 1)
}

/// Whether a unit that a name states is one of this quantity, and not that of the program anyway.
pub(super) fn fits(key: &str, unit: &str) -> bool {
    match key {
        "alpha1" | "alpha2" => matches!(unit, "mrad" | "deg" | "rev" | "ticks" | "m" | "cm" | "mm"),
        "dalpha1" | "dalpha2" => {
            let angular = matches!(unit, "mrad/s" | "deg/s" | "rev/s" | "rpm" | "ticks/s");
            angular || matches!(unit, "m/s" | "cm/s" | "mm/s" | "km/h")
        }
        "M1" | "M2" => {
            let torque =
                matches!(unit, "mN m" | "N mm" | "N cm" | "kgf cm" | "oz in" | "lb in" | "lb ft");
            torque || matches!(unit, "mA" | "mV")
        }
        _ => true,
    }
}

/// The values of a column; none where no column has that name.
pub(super) fn values_of<'a>(columns: &'a [PreviewColumn], name: &str) -> &'a [f64] {
    columns.iter().find(|c| c.name == name).map_or(&[], |c| &c.values)
}

/// Whether no value is negative.
pub(super) fn is_never_negative(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_nan() || *v >= 0.0)
}

/// Whether a column holds one value and no other.
pub(super) fn never_changes(columns: &[PreviewColumn], one: &Guessed) -> bool {
    is_constant(values_of(columns, &one.name))
}

pub(super) fn is_constant(values: &[f64]) -> bool {
    let mut held = values.iter().filter(|v| v.is_finite());
    let first = held.next();
    held.all(|v| Some(v) == first)
}

/// Share of a speed range below which a sign change is noise of a sensor at rest (judgement).
pub(super) const AT_REST: f64 = 0.05;

/// The smallest and the largest of the values and zero.
pub(super) fn extent(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold((0.0, 0.0), |(a, b): (f64, f64), v| (a.min(v), b.max(v)))
}

/// Whether an input never changes its sign although the wheels turn both ways.
pub(super) fn is_magnitude(
    columns: &[PreviewColumn],
    input: &[Guessed; 2],
    angles: Option<&[Guessed; 2]>,
    speeds: Option<&[Guessed; 2]>,
) -> bool {
    let of = |name: &str| values_of(columns, name);
    let both_ways = |(low, high): (f64, f64)| low < -AT_REST * high && high > -AT_REST * low;
    let by_speed = |one: &Guessed| both_ways(extent(of(&one.name)));
    let by_angle = |one: &Guessed| {
        let held: Vec<f64> = of(&one.name).iter().copied().filter(|v| v.is_finite()).collect();
        let mut steps: Vec<f64> = held.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        // without the wraps of a counter
        let at = |share: usize| steps.get(steps.len() * share / 100).copied().unwrap_or_default();
        both_ways((at(2), at(98)))
    };
    let driven = match (speeds, angles) {
        (Some(pair), _) => pair.iter().any(by_speed),
        (None, Some(pair)) => pair.iter().any(by_angle),
        (None, None) => false,
    };
    driven && !input.iter().any(by_speed)
}

/// Adds the units determined from the values of the detected columns, with the evidence.
pub(super) fn units(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |name: &str| values_of(columns, name);
    electrical::currents(columns, guess);
    let inputs = guess.columns.iter().filter(|c| c.key.starts_with('M'));
    let top = inputs.map(|c| c.scale.unwrap_or(1.0) * largest(of(&c.name))).fold(0.0, f64::max);
    for one in &mut guess.columns {
        let values = of(&one.name);
        if one.unit.is_none() {
            of_controller(values, one);
        }
        match one.key {
            "t" => time(values, one),
            "alpha1" | "alpha2" => angle(values, one),
            "M1" | "M2" if guess.drive_unit == DriveUnit::Ampere => current(top, one),
            _ => {}
        }
    }
}

/// Adds the questions raised by the values of the detected columns; if no input was found, the question that
/// lists columns.
pub(super) fn questions(columns: &[PreviewColumn], guess: &mut Guess, input: Option<String>) {
    if let Some(controller) = electrical::mark(columns, guess) {
        guess.ask(controller);
    } else if guess.columns.iter().any(Guessed::is_electrical) {
        guess.ask(
            "erpm counts electrical turns: write 1/(pole pairs of the motor x gear) as scale, 0.14 for 7 pole pairs \
             without gear; a tachometer column has 6 counts per electrical turn: per_turn = 6 x pole pairs x gear",
        );
        guess.columns.iter_mut().for_each(|c| {
            c.scale_open |= c.is_electrical() && c.scale.is_none();
        });
    }
    if guess.columns.iter().any(Guessed::is_in_metres) {
        guess.ask(RADIUS);
    }
    if guess.drive_unit != DriveUnit::Volt {
        whole_inputs(columns, guess);
    }
    let [angles, speeds] = ["alpha", "dalpha"].map(|of| {
        guess.columns.iter().any(|c| c.key.strip_prefix(of).is_some_and(|s| s.len() == 1))
    });
    if !angles && !speeds {
        guess.ask("which columns hold the angles (alpha1, alpha2) or speeds (dalpha1, dalpha2) of the wheels?");
    }
    if !guess.columns.iter().any(|c| c.key == "M1") {
        guess.ask_all(input.or_else(|| no_input(columns, guess)));
    }
    if !guess.columns.iter().any(|c| c.key == "t") {
        // rows of other lines in between have no value
        let held = |c: &PreviewColumn| c.values.iter().copied().filter(|v| v.is_finite()).collect();
        guess.period_open = !columns.iter().map(held).any(|values: Vec<f64>| increases(&values));
        guess.ask(no_time(guess.period_open));
    }
    let asked = time_question(guess);
    guess.ask_all(asked);
}

impl Guess {
    /// Uses the period of the rows that the file states if no column is the time, or if one counts the rows; returns
    /// whether it was needed.
    pub(in crate::experiment) fn take_period(&mut self, period: f64) -> bool {
        match self.columns.iter_mut().find(|c| c.key == "t") {
            Some(t) if t.scale_open => {
                (t.scale, t.scale_open) = (Some(period), false);
            }
            Some(_) => return false,
            None => {
                (self.period, self.period_open) = (Some(period), false);
            }
        }
        self.answer(&About::Period);
        true
    }
}

/// The question on a column that was used as the time and may be another quantity.
fn time_question(guess: &Guess) -> Option<Question> {
    let time = guess.columns.iter().find(|c| c.key == "t")?;
    if time.scale_open {
        Some(no_step(&time.name))
    } else if time.unit_open {
        Some(Question::from(format!(
            "`{}` is the only column that increases from row to row: is it the time? If so, write its unit; if it is a position, write the time column as name, or t = {{ period = 0.02 }} for a constant sampling period",
            time.name
        )))
    } else {
        None
    }
}

/// The question for the step of a column that counts rows.
fn no_step(name: &str) -> Question {
    let text =
        format!("`{name}` counts rows: what is the sampling period [s]? Write it as scale of t");
    Question { about: About::Period, text }
}

/// The question if no time column was found.
fn no_time(period_open: bool) -> Question {
    let text = if period_open {
        "what is the sampling period [s]? No column increases steadily: if the period is constant, write t = { period = 0.02 }; otherwise the name of the time column (t)"
    } else {
        "which column contains the time (t)? If none does and rows come at a fixed period, write t = { period = 0.02 }"
    };
    Question { about: About::Period, text: text.into() }
}

/// The unit of a controller whose column names are known and contain no unit.
fn of_controller(values: &[f64], one: &mut Guessed) {
    let (angle, speed) = (one.key.starts_with("alpha"), one.key.starts_with("dalpha"));
    let name = one.name.to_lowercase();
    let (unit, scale, per_turn, why) = if angle && name.ends_with("pos_estimate") {
        ("rev", None, None, "ODrive counts in turns")
    } else if speed && name.ends_with("vel_estimate") {
        ("rev/s", None, None, "ODrive counts in turns")
    } else if !name.contains("present_") || !whole(values) {
        return;
    } else if angle {
        ("ticks", None, Some(4096.0), "a Dynamixel of series X has 4096 counts per turn")
    } else if speed {
        ("rpm", Some(0.229), None, "a Dynamixel of series X counts speed in 0.229 rpm")
    } else if name.contains("current") {
        ("mA", Some(2.69), None, "a Dynamixel of series X counts current in 2.69 mA")
    } else {
        return;
    };
    (one.unit, one.scale, one.per_turn) = (Some(unit.into()), scale, per_turn);
    one.evidence.push(why.into());
}

/// The unit of a time that its name does not state, from its rate.
pub(super) fn time(values: &[f64], one: &mut Guessed) {
    let is_known =
        one.unit.is_some() || one.unit_open || one.nanoseconds.is_some() || one.scale_open;
    let Some(step) = row_step(values, one.sum).filter(|_| !is_known) else { return };
    let held = || values.iter().copied().filter(|v| v.is_finite());
    let (first, last) = if one.sum {
        (0.0, held().sum())
    } else {
        (held().next().unwrap_or_default(), held().next_back().unwrap_or_default())
    };
    // rows in disorder have no rate; a counter may wrap
    let is_back = one.scale.is_some_and(|scale| scale < 0.0);
    if last <= first && !is_back && !increases(values) {
        return;
    }
    let passed = match values.windows(2).any(|w| w[1] < w[0]) && !one.sum && !is_back {
        true => values.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0).sum(),
        false => last - first,
    };
    // counters of 32 bits are beyond the seconds of a calendar, which advance more slowly
    let is_counter = whole(values) && largest(values) < COUNTER && step * STATED > 1.0;
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let rate = |factor: f64| 1.0 / (step * factor);
    let sound = |factor: f64| {
        let calendar = first * factor > 0.3 * CALENDAR && first * factor < 4.0 * CALENDAR;
        rate(factor) >= RATES.0
            && rate(factor) <= RATES.1
            && (first < CALENDAR || calendar || is_counter)
    };
    if are_days(first) && !sound(1.0) && (RATES.0..RATES.1).contains(&rate(DAY)) {
        let (steps, seconds) = (DAY * step, passed * DAY);
        one.unit = Some("d".into());
        one.evidence.push(format!(
            "from {first:.4}, in steps of {steps:.4} s as days: days of a calendar ({seconds:.1} s at {:.0} Hz)",
            rate(DAY)
        ));
        return;
    }
    // fractions at a slow rate are not milliseconds if those would give an implausible log
    let is_slow = !whole(values)
        && (SLOWEST..RATES.0).contains(&rate(1.0))
        && passed * 1e-3 < SHORTEST
        && first < CALENDAR;
    let is_stated = named(&one.name).unit == Some("s") && (STATED..RATES.1).contains(&rate(1.0));
    if is_slow || is_stated {
        return;
    }
    let Some((unit, factor)) = units.into_iter().find(|(_, f)| sound(*f)) else { return };
    if unit != "s" {
        one.unit = Some(unit.into());
        one.evidence.push(format!(
            "{:.0} s at {:.3} Hz would be no log: this is {unit} ({:.1} s at {:.0} Hz)",
            passed,
            1.0 / step,
            passed * factor,
            rate(factor)
        ));
    }
}

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// Whether a number may be that of a day of 1990 to 2090: since 1900 (spreadsheets), 1970 or the year 0 (MATLAB).
fn are_days(first: f64) -> bool {
    [0.0, 25_569.0, -693_960.0].iter().any(|epoch| (32_874.0..69_400.0).contains(&(first + epoch)))
}

/// Repeated stamps for each that differs beyond which a clock is coarser than the rows.
const COARSE: f64 = 0.5;

/// Time between two rows, in the unit of the column, which holds times or steps.
pub(super) fn row_step(values: &[f64], are_steps: bool) -> Option<f64> {
    let steps: Vec<f64> =
        if are_steps { values.to_vec() } else { values.windows(2).map(|w| w[1] - w[0]).collect() };
    let forward = || steps.iter().copied().filter(|h| *h > 0.0);
    let (count, repeated) =
        (forward().count() as f64, steps.iter().filter(|h| **h == 0.0).count() as f64);
    let step = (count > 0.0).then(|| median_high(forward()))?;
    Some(if repeated > COARSE * count { step * count / (count + repeated) } else { step })
}

/// Seconds of a unit of time.
pub(super) fn seconds(time: &Guessed) -> f64 {
    match time.unit.as_deref() {
        Some("ms") => 1e-3,
        Some("us") => 1e-6,
        Some("ns") => 1e-9,
        Some("min") => 60.0,
        Some("h") => 3600.0,
        Some("d") => DAY,
        _ => 1.0,
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|v| v.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()))
}

pub(super) fn whole(values: &[f64]) -> bool {
    values.iter().all(|v| !v.is_finite() || v.fract() == 0.0)
}

/// Largest whole angle in radians; larger ones are in other units.
pub(super) const COUNTED: f64 = 50.0;

fn angle(values: &[f64], one: &mut Guessed) {
    if one.unit.is_none() && whole(values) && largest(values) > COUNTED {
        one.unit = Some("ticks".into());
        one.evidence.push("whole numbers: counts of an encoder".into());
    }
}

/// The question if no input was found; `None` if no column is left and one that never changes was asked for.
fn no_input(columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let is_used = |c: &&PreviewColumn| guess.columns.iter().any(|g| g.name == c.name);
    if columns.iter().filter(|c| !is_used(c)).all(|c| is_constant(&c.values)) {
        let none = "this log contains no input: record the torques, currents or voltages of the motors (M1, M2), without \
                    which the dynamics cannot be found";
        let is_asked = guess.questions.iter().any(|asked| asked.about == About::StillInput);
        (!is_asked).then(|| none.into())
    } else {
        Some(format!(
            "which columns hold the torques, currents or voltages of the motors (M1, M2)? Write their unit as \
             drive_unit; of voltages and PWM also hold = \"constant\" below it, and {} under [model]",
            effects_of(DriveUnit::Volt)
        ))
    }
}

/// Whole numbers beyond this are rather thousandths or counts of a converter than amperes or newton metres.
const WHOLE_INPUTS: f64 = 10.0;

/// Asks for the unit of integer-valued currents or torques that nothing determines.
fn whole_inputs(columns: &[PreviewColumn], guess: &mut Guess) {
    let top = |c: &Guessed| largest(values_of(columns, &c.name));
    let is_open = |c: &Guessed| {
        let values = values_of(columns, &c.name);
        let is_stated = c.unit.is_some() || c.scale.is_some() || named(&c.name).unit.is_some();
        c.key.starts_with('M') && !is_stated && whole(values) && top(c) > WHOLE_INPUTS
    };
    let open: Vec<bool> = guess.columns.iter().map(is_open).collect();
    let Some(first) = open.iter().position(|open| *open).map(|k| &guess.columns[k]) else { return };
    let units = match guess.drive_unit {
        DriveUnit::NewtonMetre => {
            "a torque in N m or mN m? Write it as unit; of per mille of the rated torque (CiA 402, as CANopen and \
             EtherCAT drives send it) write unit = \"N m\" and a thousandth of the rated torque as scale"
        }
        _ => {
            "a current in A or mA? Write it as unit; of counts of a converter write unit = \"A\" and the amperes of one \
             count as scale"
        }
    };
    let question =
        first.unit_question(&format!("up to {:.0} in whole numbers: {units}", top(first)));
    guess.ask(question);
    let inputs = guess.columns.iter_mut().filter(|c| c.key.starts_with('M') && c.unit.is_none());
    inputs.for_each(|c| c.unit_open = true);
}

/// The unit of a current, where its name states none: of both wheels the same, by the largest value.
fn current(top: f64, one: &mut Guessed) {
    if one.unit.is_none() && top > AMPERES {
        one.unit = Some("mA".into());
        one.evidence.push(format!(
            "the inputs reach {top:.0}, which would be more than {AMPERES:.0} A: milliamperes"
        ));
    }
}
