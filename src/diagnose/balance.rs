//! The time shift between recorded input and motion by the balance of the torques.

use super::regression::Regression;

/// Resolution of the search, in rows.
const RESOLUTION: f64 = 0.1;

/// The lowest of the residuals of a regression of the input on the free parameters, in half rows of its shift.
pub(super) struct Coarse {
    /// Shift \[s\].
    pub(super) shift: f64,
    /// The first and the last one \[s\].
    range: [f64; 2],
    /// Longest shift \[s\].
    longest: f64,
    /// Residual sum of squares.
    square: f64,
}

/// Searches the whole range, from `earliest` rows to `longest` seconds, as the square changes, then in half rows around
/// the lowest.
pub(super) fn lowest_of_balance(
    regression: &Regression,
    step: f64,
    (earliest, longest): (f64, f64),
) -> Option<Coarse> {
    let latest = (longest / step).ceil().max(-earliest);
    let coarse = |k: usize| (earliest + 0.5 * k as f64) * step;
    let count = ((latest - earliest) / 0.5).ceil() as usize + 1;
    let lowest = |places: Vec<usize>| {
        let shifts: Vec<f64> = places.iter().map(|k| coarse(*k)).collect();
        let squares = places.into_iter().zip(regression.squares_at_shifts(&shifts));
        squares.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let apart = ((regression.smooth_over() / (0.5 * step)) as usize).clamp(1, count);
    let (near, _) = lowest((0..count).step_by(apart).chain([count - 1]).collect())?;
    let around = near.saturating_sub(apart)..(near + apart + 1).min(count);
    let (place, square) = lowest(around.collect())?;
    let range = [coarse(0), coarse(count - 1)];
    Some(Coarse { shift: coarse(place), range, longest, square })
}

/// Shift and standard error \[s\] by the residual of a low-passed regression of the input on the free parameters, in
/// finer steps around the lowest of half rows.
///
/// ```text
/// minimise RSS(T),   se² = 2 RSS/(n RSS''),   n = 2 fc (time of motion)
/// ```
/// `None` without a minimum inside the range, or with an uncertainty beyond it: the balance does not determine the
/// shift.
pub(super) fn by_balance(
    regression: &Regression,
    step: f64,
    coarse: &Coarse,
) -> Option<(f64, f64)> {
    let h = RESOLUTION * step;
    let fine = |k: i32| coarse.shift + f64::from(k) * h;
    let around: Vec<f64> = (-4..=4).filter(|k| *k != 0).map(fine).collect();
    let (mut best, mut least) = (coarse.shift, coarse.square);
    for (shift, square) in around.iter().zip(regression.squares_at_shifts(&around)) {
        if square < least {
            (best, least) = (*shift, square);
        }
    }
    let beside = regression.squares_at_shifts(&[best - h, best + h]);
    let (before, after) = (beside[0], beside[1]);
    let bend = (before - 2.0 * least + after) / (h * h);
    if !(bend > 0.0 && least > 0.0) {
        return None;
    }
    let shift = best + 0.5 * h * (before - after) / (before - 2.0 * least + after).max(1e-300);
    // the vertex of a parabola far from its three points is no minimum of the sum
    let [first, last] = coarse.range;
    let inside = (shift - best).abs() <= h && shift > first && shift < last;
    let std_error = (2.0 * least / (regression.degrees * bend)).sqrt();
    (inside && std_error < coarse.longest).then_some((shift, std_error))
}
