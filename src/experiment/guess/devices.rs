//! Numbers of devices on a bus in place of those of the wheels: `TalonFX-11`, `node 4`.

use super::guessed::Candidate;
use super::names::{Quantity, Side, named_with};
use crate::io::words;

/// Numbers that are those of a wheel already.
const OF_WHEELS: [&str; 3] = ["0", "1", "2"];

/// Interprets two numbers as those of the wheels where names of a motion and of an input differ in them alone, and no
/// motion has a side by a word. Which is the right one is asked, as for motors 1 and 2.
pub(super) fn apply(all: &mut [Candidate]) {
    let is_sided = |c: &Candidate| matches!(c.named.side, Some(Side::Right | Side::Left));
    if all.iter().any(|c| is_sided(c) && is_of(c, true)) {
        return;
    }
    let [motions, inputs] = [true, false].map(|motion| differing(all, motion));
    let mut found: Vec<[String; 2]> = motions.into_iter().filter(|p| inputs.contains(p)).collect();
    found.sort();
    found.dedup();
    let [[first, second]] = &found[..] else { return };
    if [first, second].iter().all(|number| OF_WHEELS.contains(&number.as_str())) {
        return;
    }
    let as_wheel = |word: String| match word {
        word if word == *first => "1".into(),
        word if word == *second => "2".into(),
        word => word,
    };
    for c in all.iter_mut() {
        if words(&c.column.name).iter().any(|word| word == first || word == second) {
            c.named = named_with(&c.column.name, &as_wheel);
        }
    }
}

/// Whether a column is one of a motion, or one of an input.
fn is_of(c: &Candidate, motion: bool) -> bool {
    match c.named.quantity {
        Some(Quantity::Angle | Quantity::Speed) => motion,
        Some(Quantity::Torque | Quantity::Current | Quantity::Voltage) => !motion,
        _ => false,
    }
}

/// The numbers in which two names of one quantity differ and in nothing else, the smaller one first.
fn differing(all: &[Candidate], motion: bool) -> Vec<[String; 2]> {
    let named = |c: &Candidate| (words(&c.column.name), c.named.quantity);
    let names: Vec<_> = all.iter().filter(|c| is_of(c, motion)).map(named).collect();
    let both = names.iter().flat_map(|a| names.iter().map(move |b| (a, b)));
    both.filter(|((a, of), (b, other))| a.len() == b.len() && of == other)
        .filter_map(|((a, _), (b, _))| {
            let mut differ = a.iter().zip(b).filter(|(a, b)| a != b);
            let (one, other) = differ.next()?;
            let is_less = one.parse::<u32>().ok()? < other.parse::<u32>().ok()?;
            (is_less && differ.next().is_none()).then(|| [one.clone(), other.clone()])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn numbers_of_devices_are_those_of_the_wheels_and_which_is_right_is_asked() {
        let column = |name: &str| PreviewColumn {
            name: name.into(),
            values: (0..200).map(|k| 50.0 * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        let log = |numbers: &[u32]| {
            let of = |n: &u32| {
                [format!("TalonFX-{n}/Velocity (rpm)"), format!("TalonFX-{n}/MotorVoltage (V)")]
            };
            guess(&numbers.iter().flat_map(of).map(|name| column(&name)).collect::<Vec<_>>())
        };
        let g = log(&[1, 3]);
        let name = |key: &str| g.columns.iter().find(|c| c.key == key).map(|c| &*c.name);
        assert_eq!(name("dalpha1"), Some("TalonFX-1/Velocity (rpm)"), "{}", g.asked());
        assert_eq!(name("M2"), Some("TalonFX-3/MotorVoltage (V)"));
        assert!(g.asked().contains("is the right wheel that of `TalonFX-1"), "{}", g.asked());
        // of four motors any two may be those of one side
        assert!(!log(&[1, 3, 11, 12]).columns.iter().any(|c| c.key == "dalpha1"));
    }
}
