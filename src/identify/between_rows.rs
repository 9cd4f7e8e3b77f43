//! Test whether the estimated inertias may be due to the unknown input between the rows.
//!
//! Over a span of rows the change of momentum is J Δw, and the impulse of the input is known only up to the error of
//! interpolation. Interpolating every other row gives an estimate of that error:
//!
//! ```text
//! J Δw = (a1 Δw1 + a2 Δw2, a2 Δw1 + a1 Δw2),   D = ∫ (M by all rows - M by every other row) dt
//! share = least of  rms D/rms J Δw  over spans of 2, 4, 8, … rows
//! ```
//! D is as large as the interpolation error if the changes of the input from row to row are independent, and larger
//! if it is smooth. A fit attributes the part of that error that is proportional to Δw to the inertias: at most this
//! share of them. White noise of the input grows with the root of the span, J Δw with the span itself, so that a fast
//! and noisy log has a small share.

use super::{Fit, Note};
use crate::model::base::{A1, A2, A3};
use crate::recording::Recording;
use crate::simulate::Hold;

/// Share of the inertias above which they are not identifiable: the larger part of them may be an error of
/// interpolation.
const LARGER_PART: f64 = 0.5;
/// Factor of the required sampling rate: the share decreases at least in proportion to the interval, for a smooth
/// input to its square.
const TENFOLD: f64 = 10.0;
/// Smallest number of spans, for a relative error of a root mean square of a quarter.
const FEWEST: usize = 10;

impl Fit {
    /// The same with inertias marked as not identifiable, and a note with the reason, if the larger part of them may
    /// be due to the unknown input between the rows of the recordings. A held input is known between its rows.
    pub(super) fn between_rows(mut self, train: &[Recording], hold: Hold) -> Self {
        let inertias: Vec<usize> =
            [A1, A2, A3].into_iter().filter(|&j| self.is_estimated(j)).collect();
        let of = |j: usize| self.estimates.get(j).map_or(0.0, |e| e.value);
        let given = hold == Hold::Constant || !inertias.contains(&A1);
        let Some(share) = (!given).then(|| share([of(A1), of(A2)], train)).flatten() else {
            return self;
        };
        if share <= LARGER_PART {
            return self;
        }
        inertias.iter().for_each(|&j| self.set_unidentifiable(j));
        let symbols = inertias.iter().map(|&j| self.estimates[j].symbol.clone()).collect();
        let step_s = train.iter().map(Recording::step).fold(0.0, f64::max);
        let rate = (TENFOLD / step_s).ceil() as usize;
        self.notes.push(Note::BetweenRows { symbols, share, step_s, rate });
        self
    }

    fn is_estimated(&self, j: usize) -> bool {
        self.estimates.get(j).is_some_and(|e| e.identifiable && !e.fixed)
    }
}

/// The share of the inertias a1 and a2 that may be due to the unknown input between the rows; `None` if there are too
/// few spans.
fn share([a1, a2]: [f64; 2], recordings: &[Recording]) -> Option<f64> {
    let pieces: Vec<Piece> = recordings.iter().flat_map(Piece::all).collect();
    let longest = pieces.iter().map(|piece| piece.omega.len()).max()?;
    let lengths = std::iter::successors(Some(2), |n| Some(2 * n)).take_while(|n| *n < longest);
    let of_length = |rows: usize| {
        let spans = pieces.iter().flat_map(|piece| piece.spans(rows));
        let (mut lines, mut impulse, mut count) = (0.0, 0.0, 0);
        for (d, dw) in spans {
            lines += d[0].powi(2) + d[1].powi(2);
            impulse += (a1 * dw[0] + a2 * dw[1]).powi(2) + (a2 * dw[0] + a1 * dw[1]).powi(2);
            count += 1;
        }
        (count >= FEWEST && impulse > 0.0).then(|| (lines / impulse).sqrt())
    };
    lengths.filter_map(of_length).min_by(f64::total_cmp)
}

/// A piece of a recording.
struct Piece<'a> {
    omega: &'a [[f64; 2]],
    /// Difference of the impulse from that of the line over two rows, of every other row.
    apart: Vec<[f64; 2]>,
}

