//! First-order low-passes of speeds, and their inverses.

use crate::recording::{Recording, differentiate};

/// Where a low-pass of the speeds is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Computed {
    /// Before the sampling, by electronics or much faster than the rows: `T y' = x - y`.
    Continuously,
    /// Once a row, an exponential moving average: `y(k) = y(k-1) + g (x(k) - y(k-1))`, `g = 1 - exp(-h/T)`.
    AtRows,
}

/// A first-order low-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPass {
    /// Where it is computed.
    pub computed: Computed,
    /// Its time constant \[s\].
    pub time_s: f64,
}

impl LowPass {
    /// The output a step `h` after the output `y`, of an input on a line from one value to another.
    ///
    /// ```text
    /// y' = u_1 - T (u_1 - u_0)/h + (y - u_0 + T (u_1 - u_0)/h) exp(-h/T)   continuously
    /// y' = u_1 + (y - u_1) exp(-h/T)                                       at rows
    /// ```
    pub(super) fn after(self, y: f64, [from, to]: [f64; 2], h: f64) -> f64 {
        let behind = match self.computed {
            Computed::Continuously => self.time_s * (to - from) / h,
            Computed::AtRows => 0.0,
        };
        let first = if self.computed == Computed::AtRows { to } else { from };
        to - behind + (y - first + behind) * (-h / self.time_s).exp()
    }

    /// A recording whose speeds are those before the low-pass.
    #[must_use]
    pub fn before(self, recording: &Recording) -> Recording {
        let omega = recording.omega();
        let rows: Vec<[f64; 2]> = match self.computed {
            Computed::Continuously => {
                let slopes = differentiate(recording.t(), omega, recording.pieces(), 1);
                let rows = omega.iter().zip(slopes);
                rows.map(|(w, s)| [0, 1].map(|i| w[i] + self.time_s * s[i])).collect()
            }
            Computed::AtRows => {
                let kept = (-recording.step() / self.time_s).exp();
                let mut rows = omega.to_vec();
                for piece in recording.pieces() {
                    // what came before the first row of a piece is unknown
                    for k in piece.clone().skip(1) {
                        let last = omega[k - 1];
                        rows[k] = [0, 1].map(|i| (omega[k][i] - kept * last[i]) / (1.0 - kept));
                    }
                }
                rows
            }
        };
        recording.with_omega(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn a_low_pass_of_a_line_is_late_by_its_time_constant() {
        // u = 3 t: y = 3 (t - T) + 3 T exp(-t/T) from rest, whatever the steps
        let (time, mut t, mut y) = (0.03, 0.0, 0.0);
        let filter = LowPass { computed: Computed::Continuously, time_s: time };
        for h in [0.01, 0.004, 0.02, 0.05] {
            y = filter.after(y, [3.0 * t, 3.0 * (t + h)], h);
            t += h;
            let exact = 3.0 * (t - time) + 3.0 * time * (-t / time).exp();
            assert!((y - exact).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn an_average_over_the_rows_is_inverted_exactly() {
        let speeds: Vec<[f64; 2]> =
            (0..50).map(|k| [(k * k % 17) as f64, (k % 5) as f64]).collect();
        let (h, share) = (0.02, 0.3);
        let filter = LowPass { computed: Computed::AtRows, time_s: -h / (1.0_f64 - share).ln() };
        let mut averaged = speeds.clone();
        for k in 1..speeds.len() {
            averaged[k] = [0, 1].map(|i| {
                let y = averaged[k - 1][i];
                let next = y + share * (speeds[k][i] - y);
                assert!((filter.after(y, [0.0, speeds[k][i]], h) - next).abs() < 1e-12);
                next
            });
        }
        let channels = Channels {
            t: (0..50).map(|k| h * f64::from(k)).collect(),
            alpha: None,
            omega: Some(averaged),
            torque: speeds.clone(),
        };
        let recording = Recording::new("averaged", channels, DriveUnit::Volt).unwrap();
        for (found, truth) in filter.before(&recording).omega().iter().zip(&speeds) {
            assert!((0..2).all(|i| (found[i] - truth[i]).abs() < 1e-9), "{found:?} {truth:?}");
        }
    }
}
