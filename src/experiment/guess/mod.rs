//! Guesses which column of a log is what, from names and values, and says why.

mod commands;
mod names;
mod relations;
mod text;
mod values;

use self::names::{Named, Quantity, Side, named};
pub(super) use self::text::{Written, file_text};
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// A column of the log as a quantity of the program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Guessed {
    /// Quantity.
    pub(super) key: &'static str,
    /// Name in the file.
    pub(super) name: String,
    /// Unit, where it is not that of the program.
    pub(super) unit: Option<String>,
    /// Column that holds the nanoseconds of the time.
    pub(super) nanoseconds: Option<String>,
    /// Counts per turn of the wheel.
    pub(super) per_turn: Option<f64>,
    /// Factor on the value.
    pub(super) scale: Option<f64>,
    /// Added after the factor.
    pub(super) offset: Option<f64>,
    /// Column that multiplies the value.
    pub(super) times: Option<String>,
    /// Whether the name does not say which wheel it is.
    pub(super) side_unsure: bool,
    /// What the guess rests on, beside the name.
    pub(super) evidence: Vec<String>,
}

/// What the columns of a log seem to be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guess {
    /// The columns that were found.
    pub(super) columns: Vec<Guessed>,
    /// Unit of the input.
    pub(super) drive_unit: DriveUnit,
    /// Questions that only the user can answer.
    pub(super) questions: Vec<String>,
    /// Whether one axis stands for both wheels.
    pub(super) one_axis: bool,
}

/// A column with what its name says.
struct Candidate<'a> {
    column: &'a PreviewColumn,
    named: Named,
}

/// Guesses from names and values; a name of the program wins over any other.
pub(super) fn guess(columns: &[PreviewColumn]) -> Guess {
    let all: Vec<Candidate> =
        columns.iter().map(|column| Candidate { named: named(&column.name), column }).collect();
    let mut out = Guess {
        columns: vec![],
        drive_unit: DriveUnit::NewtonMetre,
        questions: vec![],
        one_axis: false,
    };
    out.columns.extend(time(&all));
    let mut angles = pair(&all, Some(Quantity::Angle), ANGLES);
    let mut speeds = pair(&all, Some(Quantity::Speed), SPEEDS);
    let two = |(q, unit)| Some((pair(&all, Some(q), ["M1", "M2"])?, unit));
    let mut inputs: Vec<Input> = INPUTS.into_iter().filter_map(two).collect();
    if angles.is_none() && speeds.is_none() {
        // `l` and `r` and no more: counts, where they are whole numbers
        let counts = |pair: &[Guessed; 2]| pair.iter().all(|c| values::are_counts(columns, c));
        angles = pair(&all, None, ANGLES).filter(counts);
    }
    // one axis alone: a column that stands beside pairs is something else, as the current of both motors
    if angles.is_none() && speeds.is_none() && inputs.is_empty() {
        angles = one(&all, Quantity::Angle, ANGLES);
        speeds = one(&all, Quantity::Speed, SPEEDS);
        out.one_axis = angles.is_some() || speeds.is_some();
        let alone = INPUTS.into_iter().map(|(q, unit)| Some((one(&all, q, ["M1", "M2"])?, unit)));
        inputs = alone.flatten().collect();
    }
    let input = input(columns, inputs, angles.as_ref(), speeds.as_ref());
    out.columns.extend(angles.into_iter().flatten());
    out.columns.extend(speeds.into_iter().flatten());
    if let Some((input, unit)) = input {
        out.drive_unit = unit;
        out.columns.extend(input);
    }
    out.questions.extend(which_is_right(&out.columns));
    let battery = all.iter().find(|c| c.named.battery).map(|c| (c.column, c.named.unit));
    values::look(columns, &mut out);
    commands::look(columns, battery, &mut out);
    let hints = relations::hints(columns, &out);
    out.questions.extend(hints);
    out
}

const ANGLES: [&str; 2] = ["alpha1", "alpha2"];
const SPEEDS: [&str; 2] = ["dalpha1", "dalpha2"];
/// What an input may be, the one that says most first.
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
    let named = |end: char| {
        let unsure = columns.iter().filter(|c| c.side_unsure && c.key.ends_with(end));
        unsure.map(|c| format!("`{}`", c.name)).collect::<Vec<_>>().join(", ")
    };
    let (right, left) = (named('1'), named('2'));
    (!right.is_empty()).then(|| {
        format!("is the right wheel that of {right}, and the left one that of {left}? Else exchange them")
    })
}

/// The torques, else the currents, else the voltages; what loses its sign where the wheels turn both ways
/// comes last.
fn input(
    columns: &[PreviewColumn],
    found: Vec<Input>,
    angles: Option<&[Guessed; 2]>,
    speeds: Option<&[Guessed; 2]>,
) -> Option<Input> {
    let magnitude = |pair: &[Guessed; 2]| values::is_magnitude(columns, pair, angles, speeds);
    let mut found: Vec<_> = found.into_iter().map(|i| (magnitude(&i.0), i)).collect();
    // stable: among equals in the order above
    found.sort_by_key(|(magnitude, _)| *magnitude);
    let refused = found.iter().find(|(magnitude, _)| *magnitude).map(|(_, i)| i.0[0].name.clone());
    let (magnitude, mut input) = found.into_iter().next()?;
    if let (Some(other), false) = (refused, magnitude) {
        let why = format!("`{other}` is never negative: a magnitude without sign");
        input.0[0].evidence.push(why);
    }
    Some(input)
}