impl<'a> Piece<'a> {
    /// All pieces of a recording.
    fn all(r: &'a Recording) -> impl Iterator<Item = Self> {
        r.pieces().iter().map(|piece| {
            let (t, torque) = (&r.t()[piece.clone()], &r.torque()[piece.clone()]);
            let under =
                |i: usize, a: usize, b: usize| 0.5 * (t[b] - t[a]) * (torque[a][i] + torque[b][i]);
            let apart = |a: usize| {
                [0, 1].map(|i| under(i, a, a + 1) + under(i, a + 1, a + 2) - under(i, a, a + 2))
            };
            let apart = (0..piece.len().saturating_sub(2)).step_by(2).map(apart).collect();
            Self { omega: &r.omega()[piece.clone()], apart }
        })
    }

    /// Differences of the impulse and of the speeds over spans of so many rows, an even number, in which a wheel moves.
    fn spans(&self, rows: usize) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let ends = self.omega.iter().step_by(rows);
        let spans = ends.clone().zip(ends.skip(1)).zip(self.apart.chunks(rows / 2));
        let moving = spans.filter(|((from, to), _)| **from != [0.0; 2] || **to != [0.0; 2]);
        moving.map(|((from, to), apart)| {
            let sum = |i: usize| apart.iter().map(|d| d[i]).sum::<f64>();
            ([sum(0), sum(1)], [0, 1].map(|i| to[i] - from[i]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::Robot;
    use nalgebra::DMatrix;

    const J: f64 = 0.03;

    /// Wheels of inertia J alone under cos(2 π t/period), at a step \[s\], with an input whose noise is that of every
    /// row.
    fn recording(period: f64, step: f64, noise: f64) -> Recording {
        let rate = std::f64::consts::TAU / period;
        let t: Vec<f64> = (0..2000).map(|k| step * f64::from(k)).collect();
        let speed = |t: f64| [(rate * t).sin() / (J * rate), ((rate * t).sin() + 0.2) / (J * rate)];
        let white = |k: usize| noise * ((k * (k + 7)) as f64).sin();
        let torque = t.iter().enumerate().map(|(k, t)| [(rate * t).cos() + white(k); 2]).collect();
        let omega = Some(t.iter().map(|t| speed(*t)).collect());
        let channels = Channels { torque, omega, alpha: None, t };
        Recording::new("wheels", channels, DriveUnit::NewtonMetre).unwrap()
    }

    fn fitted(a1: f64) -> Fit {
        let model = Model::base(Robot::amigobot());
        let p = vec![a1, 0.0, 0.0, 0.1, 0.1];
        Fit::physical("output_error", &model, p, DMatrix::identity(5, 5), DriveUnit::NewtonMetre)
    }

    #[test]
    fn the_share_is_that_of_the_closed_form() {
        // over two rows: h (M1 - (M0 + M2)/2) = h cos(rate t) (1 - cos(rate h)), J Δw = (2/rate) sin(rate h) cos(rate
        // t)
        let (period, step) = (1.0, 0.1);
        let phase = std::f64::consts::TAU * step / period;
        let closed = 0.5 * phase * (1.0 - phase.cos()) / phase.sin();
        let of = share([J, 0.0], &[recording(period, step, 0.0)]).unwrap();
        assert!((of / closed - 1.0).abs() < 1e-9, "{of} {closed}");
        // half of the inertia has twice the share
        let half = share([0.5 * J, 0.0], &[recording(period, step, 0.0)]).unwrap();
        assert!((half / of - 2.0).abs() < 1e-9);
    }

    #[test]
    fn inertias_of_an_input_that_the_rows_miss_are_not_identifiable() {
        // three periods between two rows and a bit
        let missed = fitted(J).between_rows(&[recording(1.0, 3.27, 0.0)], Hold::Linear);
        let known = |fit: &Fit| fit.estimates.iter().map(|e| e.identifiable).collect::<Vec<_>>();
        assert_eq!(known(&missed), [false, false, false, true, true]);
        assert!(
            matches!(&missed.notes[..], [Note::BetweenRows { symbols, .. }] if symbols.len() == 3)
        );
        let held = fitted(J).between_rows(&[recording(1.0, 3.27, 0.0)], Hold::Constant);
        assert!(held.notes.is_empty());
        // 200 Hz, and noise of the input as large as the input itself
        let seen = fitted(J).between_rows(&[recording(1.0, 0.005, 1.0)], Hold::Linear);
        assert_eq!(known(&seen), [true; 5]);
    }
}
