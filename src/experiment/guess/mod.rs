//! Guesses which column of a log is what, from names and values, and says why.

mod names;
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
    let angles = pair(&all, Quantity::Angle, ["alpha1", "alpha2"], &mut out.questions);
    let speeds = pair(&all, Quantity::Speed, ["dalpha1", "dalpha2"], &mut out.questions);
    let input = input(columns, &all, &speeds, &mut out.questions);
    out.one_axis = [&angles, &speeds].into_iter().flatten().any(|p| p[0].name == p[1].name);
    out.columns.extend(angles.into_iter().flatten());
    out.columns.extend(speeds.into_iter().flatten());
    if let Some((input, unit)) = input {
        out.drive_unit = unit;
        out.columns.extend(input);
    }
    values::look(columns, &mut out);
    out
}

/// The torques, else the currents, else the voltages; what loses its sign where the wheels turn both ways
/// comes last.
fn input(
    columns: &[PreviewColumn],
    all: &[Candidate],
    speeds: &Option<[Guessed; 2]>,
    questions: &mut Vec<String>,
) -> Option<([Guessed; 2], DriveUnit)> {
    let quantities = [
        (Quantity::Torque, DriveUnit::NewtonMetre),
        (Quantity::Current, DriveUnit::Ampere),
        (Quantity::Voltage, DriveUnit::Volt),
    ];
    let mut found: Vec<_> = quantities
        .into_iter()
        .filter_map(|(quantity, unit)| {
            let mut asked = vec![];
            let pair = pair(all, quantity, ["M1", "M2"], &mut asked)?;
            Some((values::is_magnitude(columns, &pair, speeds), pair, unit, asked))
        })
        .collect();
    // stable: among equals in the order above
    found.sort_by_key(|(magnitude, ..)| *magnitude);
    let refused =
        found.iter().find(|(magnitude, ..)| *magnitude).map(|(_, p, ..)| p[0].name.clone());
    let (magnitude, mut pair, unit, asked) = found.into_iter().next()?;
    if let (Some(other), false) = (refused, magnitude) {
        pair[0].evidence.push(format!("`{other}` is never negative: a magnitude without sign"));
    }
    questions.extend(asked);
    Some((pair, unit))
}

/// The time: the best name whose values increase, else the one column that always increases.
fn time(all: &[Candidate]) -> Option<Guessed> {
    let rises = |c: &&Candidate| values::increases(&c.column.values);
    let mut named: Vec<&Candidate> =
        all.iter().filter(|c| c.named.quantity == Some(Quantity::Time)).collect();
    // the fewest other words first
    named.sort_by_key(|c| (c.column.name != "t", c.named.rest.len()));
    let nanoseconds = all.iter().find(|c| c.named.quantity == Some(Quantity::Nanoseconds));
    let best = named.iter().copied().find(rises).or_else(|| named.first().copied());
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
        nanoseconds: nanoseconds.map(|c| c.column.name.clone()),
        evidence,
        ..Guessed::default()
    })
}

/// The columns of a quantity at the right and the left wheel: two names that differ in the side only,
/// those of what was measured before those of what was wished, the fewest other words first.
fn pair(
    all: &[Candidate],
    quantity: Quantity,
    keys: [&'static str; 2],
    questions: &mut Vec<String>,
) -> Option<[Guessed; 2]> {
    let fits: Vec<&Candidate> = all.iter().filter(|c| c.named.quantity == Some(quantity)).collect();
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
    let (right, left) = match pairs.first() {
        Some(pair) => *pair,
        // one axis alone
        None => match fits
            .iter()
            .copied()
            .filter(|c| c.named.side.is_none() && !c.named.wished)
            .collect::<Vec<_>>()[..]
        {
            [one] => (one, one),
            _ => return None,
        },
    };
    if let Some(Side::Numbered(_)) = right.named.side
        && !exact(&right)
    {
        let (r, l) = (&right.column.name, &left.column.name);
        questions
            .push(format!("is `{r}` the right wheel and `{l}` the left one? Else exchange them"));
    }
    let of = |c: &Candidate, key: &'static str| Guessed {
        key,
        name: c.column.name.clone(),
        unit: c.named.unit.filter(|u| values::fits(key, u)).map(Into::into),
        ..Guessed::default()
    };
    Some([of(right, keys[0]), of(left, keys[1])])
}

#[cfg(test)]
mod tests;
