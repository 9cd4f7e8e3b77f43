//! Determines the meaning of the columns of a log from names and values, with the evidence.

mod assigned;
mod beside;
mod body;
mod centred;
mod clock;
mod commands;
mod counts;
mod devices;
mod directions;
mod electrical;
mod guessed;
mod heading;
mod increments;
mod labels;
mod lengths;
mod mirrored;
mod model_key;
mod motors;
mod names;
mod newest;
mod numbers;
mod open_inputs;
mod pairs;
mod plain_inputs;
mod ranges;
mod relations;
mod sampled;
mod samples;
mod shafts;
mod shares;
mod signs;
mod speed_units;
mod stated;
mod text;
mod times;
mod unknown_sides;
mod values;

pub(super) use self::directions::is_direction;
use self::guessed::Candidate;
pub(super) use self::guessed::{About, Guess, Guessed, Question};
pub(super) use self::lengths::Lengths;
use self::names::{Quantity, named};
use self::pairs::Pairs;
pub(super) use self::samples::{add_recording, mark_varying};
pub(super) use self::text::{Written, assumed_unit, assumed_units, file_text, in_a_line};
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Guesses from names and values; a name of the program wins over any other.
pub(super) fn guess(columns: &[PreviewColumn]) -> Guess {
    let mut all: Vec<Candidate> =
        columns.iter().map(|column| Candidate { named: named(&column.name), column }).collect();
    let mut out = Guess {
        columns: vec![],
        drive_unit: DriveUnit::NewtonMetre,
        questions: vec![],
        one_axis: false,
        period_open: false,
        period: None,
        other_input: None,
    };
    beside::matrices(&mut all);
    unknown_sides::by_pairs_of_words(&mut all);
    devices::apply(&mut all);
    out.columns.extend(clock::time(&all));
    body::apply(&mut all);
    out.ask_all(ranges::apply(&mut all, &out));
    out.ask_all(beside::apply(&mut all));
    out.ask_all(plain_inputs::apply(&mut all));
    let owners = labels::owners(columns);
    // a column without a number is none
    all.retain(|c| c.column.values.iter().any(|v| v.is_finite()));
    numbers::apply(&mut all);
    increments::by_name(&mut all);
    unknown_sides::apply(&mut all);
    unknown_sides::by_units(&mut all);
    let mut pairs = Pairs::new(&all);
    let mut wheels = Wheels::of_pairs(&mut pairs, columns);
    let mut inputs = wheels.inputs.iter().map(|(pair, _)| pair);
    let moved = inputs.find(|pair| !pair.iter().any(|c| values::never_changes(columns, c)));
    increments::by_values(columns, moved, &mut wheels.angles, &mut wheels.speeds);
    // one axis alone: a column that stands beside pairs is something else, as the current of both motors
    if !wheels.are_certain() && !pairs.are_several && owners.is_none() {
        let axis = Wheels::of_one_axis(&all);
        if axis.are_moving() && (!wheels.are_moving() || !axis.inputs.is_empty()) {
            out.one_axis = true;
            wheels = axis;
        }
    }
    let are_several = pairs.are_several;
    out.ask_all(pairs.questions);
    out.ask_all(owners);
    let directions = directions::Directions::of(columns);
    wheels.add_to(&mut out, columns, &directions);
    centred::of_converter(columns, &mut out);
    complete(&all, columns, &mut out);
    directions.give(columns, &mut out);
    signs::bounce(columns, &mut out);
    newest::apply(columns, &mut out);
    mirrored::apply(columns, &mut out);
    if !are_several {
        out.ask_all(relations::hints(columns, &out));
    }
    let found = |start: char| out.columns.iter().any(|c| c.key.starts_with(start));
    if !found('M') || !found('a') && !found('d') {
        out.ask_all(labels::repeated(columns));
    }
    body::alone(columns, &mut out);
    out
}

/// Units and scales of the columns that were chosen, and the questions that remain.
fn complete(all: &[Candidate], columns: &[PreviewColumn], out: &mut Guess) {
    assigned::apply(columns, out);
    out.ask_all(which_is_right(&out.columns));
    motors::apply(all, columns, out);
    let batteries = all.iter().filter(|c| c.named.battery).map(|c| (c.column, c.named.unit));
    let battery = commands::battery(&batteries.collect::<Vec<_>>());
    values::units(columns, out);
    increments::per_second(columns, out);
    counts::per_turn(columns, out);
    speed_units::open(columns, out);
    let input = open_inputs::question(columns, out);
    values::questions(columns, out, input);
    stated::apply(out);
    out.ask_all(signs::lost(all, columns, out));
    out.ask_all(signs::counters(columns, out));
    commands::apply(columns, battery, out);
    let remark = labels::without_cells(columns);
    out.columns.iter_mut().take(1).for_each(|c| c.evidence.extend(remark.clone()));
}

/// The columns of the right and the left wheel.
struct Wheels {
    angles: Option<[Guessed; 2]>,
    speeds: Option<[Guessed; 2]>,
    /// Possible inputs, the most informative first.
    inputs: Vec<Input>,
}

