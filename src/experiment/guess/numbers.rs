//! Several numbers in a name: `axis1.encoder_estimator0.vel_estimate`.

use super::guessed::Candidate;
use super::names::Side;

/// Takes that number for the one of the wheel in which two names of a quantity differ, where the last one, which was
/// taken, is the same in both.
pub(super) fn apply(all: &mut [Candidate]) {
    let found: Vec<(usize, usize)> = (0..all.len())
        .filter_map(|k| all.iter().find_map(|other| other_number(&all[k], other)).map(|at| (k, at)))
        .collect();
    for (k, at) in found {
        let named = &mut all[k].named;
        let Some(Side::Numbered(last)) = named.side else { continue };
        let own = std::mem::replace(&mut named.rest[at], last.to_string());
        named.side = own.parse().ok().map(Side::Numbered);
    }
}

/// The place of the one word in which a name differs from that of another column, if both are numbers of wheels.
fn other_number(one: &Candidate, other: &Candidate) -> Option<usize> {
    let (a, b) = (&one.named, &other.named);
    let is_number = |word: &String| matches!(word.as_str(), "0" | "1" | "2");
    let alike = matches!(a.side, Some(Side::Numbered(_)))
        && a.rest.len() == b.rest.len()
        && (a.quantity, a.side, a.wished, a.unit) == (b.quantity, b.side, b.wished, b.unit);
    let mut differ = (0..a.rest.len()).filter(|k| alike && a.rest[*k] != b.rest[*k]);
    let at = differ.next().filter(|k| is_number(&a.rest[*k]) && is_number(&b.rest[*k]))?;
    differ.next().is_none().then_some(at)
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn of_several_numbers_the_one_that_differs_is_that_of_the_wheel() {
        let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
            name: name.into(),
            values: (0..400).map(|k| of(0.05 * f64::from(k))).collect(),
            ..PreviewColumn::default()
        };
        let columns: Vec<PreviewColumn> = [0, 1]
            .into_iter()
            .flat_map(|k| {
                let axis = |rest: &str| format!("axis{k}.{rest}");
                [
                    column(&axis("encoder_estimator0.vel_estimate"), &|t: f64| 2.0 * t.sin()),
                    column(&axis("motor.foc.Iq_measured"), &|t: f64| t.cos()),
                ]
            })
            .chain([column("time", &|t| t)])
            .collect();
        let g = guess(&columns);
        let name = |key: &str| &g.columns.iter().find(|c| c.key == key).unwrap().name;
        // the same axis, whichever it is
        assert_eq!(name("dalpha1")[..5], name("M1")[..5]);
        assert_eq!(name("dalpha2")[..5], name("M2")[..5]);
        assert_ne!(name("M1")[..5], name("M2")[..5]);
    }
}
