//! The input at half the rate of the log, which shows what is unknown between its rows.

use std::borrow::Cow;

use super::Recording;
use super::interpolated::Interpolated;
use crate::math::interpolate_wheels;

impl Recording {
    /// The same recording with its input interpolated between its rows. Interpolation reduces the differences
    /// between neighbouring rows, but neither the integrated noise nor what is unknown between the recorded rows:
    /// the noise level is kept, and so are the even and the odd recorded rows, interpolated likewise, of which the noise
    /// floor contains the difference.
    ///
    /// # Panics
    /// If `interpolate` returns another number of rows than it is given.
    #[must_use]
    pub fn with_interpolated_torque(
        &self,
        interpolate: impl Fn(&[[f64; 2]]) -> Vec<[f64; 2]>,
    ) -> Self {
        let half_rate = [0, 1].map(|phase| interpolate(&self.half_rate_input(phase)).into());
        let kept = Interpolated { noise: self.input_jumps(), half_rate: Some(half_rate) };
        self.with_torque(interpolate(self.torque())).with_interpolated(kept)
    }

    /// A signal of the recording with only the even (`phase` 0) or odd rows, the others replaced by linear interpolation
    /// between their neighbours; the ends of every piece are kept. This is also used for a held input: holding the
    /// previous row would delay it by half a row on average.
    pub(crate) fn every_other(&self, signal: &[[f64; 2]], phase: usize) -> Vec<[f64; 2]> {
        let t = self.t();
        let mut out = signal.to_vec();
        for piece in self.pieces() {
            let inside = |k: &usize| k % 2 == phase && *k > piece.start && k + 1 < piece.end;
            for k in piece.clone().filter(inside) {
                let ends = [t[k - 1], t[k + 1]];
                out[k] = interpolate_wheels(ends, [signal[k - 1], signal[k + 1]], t[k]);
            }
        }
        out
    }

    /// The input as of a log with only the even (`phase` 0) or odd rows. If the input has been interpolated since it was
    /// recorded, the even or odd recorded rows have been interpolated likewise: those of the result are already means of
    /// neighbours, and omitting every other one of them changes less than omitting recorded ones.
    pub(crate) fn half_rate_input(&self, phase: usize) -> Cow<'_, [[f64; 2]]> {
        match self.interpolated().and_then(|recorded| recorded.half_rate.as_ref()) {
            Some(both) => Cow::Borrowed(&both[phase]),
            None => Cow::Owned(self.every_other(self.torque(), phase)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{Channels, DriveUnit, Recording};

    /// 1 s at 100 Hz with a square wave of the input, five rows a level.
    fn square_wave() -> Recording {
        let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
        let omega = t.iter().map(|t| [t.sin(), t.cos()]).collect();
        let torque = (0..100).map(|k| [f64::from((k / 5) % 2), 0.3]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        Recording::new("square", channels, DriveUnit::NewtonMetre).unwrap()
    }

    /// Each row the mean of itself and of the one before: half a row later.
    fn later(signal: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let before = |k: usize| signal[k.saturating_sub(1)];
        let of = |k: usize| [0, 1].map(|i| 0.5 * (before(k)[i] + signal[k][i]));
        (0..signal.len()).map(of).collect()
    }

    #[test]
    fn an_interpolated_input_leaves_as_much_unknown_between_the_rows_as_the_recorded_one() {
        let recorded = square_wave();
        let moved = recorded.with_interpolated_torque(later);
        // row 4 is the last of level 0, row 5 the first of level 1: without row 5 it is on the line between them
        let of = |r: &Recording| [4, 5, 6].map(|k| r.half_rate_input(1)[k][0]);
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(of(&recorded), [0.0, 0.5, 1.0]) && close(of(&moved), [0.0, 0.25, 0.75]));
        assert_eq!([4, 5, 6].map(|k| moved.torque()[k][0]), [0.0, 0.5, 1.0]);
        // the impulse that half the rate leaves unknown at a step is a quarter of a row before and after
        let impulse = |r: &Recording, phase: usize| {
            let half = r.half_rate_input(phase);
            let rows = r.torque()[2..8].iter().zip(&half[2..8]);
            rows.map(|(whole, half)| whole[0] - half[0]).sum::<f64>()
        };
        for phase in [0, 1] {
            assert!((impulse(&moved, phase) - impulse(&recorded, phase)).abs() < 1e-12, "{phase}");
        }
        // the input itself, without that, would leave nothing unknown
        let forgotten = recorded.with_torque(moved.torque().to_vec());
        assert!(impulse(&forgotten, 1).abs() < 0.5 * impulse(&recorded, 1).abs());
        let cut = moved.cut(10..60).unwrap();
        assert_eq!(cut.half_rate_input(0)[..], moved.half_rate_input(0)[10..60]);
    }
}