impl Wheels {
    /// The columns of both wheels.
    fn of_pairs(pairs: &mut Pairs, columns: &[PreviewColumn]) -> Self {
        let mut angles = pairs.of(Quantity::Angle, ANGLES);
        let mut speeds = pairs.of(Quantity::Speed, SPEEDS);
        let two = |(q, unit)| Some((pairs.of(q, INPUT)?, unit));
        let inputs: Vec<Input> = INPUTS.into_iter().filter_map(two).collect();
        if angles.is_none() && speeds.is_none() {
            // `l` and `r` and no more: counts, where they are whole numbers
            let counts = |pair: &[Guessed; 2]| pair.iter().all(|c| counts::are(columns, c));
            angles = pairs.bare(ANGLES).filter(counts);
            if angles.is_none() && !inputs.is_empty() {
                // with an input present they are speeds, in a unit that is asked for
                speeds = pairs.bare(SPEEDS);
            }
        }
        Self { angles, speeds, inputs }
    }

    /// The columns of one axis, which are used for both wheels.
    fn of_one_axis(all: &[Candidate]) -> Self {
        let input = |(q, unit)| Some((pairs::one(all, q, INPUT)?, unit));
        Self {
            angles: pairs::one(all, Quantity::Angle, ANGLES),
            speeds: pairs::one(all, Quantity::Speed, SPEEDS),
            inputs: INPUTS.into_iter().filter_map(input).collect(),
        }
    }

    /// Whether a motion was found.
    fn are_moving(&self) -> bool {
        self.angles.is_some() || self.speeds.is_some()
    }

    /// Whether the names determine the wheel of a motion, or there is an input.
    fn are_certain(&self) -> bool {
        let is_certain =
            |pair: &Option<[Guessed; 2]>| pair.as_ref().is_some_and(|p| !p[0].side_unsure);
        is_certain(&self.angles) || is_certain(&self.speeds) || !self.inputs.is_empty()
    }

    /// Adds the columns to `out`, of the inputs the most informative one.
    fn add_to(
        self,
        out: &mut Guess,
        columns: &[PreviewColumn],
        directions: &directions::Directions,
    ) {
        let Self { angles, speeds, inputs } = self;
        let mut asked = vec![];
        let motions = [angles.as_ref(), speeds.as_ref()];
        let (inputs, others) = sampled::order(columns, out, inputs);
        let input = input(columns, inputs, motions, directions, &mut asked);
        out.other_input = others.filter(|(_, unit)| input.as_ref().is_some_and(|i| i.1 != *unit));
        out.ask_all(asked);
        out.columns.extend(angles.into_iter().flatten());
        out.columns.extend(speeds.into_iter().flatten());
        if let Some((input, unit)) = input {
            out.drive_unit = unit;
            out.columns.extend(input);
        }
    }
}

const ANGLES: [&str; 2] = ["alpha1", "alpha2"];
const SPEEDS: [&str; 2] = ["dalpha1", "dalpha2"];
const INPUT: [&str; 2] = ["M1", "M2"];
/// Possible inputs, the most informative first.
const INPUTS: [(Quantity, DriveUnit); 3] = [
    (Quantity::Torque, DriveUnit::NewtonMetre),
    (Quantity::Current, DriveUnit::Ampere),
    (Quantity::Voltage, DriveUnit::Volt),
];

/// The columns of an input, and its unit.
type Input = ([Guessed; 2], DriveUnit);

/// The question whether the columns of the right wheel are those of the right one, where their names have numbers
/// or letters alone.
fn which_is_right(columns: &[Guessed]) -> Option<String> {
    // beside columns under the names of the program wheel 1 is the right one, as in these
    if columns.iter().any(|c| c.name == c.key && c.key.contains("alpha")) {
        return None;
    }
    let named = |end: char| {
        let unsure = columns.iter().filter(|c| c.side_unsure && c.key.ends_with(end));
        unsure.map(|c| format!("`{}`", c.name)).collect::<Vec<_>>().join(", ")
    };
    let (right, left) = (named('1'), named('2'));
    (!right.is_empty()).then(|| {
        format!("is the right wheel that of {right}, and the left one that of {left}? Else exchange them")
    })
}

/// The torques, else the currents, else the voltages, of those that change; what loses its sign where the wheels turn
/// both ways comes last.
fn input(
    columns: &[PreviewColumn],
    found: Vec<Input>,
    [angles, speeds]: [Option<&[Guessed; 2]>; 2],
    directions: &directions::Directions,
    questions: &mut Vec<Question>,
) -> Option<Input> {
    let is_still = |i: &Input| i.0.iter().all(|c| values::never_changes(columns, c));
    let (still, found): (Vec<Input>, Vec<Input>) = found.into_iter().partition(is_still);
    let still = still.first().map(|i| match i.0.each_ref().map(|c| &c.name) {
        [one, other] if one == other => format!("`{one}` never changes"),
        [one, other] => format!("`{one}` and `{other}` never change"),
    });
    let magnitude = |pair: &[Guessed; 2]| {
        values::is_magnitude(columns, pair, angles, speeds)
            && !directions.are_of(pair)
            && !centred::are_centred(columns, pair)
    };
    let mut found: Vec<_> = found.into_iter().map(|i| (magnitude(&i.0), i)).collect();
    // stable: among equals in the order above
    found.sort_by_key(|(magnitude, _)| *magnitude);
    let refused = found.iter().find(|(magnitude, _)| *magnitude).map(|(_, i)| i.0[0].name.clone());
    let Some((magnitude, mut input)) = found.into_iter().next() else {
        questions.extend(still.map(|words| Question {
            about: About::StillInput,
            text: format!("{words}: was the input of the motors recorded?"),
        }));
        return None;
    };
    input.0[0].evidence.extend(still);
    if let (Some(other), false) = (refused, magnitude) {
        let why = format!("`{other}` is never negative: a magnitude without sign");
        input.0[0].evidence.push(why);
    }
    Some(input)
}

#[cfg(test)]
mod tests;
