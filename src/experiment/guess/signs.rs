//! Speeds that lost their sign.

use super::guessed::{Candidate, Guess, Guessed};
use super::names::Quantity;
use super::values::{AT_REST, extent, is_never_negative, never_falls, values_of};
use crate::io::PreviewColumn;

/// The question on speeds that are never negative although their set-points are: the wheels turned both ways,
/// and only a log with signs shows the direction.
pub(super) fn lost(all: &[Candidate], columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let of = |name: &str| values_of(columns, name);
    let mut speeds = guess.columns.iter().filter(|c| c.key.starts_with("dalpha")).peekable();
    let first = speeds.peek()?.name.clone();
    let wished = |c: &&Candidate| {
        c.named.wished
            && c.named.side.is_some()
            && matches!(c.named.quantity, None | Some(Quantity::Speed))
    };
    let asked = all.iter().filter(wished).find(|c| turns_back(&c.column.values))?;
    speeds.all(|c| !turns_back(of(&c.name))).then(|| {
        format!(
            "`{}` is negative at times and `{first}` never is: a magnitude? Without its sign a motion back is one \
             forward; record speeds and inputs with their signs",
            asked.column.name
        )
    })
}

/// Share of the largest input beyond which it drives backward, rows after which a wheel has stopped under it, and number of
/// such drives (judgement).
const BACKWARD: f64 = 0.2;
const STOPPED: usize = 20;
const DRIVES: usize = 3;

/// The question on counters that never fall, although their input drives them backward for long.
pub(super) fn counters(columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let of = |key: &str| guess.columns.iter().find(|c| c.key == key);
    let [angles, inputs] = [["alpha1", "alpha2"], ["M1", "M2"]].map(|keys| keys.map(of));
    let is_one = |(angle, input): (&Option<&Guessed>, &Option<&Guessed>)| {
        let values = |one: &Option<&Guessed>| one.map(|c| values_of(columns, &c.name));
        let Some((counts, input)) = values(angle).zip(values(input)) else { return false };
        never_falls(counts) && drives_back(counts, input) >= DRIVES
    };
    if !angles.iter().zip(&inputs).all(is_one) {
        return None;
    }
    let [angle, input] = [angles[0]?, inputs[0]?].map(|c| &c.name);
    Some(format!(
        "`{angle}` never falls, although `{input}` drives the wheel backward for long: a counter without direction? It counts \
         a motion back as one forward: record both channels of the encoder, or use rows with motion in one direction alone"
    ))
}

/// How often `counts` still rise when an input has driven backward for longer than it takes to stop.
fn drives_back(counts: &[f64], input: &[f64]) -> usize {
    let limit = -BACKWARD * input.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let (mut rows, mut found) = (0, 0);
    for (k, u) in input.iter().enumerate().take(counts.len()) {
        rows = if *u < limit { rows + 1 } else { 0 };
        found += usize::from(rows == 2 * STOPPED && counts[k] > counts[k - STOPPED]);
    }
    found
}

/// Rows over which a speed is compared on either side of its lowest.
const BESIDE: usize = 3;
/// Share of the largest speed below which a wheel is at rest, and by which the speed must change in those
/// rows.
const STANDS: f64 = 0.06;
const GAINS: f64 = 0.02;
/// Largest ratio of the slopes, and smallest number of bounces of a magnitude (judgement).
const ALIKE: f64 = 2.5;
const BOUNCES: usize = 3;

/// Marks the sign of speeds as open that are never negative and repeatedly rise from zero as steeply as they
/// fell to it: a wheel that reverses, without its sign. A wheel that stops is held by friction.
pub(super) fn bounce(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |name: &str| values_of(columns, name);
    let is_magnitude = |name: &str| is_never_negative(of(name));
    let speeds: Vec<&str> = guess
        .columns
        .iter()
        .filter(|c| c.key.starts_with("dalpha"))
        .map(|c| c.name.as_str())
        .collect();
    if speeds.is_empty()
        || guess.columns.iter().any(|c| c.sign.is_some())
        || !speeds.iter().all(|name| is_magnitude(name))
    {
        return;
    }
    let bounces = speeds.iter().map(|name| bounces(of(name))).max().unwrap_or(0);
    if bounces < BOUNCES {
        return;
    }
    guess.ask(format!(
        "`{}` is never negative and {bounces} times rises from zero as steeply as it fell to zero: is it a magnitude? Write the column with the direction as sign, or record signed values; if the wheels only turned forward, remove sign",
        speeds[0]
    ));
    for one in
        guess.columns.iter_mut().filter(|c| c.key.starts_with("dalpha") || c.key.starts_with('M'))
    {
        one.sign_open = is_magnitude(&one.name);
    }
}

/// How often values fall to about zero and rise again with the same slope.
fn bounces(values: &[f64]) -> usize {
    let held: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let (_, top) = extent(&held);
    let at = |k: usize, by: isize| held[k.saturating_add_signed(by * BESIDE as isize)];
    let is_bounce = |k: &usize| {
        let slopes = [
            at(*k, -2) - at(*k, -1),
            at(*k, -1) - held[*k],
            at(*k, 1) - held[*k],
            at(*k, 2) - at(*k, 1),
        ];
        let (low, high) =
            slopes.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), s| (a.min(*s), b.max(*s)));
        held[*k] < STANDS * top && low > GAINS * top && high < ALIKE * low
    };
    let rows: Vec<usize> =
        (2 * BESIDE..held.len().saturating_sub(2 * BESIDE)).filter(is_bounce).collect();
    // rows of one bounce stand together
    rows.windows(2).filter(|w| w[1] - w[0] > 2 * BESIDE).count() + usize::from(!rows.is_empty())
}

fn turns_back(values: &[f64]) -> bool {
    let (low, high) = extent(values);
    low < -AT_REST * high && low < 0.0
}

#[cfg(test)]
mod tests {
    use super::bounces;

    #[test]
    fn a_magnitude_bounces_and_a_stop_does_not() {
        let speed = |k: u32| 5.0 * (0.05 * f64::from(k)).sin();
        let values =
            |of: &dyn Fn(f64) -> f64| (0..1000).map(|k| of(speed(k))).collect::<Vec<f64>>();
        assert!(bounces(&values(&f64::abs)) >= 10);
        assert_eq!(bounces(&values(&|w| w.max(0.0))), 0);
        assert_eq!(bounces(&values(&|w| w + 5.2)), 0);
    }
}
