//! Interpretation of the values of columns: counts, milliamperes, and open questions.

use super::electrical;
use super::guessed::{About, Guess, Guessed};
use super::model_key::effects_of;
use super::names::named;
pub(super) use super::samples::{
    extent, increases, is_constant, is_never_negative, largest, never_falls, never_varies, short,
    top_of, values_of, whole,
};
use super::times::{no_time, time, time_question};
use crate::io::PreviewColumn;
use crate::math::quantile;
use crate::recording::DriveUnit;

/// Larger than the current of any motor of a small robot \[A\].
const AMPERES: f64 = 200.0;

/// What lengths need.
pub(super) const RADIUS: &str =
    "what is the radius of the wheels? Angles or speeds are lengths: write r_m [m] under [robot]";

/// Whether a unit that a name states is one of this quantity, and not that of the program anyway.
pub(super) fn fits(key: &str, unit: &str) -> bool {
    match key {
        "alpha1" | "alpha2" => {
            matches!(unit, "mrad" | "deg" | "rev" | "ticks" | "m" | "cm" | "mm" | "ft" | "in")
        }
        "dalpha1" | "dalpha2" => {
            let angular = matches!(unit, "mrad/s" | "deg/s" | "rev/s" | "rpm" | "ticks/s");
            angular || matches!(unit, "m/s" | "cm/s" | "mm/s" | "km/h" | "ft/s" | "in/s")
        }
        "M1" | "M2" => {
            let torque =
                matches!(unit, "mN m" | "N mm" | "N cm" | "kgf cm" | "oz in" | "lb in" | "lb ft");
            torque || matches!(unit, "mA" | "mV")
        }
        _ => true,
    }
}

/// Whether a column holds one value and no other, in all recordings.
pub(super) fn never_changes(columns: &[PreviewColumn], one: &Guessed) -> bool {
    columns.iter().filter(|c| c.name == one.name).all(never_varies)
}

/// Share of a speed range below which a sign change is noise of a sensor at rest (judgement).
pub(super) const AT_REST: f64 = 0.05;

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
        let steps = || held.windows(2).map(|w| w[1] - w[0]);
        // without the wraps of a counter
        both_ways((quantile(steps(), 0.02), quantile(steps(), 0.98)))
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
    electrical::speeds(columns, guess);
    let inputs = guess.columns.iter().filter(|c| c.key.starts_with('M'));
    let top = inputs.map(|c| c.scale.unwrap_or(1.0) * top_of(of(&c.name))).fold(0.0, f64::max);
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
    let are_asked = guess.asks_which("alpha1") || guess.asks_which("dalpha1");
    if !angles && !speeds && !are_asked {
        guess.ask("which columns hold the angles (alpha1, alpha2) or speeds (dalpha1, dalpha2) of the wheels?");
    }
    if !guess.columns.iter().any(|c| c.key == "M1") && !guess.asks_which("M1") {
        guess.ask_all(input.or_else(|| no_input(columns, guess)));
    }
    if !guess.columns.iter().any(|c| c.key == "t") {
        // rows of other lines in between have no value
        let held = |c: &PreviewColumn| c.values.iter().copied().filter(|v| v.is_finite()).collect();
        guess.period_open = !columns.iter().map(held).any(|values: Vec<f64>| increases(&values));
        guess.ask(no_time(guess.period_open));
    }
    let asked = time_question(columns, guess);
    guess.ask_all(asked);
}

/// Ends of the names of ODrive's estimates, of firmware 0.5 and from 0.6 on.
const ODRIVE_ANGLES: [&str; 3] =
    ["pos_estimate", "pos_vel_mapper.pos_rel", "pos_vel_mapper.pos_abs"];
const ODRIVE_SPEEDS: [&str; 2] = ["vel_estimate", "pos_vel_mapper.vel"];

/// The unit of a controller whose column names are known and contain no unit.
fn of_controller(values: &[f64], one: &mut Guessed) {
    let (angle, speed) = (one.key.starts_with("alpha"), one.key.starts_with("dalpha"));
    let name = one.name.to_lowercase();
    let is_of_odrive = |ends: &[&str]| ends.iter().any(|end| name.ends_with(end));
    let (unit, scale, per_turn, why) = if angle && is_of_odrive(&ODRIVE_ANGLES) {
        ("rev", None, None, "ODrive counts in turns")
    } else if speed && is_of_odrive(&ODRIVE_SPEEDS) {
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
    if columns.iter().filter(|c| !is_used(c)).all(never_varies) {
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
        first.unit_question(&format!("up to {} in whole numbers: {units}", short(top(first), 0)));
    guess.ask(question);
    let inputs = guess.columns.iter_mut().filter(|c| c.key.starts_with('M') && c.unit.is_none());
    inputs.for_each(|c| c.unit_open = true);
}

/// The unit of a current, where its name states none: of both wheels the same, by the largest value.
fn current(top: f64, one: &mut Guessed) {
    if one.unit.is_none() && !one.scale_open && top > AMPERES {
        one.unit = Some("mA".into());
        one.evidence.push(format!(
            "the inputs reach {}, which would be more than {AMPERES:.0} A: milliamperes",
            short(top, 0)
        ));
    }
}
