//! The instant within a step at which the contact state changes.

/// Bisections that locate an event to 1e-12 of the step.
const HALVINGS: i32 = 40;

/// The shortest step of at most `h` after which `value` is positive, to 1e-12 of `h`, if it is zero at the
/// start and grows from zero to `at_high` at `h`, as the acceleration does at breakaway.
///
/// The zero of a straight line through the last two points estimates where the growth began; trials are made
/// on either side of it, at a thousandth of the remaining interval. If two trials in a row do not narrow the
/// interval, it is bisected.
pub(super) fn onset<E>(
    h: f64,
    mut at_high: f64,
    value: impl Fn(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let resolved = h * 0.5_f64.powi(HALVINGS);
    let (mut low, mut high) = (0.0, h);
    let mut earlier: Option<(f64, f64)> = None;
    let (mut side, mut misses) = (1.0, 0);
    for _ in 0..4 * HALVINGS {
        let width = high - low;
        if width <= resolved {
            break;
        }
        let line = earlier.filter(|(_, at)| *at > at_high && misses < 2);
        let trial = match line {
            Some((end, at)) => {
                let root = high - at_high * (end - high) / (at - at_high);
                let margin = (1e-3 * (high - root).abs()).max(0.25 * resolved);
                (root + side * margin).clamp(low + 0.25 * resolved, high - 0.25 * resolved)
            }
            None => 0.5 * (low + high),
        };
        let trial = within(trial, low, high);
        let at = value(trial)?;
        if at > 0.0 {
            earlier = Some((high, at_high));
            (high, at_high, side) = (trial, at, -1.0);
        } else {
            (low, side) = (trial, 1.0);
        }
        let narrowed = high - low <= 0.5 * width;
        misses = if narrowed { 0 } else { misses + 1 };
    }
    Ok(high)
}

/// The shortest step of at most `h` after which `value` is positive, to 1e-12 of `h`; `ends` are its values
/// at zero, where it is not positive, and at `h`, where it is positive.
///
/// Inverse quadratic interpolation within a bracket (Brent, Algorithms for Minimization without Derivatives,
/// 1973, ch. 4). A speed crosses zero almost linearly, so two to four trials replace forty bisections. Trials
/// are made half of the resolution after the root, so that the last one is the result. If two in a row do not
/// halve the bracket, it is bisected.
pub(super) fn crossing<E>(
    h: f64,
    ends: [f64; 2],
    value: impl Fn(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let resolved = h * 0.5_f64.powi(HALVINGS);
    let (mut low, mut high) = ((0.0, ends[0]), (h, ends[1]));
    let (mut third, mut misses) = (None, 0);
    for _ in 0..2 * HALVINGS {
        let width = high.0 - low.0;
        let slope = (high.1 - low.1) / width;
        if width <= resolved || high.1 <= slope * resolved {
            break;
        }
        // starting from rest the value is zero at zero, which is not the root wanted
        let trial = if low.1 < 0.0 && misses < 2 {
            let line = low.0 - low.1 / slope;
            let curve = third.map(|third| inverse_quadratic([low, high, third]));
            let inside = |t: &f64| low.0 < *t && *t < high.0;
            let root = curve.filter(inside).unwrap_or(line) + 0.5 * resolved;
            root.clamp(low.0 + 0.5 * resolved, high.0 - 0.5 * resolved)
        } else {
            0.5 * (low.0 + high.0)
        };
        let trial = within(trial, low.0, high.0);
        let at = value(trial)?;
        let end = if at > 0.0 { &mut high } else { &mut low };
        third = Some(std::mem::replace(end, (trial, at)));
        misses = if high.0 - low.0 <= 0.5 * width { 0 } else { misses + 1 };
    }
    Ok(high.0)
}

/// The zero of the inverse parabola through three points; NaN if two values are equal.
fn inverse_quadratic([(a, at_a), (b, at_b), (c, at_c)]: [(f64, f64); 3]) -> f64 {
    let of_a = at_b * at_c / ((at_a - at_b) * (at_a - at_c));
    let of_b = at_a * at_c / ((at_b - at_a) * (at_b - at_c));
    let of_c = at_a * at_b / ((at_c - at_a) * (at_c - at_b));
    a * of_a + b * of_b + c * of_c
}

/// A trial, or the midpoint if a diverging step has no value.
fn within(trial: f64, low: f64, high: f64) -> f64 {
    if trial.is_finite() { trial } else { 0.5 * (low + high) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_step_that_diverges_has_an_end() {
        for large in [f64::INFINITY, f64::MAX] {
            let curve = |x: f64| Ok::<f64, ()>(if x < 0.3 { -large } else { large });
            for end in [crossing(1.0, [-large, large], curve), onset(1.0, large, curve)] {
                assert!((0.0..=1.0).contains(&end.unwrap()));
            }
            let none = |_: f64| Ok::<f64, ()>(f64::NAN);
            let nan = f64::NAN;
            assert!(crossing(1.0, [nan; 2], none).is_ok() && onset(1.0, nan, none).is_ok());
        }
    }

    #[test]
    fn a_crossing_is_found_in_few_trials() {
        for root in [1e-9, 0.1, 0.5, 0.999_999] {
            for bend in [0.01, 0.3, 1.0] {
                let curve = |x: f64| (x - root) * (1.0 + bend * x * (1.0 - 0.6 * x));
                let trials = Cell::new(0);
                let straight = crossing(1.0, [curve(0.0), curve(1.0)], |x| {
                    trials.set(trials.get() + 1);
                    Ok::<f64, ()>(curve(x))
                });
                // the end is within 2^-40 above the root
                let error = straight.unwrap() - root;
                assert!((0.0..1e-12).contains(&(error + 1e-16)), "{root} {error}");
                assert!(trials.get() <= 6, "{root}: {}", trials.get());
            }
        }
    }

    #[test]
    fn an_onset_is_found_in_few_trials_whatever_its_curve() {
        for root in [0.0, 1e-9, 0.1, 0.5, 0.999_999] {
            for power in [1, 2, 0] {
                let trials = Cell::new(0);
                // straight with a curve, a parabola, a step
                let grown = |x: f64| (x - root).powi(power) * (1.0 + 0.3 * x);
                let found = onset(1.0, grown(1.0), |x: f64| {
                    trials.set(trials.get() + 1);
                    Ok::<f64, ()>(if x > root { grown(x) } else { 0.0 })
                });
                let error = found.unwrap() - root;
                assert!((0.0..1e-12).contains(&(error + 1e-16)), "{root} {error}");
                let most = if power == 1 { 30 } else { 3 * HALVINGS };
                assert!(trials.get() <= most, "{root} {power}: {}", trials.get());
            }
        }
    }

    #[test]
    fn a_value_that_begins_at_zero_is_followed_to_its_next_root() {
        let curve = |x: f64| Ok::<f64, ()>(-x * (0.3 - x));
        assert!((crossing(1.0, [0.0, 0.7], curve).unwrap() - 0.3).abs() < 1e-12);
    }
}
