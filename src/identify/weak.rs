//! The weak form of the torque balance: integrals against test functions, which need no
//! acceleration.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::Task;
use super::combined::{ACCELERATIONS, Factors, QUANTITIES, quantities};
use super::regressor::{Balance, Regressor};
use crate::effects::Motion;
use crate::recording::Recording;

/// Windows that touch a wheel slower than this share of the top speed are dropped: what friction
/// does there is not sgn(w).
const REST: f64 = 0.025;
/// Largest share of rows near zero speed in a window with reversals: the relative error of the friction of a start
/// (judgement).
const SLOW: f64 = 0.25;

/// Standard deviations of the noise within which a speed has no direction.
const NOISE: f64 = 3.0;

/// One test function ψ = (1 - x²)⁴ over a window of samples.
#[derive(Clone, Debug)]
pub(super) struct Window {
    pub(super) samples: Range<usize>,
    /// ψ dt at each of them \[s\].
    pub(super) weight: Vec<f64>,
    /// dψ/dt dt at each of them.
    pub(super) slope: Vec<f64>,
}

/// Windows of half width `half_width` \[s\], `per_half` of them on each half width, that do not
/// touch rest and do not cross a gap.
pub(super) fn windows(recording: &Recording, half_width: f64, per_half: usize) -> Vec<Window> {
    let rest = REST * recording.top_speed();
    let omega = recording.omega();
    windows_where(recording, half_width, per_half, |samples| {
        let sign = omega[samples.start].map(f64::signum);
        samples.into_iter().all(|k| (0..2).all(|i| omega[k][i] * sign[i] >= rest))
    })
}

/// The same across reversals, for a motion that has no longer movement: with the sign of each row's speed, the
/// Coulomb friction is too small by at most the share [`SLOW`] of rows near zero speed.
pub(super) fn windows_across_reversals(
    recording: &Recording,
    half_width: f64,
    per_half: usize,
) -> Vec<Window> {
    // noise has no direction: a robot at rest has no such windows
    let noise = recording.motion_noise().omega.into_iter().fold(0.0, f64::max);
    let rest = (REST * recording.top_speed()).max(NOISE * noise);
    let omega = recording.omega();
    windows_where(recording, half_width, per_half, |samples| {
        let allowed = SLOW * samples.len() as f64;
        let slow = |i: usize| samples.clone().filter(|&k| omega[k][i].abs() <= rest).count();
        (0..2).all(|i| slow(i) as f64 <= allowed)
    })
}

fn windows_where(
    recording: &Recording,
    half_width: f64,
    per_half: usize,
    usable: impl Fn(Range<usize>) -> bool,
) -> Vec<Window> {
    let half = ((half_width / recording.step()).round() as usize).max(4);
    let stride = (half / per_half).max(1);
    let mut out = Vec::new();
    for piece in recording.pieces() {
        let mut centre = piece.start + half;
        while centre + half < piece.end {
            let samples = centre - half..centre + half + 1;
            if usable(samples.clone()) {
                out.push(window(recording.t(), samples));
            }
            centre += stride;
        }
    }
    out
}

/// Longest time in which both wheels turn one way, without a rest or a gap \[s\].
pub(super) fn longest_motion(recordings: &[Recording]) -> f64 {
    let of = |recording: &Recording| {
        let (t, omega) = (recording.t(), recording.omega());
        let rest = REST * recording.top_speed();
        let way = |k: usize| omega[k].map(|w| if w.abs() >= rest { w.signum() } else { 0.0 });
        let mut longest = 0.0_f64;
        for piece in recording.pieces() {
            let mut since = piece.start;
            for k in piece.clone() {
                if way(k) != way(since) {
                    since = k;
                }
                if way(k).iter().all(|w| *w != 0.0) {
                    longest = longest.max(t[k] - t[since]);
                }
            }
        }
        longest
    };
    recordings.iter().map(of).fold(0.0, f64::max)
}

fn window(t: &[f64], samples: Range<usize>) -> Window {
    let (first, last) = (t[samples.start], t[samples.end - 1]);
    let (middle, reach) = (0.5 * (first + last), 0.5 * (last - first));
    let none = || Vec::with_capacity(samples.len());
    let (mut weight, mut slope) = (none(), none());
    for k in samples.clone() {
        let x = (t[k] - middle) / reach;
        let before = if k > samples.start { t[k] - t[k - 1] } else { 0.0 };
        let after = if k + 1 < samples.end { t[k + 1] - t[k] } else { 0.0 };
        let dt = 0.5 * (before + after);
        weight.push(dt * (1.0 - x * x).powi(4));
        slope.push(dt * -8.0 * x * (1.0 - x * x).powi(3) / reach);
    }
    Window { samples, weight, slope }
}

/// The instant of sample `k` at the speeds `omega`.
pub(super) fn motion_at<'a>(
    task: &'a Task,
    recording: &Recording,
    k: usize,
    omega: [f64; 2],
) -> Motion<'a, f64> {
    Motion::at(recording.t()[k] - recording.t()[0], recording.alpha()[k], omega, task.model.robot())
}