/// The time: the best name whose values increase, else the one column that always increases.
fn time(all: &[Candidate]) -> Option<Guessed> {
    let rises = |c: &&Candidate| values::increases(&c.column.values);
    let mut named: Vec<&Candidate> =
        all.iter().filter(|c| c.named.quantity == Some(Quantity::Time)).collect();
    // the fewest other words first
    named.sort_by_key(|c| (c.column.name != "t", c.named.rest.len()));
    // the seconds and nanoseconds of one stamp; that of the message before that of its arrival
    let of_stamp = |c: &Candidate| {
        let mut parts = all.iter().filter(|n| n.named.quantity == Some(Quantity::Nanoseconds));
        parts.find(|n| stem(&n.column.name) == stem(&c.column.name))
    };
    let stamped = named.iter().find(|c| of_stamp(c).is_some() && values::whole(&c.column.values));
    let best = stamped
        .copied()
        .or_else(|| named.iter().copied().find(rises))
        .or_else(|| named.first().copied());
    let mut evidence = vec![];
    let found = best.or_else(|| {
        evidence.push("the only column that increases from row to row".into());
        let mut rising = all.iter().filter(rises);
        rising.next().filter(|_| rising.next().is_none())
    })?;
    Some(Guessed {
        key: "t",
        name: found.column.name.clone(),
        unit: found.named.unit.filter(|u| *u != "s").map(Into::into),
        nanoseconds: stamped.and_then(|c| of_stamp(c)).map(|c| c.column.name.clone()),
        evidence,
        ..Guessed::default()
    })
}

/// A name without its last word: `header.stamp.` of `header.stamp.nanosec`.
fn stem(name: &str) -> &str {
    &name[..name.rfind(|c: char| !c.is_alphanumeric()).map_or(0, |end| end + 1)]
}

/// The columns of a quantity at the right and the left wheel: two names that differ in the side only,
/// those of what was measured before those of what was wished, the fewest other words first. Without a quantity
/// names that say the side and nothing else.
fn pair(
    all: &[Candidate],
    quantity: Option<Quantity>,
    keys: [&'static str; 2],
) -> Option<[Guessed; 2]> {
    let is_bare = |c: &&Candidate| quantity.is_some() || c.named.rest.is_empty();
    let of_quantity = all.iter().filter(|c| c.named.quantity == quantity);
    let fits: Vec<&Candidate> = of_quantity.filter(is_bare).collect();
    let partner = |a: &&Candidate| {
        fits.iter().copied().find(|b| {
            let same = a.named.rest == b.named.rest && a.named.wished == b.named.wished;
            let sides = (a.named.side, b.named.side);
            let opposite = matches!(
                sides,
                (Some(Side::Right), Some(Side::Left))
                    | (Some(Side::Numbered(1)), Some(Side::Numbered(2) | Side::Numbered(0)))
            );
            same && opposite
        })
    };
    let exact = |c: &&Candidate| keys.contains(&c.column.name.as_str());
    let mut pairs: Vec<(&Candidate, &Candidate)> =
        fits.iter().copied().filter_map(|a| Some((a, partner(&a)?))).collect();
    pairs.sort_by_key(|(a, _)| (!exact(a), a.named.wished, a.named.rest.len()));
    let (right, left, is_known) = match pairs.first() {
        Some((a, b)) => (*a, *b, !matches!(a.named.side, Some(Side::Numbered(_)))),
        None => lettered(&fits).map(|(a, b)| (a, b, false))?,
    };
    let unsure = !is_known && !exact(&right);
    let of = |c, key| Guessed { side_unsure: unsure, ..of(c, key) };
    Some([of(right, keys[0]), of(left, keys[1])])
}

/// Two columns whose names differ in one letter or number alone, as those of motors B and C.
fn lettered<'a, 'b>(fits: &[&'a Candidate<'b>]) -> Option<(&'a Candidate<'b>, &'a Candidate<'b>)> {
    let differs = |a: &Candidate, b: &Candidate| {
        let (a, b) = (&a.named.rest, &b.named.rest);
        let mut others = a.iter().zip(b).filter(|(a, b)| a != b);
        let short = |word: &String| word.len() == 1;
        let one = others.next().is_some_and(|(a, b)| short(a) && short(b) && a < b);
        a.len() == b.len() && one && others.next().is_none()
    };
    let pairs = || fits.iter().flat_map(|a| fits.iter().map(move |b| (*a, *b)));
    let mut found = pairs().filter(|(a, b)| differs(a, b));
    // with three motors nobody knows which
    found.next().filter(|_| found.next().is_none())
}

/// The one column of a quantity, for both wheels.
fn one(all: &[Candidate], quantity: Quantity, keys: [&'static str; 2]) -> Option<[Guessed; 2]> {
    let fits = |c: &&Candidate| {
        c.named.quantity == Some(quantity) && c.named.side.is_none() && !c.named.wished
    };
    let mut found = all.iter().filter(fits);
    let (first, None) = (found.next()?, found.next()) else { return None };
    Some(keys.map(|key| of(first, key)))
}

fn of(c: &Candidate, key: &'static str) -> Guessed {
    let unit = c.named.unit.filter(|u| values::fits(key, u)).map(Into::into);
    Guessed { key, name: c.column.name.clone(), unit, scale: c.named.scale, ..Guessed::default() }
}

#[cfg(test)]
mod tests;