/// Rows of the weak form, two a window (wheel 1, wheel 2), for given speeds and acting input.
///
/// ```text
/// Σ_c θ_c ∫ (ψ torque_c - ψ' mass_c ω) dt = ∫ ψ M dt - (the same of what is not linear)
/// ```
/// Source: partial integration of the torque balance; Messenger and Bortz, SIAM Multiscale
/// Modeling & Simulation 19 (2021).
pub(super) fn weak_rows(
    task: &Task,
    regressor: &Regressor,
    recording: &Recording,
    windows: &[Window],
    omega: &[[f64; 2]],
    input: &[[f64; 2]],
) -> (DMatrix<f64>, DVector<f64>) {
    let width = regressor.width();
    let columns = match regressor.factors() {
        Some(factors) => integrals_of_polynomials(factors, windows, omega),
        None => integrals(task, regressor, recording, windows, omega),
    };
    let mut x = DMatrix::zeros(2 * windows.len(), width);
    let mut y = DVector::zeros(2 * windows.len());
    for (n, (window, columns)) in windows.iter().zip(columns.chunks_exact(width + 1)).enumerate() {
        let mut driving = [0.0; 2];
        for (weight, input) in window.weight.iter().zip(&input[window.samples.clone()]) {
            (0..2).for_each(|wheel| driving[wheel] += weight * input[wheel]);
        }
        for wheel in 0..2 {
            for c in 0..width {
                x[(2 * n + wheel, c)] = columns[c][wheel];
            }
            y[2 * n + wheel] = driving[wheel] - columns[width][wheel];
        }
    }
    (x, y)
}

/// Integrals of the columns over each window, of the part with all linear parameters at zero last.
fn integrals(
    task: &Task,
    regressor: &Regressor,
    recording: &Recording,
    windows: &[Window],
    omega: &[[f64; 2]],
) -> Vec<[f64; 2]> {
    let count = regressor.width() + 1;
    let mut needed = vec![false; recording.len()];
    windows.iter().for_each(|w| needed[w.samples.clone()].fill(true));
    // torque and momentum of every column, row by row
    let mut sides = vec![[[0.0; 2]; 2]; recording.len() * count];
    let mut balance = Balance::default();
    for (k, row) in sides.chunks_exact_mut(count).enumerate().filter(|(k, _)| needed[*k]) {
        regressor.write(&motion_at(task, recording, k, omega[k]), &mut balance);
        for (c, side) in row.iter_mut().enumerate() {
            *side = [balance.torque[c], balance.carried(c, &omega[k])];
        }
    }
    let mut out = vec![[0.0; 2]; windows.len() * count];
    for (window, sums) in windows.iter().zip(out.chunks_exact_mut(count)) {
        let rows = sides[window.samples.start * count..].chunks_exact(count);
        for (row, (weight, slope)) in rows.zip(window.weight.iter().zip(&window.slope)) {
            for (sum, [torque, momentum]) in sums.iter_mut().zip(row) {
                for wheel in 0..2 {
                    sum[wheel] += weight * torque[wheel] - slope * momentum[wheel];
                }
            }
        }
    }
    out
}

/// The same of columns that are polynomials: the factors times the integrals of the quantities, which all columns
/// share. The momentum has the factors of the acceleration.
fn integrals_of_polynomials(
    factors: &[Factors],
    windows: &[Window],
    omega: &[[f64; 2]],
) -> Vec<[f64; 2]> {
    let rows: Vec<_> = omega.iter().map(|omega| quantities(*omega, *omega)).collect();
    let mut out = Vec::with_capacity(windows.len() * factors.len());
    for window in windows {
        let mut sums = [0.0; QUANTITIES];
        let weights = window.weight.iter().zip(&window.slope);
        for (row, (weight, slope)) in rows[window.samples.clone()].iter().zip(weights) {
            for n in 0..QUANTITIES {
                sums[n] += row[n] * if n < ACCELERATIONS { *weight } else { -slope };
            }
        }
        let column = |of: &[f64; QUANTITIES]| of.iter().zip(&sums).map(|(f, sum)| f * sum).sum();
        out.extend(factors.iter().map(|[first, second]| [column(first), column(second)]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn integrals_of_polynomials_are_those_of_the_columns_to_rounding() {
        let ids = ["viscous_friction", "turning_scrub", "lateral_com"];
        let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
        let p = model.initial();
        let noise = NoiseLevel { dalpha: 0.01, alpha: 1e-4, torque: 0.0 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 2 };
        let movement = Movement::rich(model.robot(), 3, 20.0, 12.0);
        let train = [record("rich", &model, &p, &movement, &recorder).unwrap()];
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let (regressor, r) = (Regressor::new(&model, &p), &train[0]);
        let windows = windows(r, 0.12, 2);
        let expected = integrals(&task, &regressor, r, &windows, r.omega());
        let found = integrals_of_polynomials(regressor.factors().unwrap(), &windows, r.omega());
        assert!(!windows.is_empty() && found.len() == expected.len());
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            // terms of a sum are up to a hundred times as large as the sum
            assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
        }
    }
}
