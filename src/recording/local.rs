//! The local motion around each sample, by smoothing without a model.

mod corner;

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use self::corner::{AGREE, Corner, Corners, around};
use super::{LocalMotion, Measured, MotionNoise, Recording};
use crate::math::inverse_of_three;

/// Half width of the widest neighbourhood \[s\], and its limits in samples.
const HALF_WIDTH: f64 = 0.06;
const FEWEST: usize = 3;
const MOST: usize = 30;
/// Ratio of the widths of successive neighbourhoods.
const WIDER: f64 = 1.6;

impl Recording {
    /// The local motion around every sample: weighted least squares of `alpha = c0 + c1 τ + ½ c2 τ²` and
    /// `omega = c1 + c2 τ` over at most ± 0.06 s (at least three samples to either side, fewer at the ends of
    /// a piece), each channel weighted by its noise.
    ///
    /// Angle and speed are taken from the widest neighbourhood whose interval of two standard errors
    /// intersects those of all narrower ones, because the parabola is not valid across reversals (friction)
    /// or steps of a slowly held input; the acceleration is taken from the widest neighbourhood. The
    /// narrowest is the measured speed of the row itself. For angles alone it is a pair of parabolas with
    /// different curvature that meet at the row; if their residual exceeds the noise, it is included in the
    /// variance of the speed.
    ///
    /// Source: intersection of confidence intervals, Goldenshluger and Nemirovski, Math. Methods Stat. 6
    /// (1997); Katkovnik, IEEE Trans. Signal Process. 47 (1999).
    ///
    /// Computed once; copies of the recording with another input share it.
    #[must_use]
    pub fn local_motion(&self) -> &[LocalMotion] {
        self.kept().local_motion.get_or_init(|| self.parabolas_of_all())
    }

    fn parabolas_of_all(&self) -> Vec<LocalMotion> {
        let noise = self.motion_noise();
        let mut out = vec![LocalMotion::default(); self.len()];
        for piece in self.pieces() {
            self.parabolas(piece, piece.clone(), &noise, &mut out[piece.clone()]);
        }
        out
    }

    /// [`Recording::local_motion`] for sample `k` only.
    #[must_use]
    pub fn local_motion_at(&self, k: usize) -> LocalMotion {
        let mut out = [LocalMotion::default()];
        if let Some(piece) = self.piece_of(k) {
            self.parabolas(piece, k..k + 1, &self.motion_noise(), &mut out);
        }
        out[0]
    }

    /// Variance of the speeds around sample `k` in the widest neighbourhood [rad^2/s^2], for the given noise
    /// of the channels; a channel with infinite noise is not used.
    #[must_use]
    pub fn local_speed_variance(&self, k: usize, noise: &MotionNoise) -> [f64; 2] {
        let Some(piece) = self.piece_of(k) else { return [0.0; 2] };
        let mut out = LocalMotion::default();
        let widest = half_width(self, self.rows_per_refresh());
        for i in 0..2 {
            let mut parabola = Parabola::new(self, (k, i), noise);
            parabola.widen(around(piece, k, widest));
            parabola.fit(&mut out);
        }
        out.omega_variance
    }

    /// The motion at `rows` of a piece.
    fn parabolas(
        &self,
        piece: &Range<usize>,
        rows: Range<usize>,
        noise: &MotionNoise,
        out: &mut [LocalMotion],
    ) {
        // once for all rows: it counts them
        let refresh = self.rows_per_refresh();
        for i in 0..2 {
            // rows that repeat the last value, and counts that hide the speed, show no corner
            let angles_alone = !self.measured().omega && refresh == 1 && self.reach() == 1;
            let corners = angles_alone.then(|| Corners::of(self, piece, rows.clone(), i));
            for (k, out) in rows.clone().zip(out.iter_mut()) {
                let parabola = Parabola::new(self, (k, i), noise);
                self.parabola(piece, parabola, refresh, corners.as_ref(), out);
                if let Some(corners) = &corners {
                    out.omega_variance[i] += corners.roughness(k, noise.alpha[i]);
                }
            }
        }
    }

    /// Angle and speed of a wheel from the widest neighbourhood that agrees with all narrower ones, its
    /// acceleration from the widest of all.
    fn parabola(
        &self,
        piece: &Range<usize>,
        mut parabola: Parabola,
        refresh: usize,
        corners: Option<&Corners>,
        out: &mut LocalMotion,
    ) {
        let (i, k, widest) = (parabola.wheel, parabola.sample, half_width(self, refresh));
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut agreed: Option<LocalMotion> = None;
        let mut agrees = |fit: &LocalMotion| meets(fit, i, &mut low, &mut high);
        let corner = corners.and_then(|corners| corners.at(k));
        if let Some(fit) = parabola.at_row().or_else(|| Some(parabola.at_corner(corner?))) {
            agrees(&fit);
            agreed = Some(fit);
        }
        let narrowest = if self.measured().omega { 1 } else { 2 } * refresh;
        // over fewer rows the counts of an encoder do not show the speed
        let mut half = narrowest.max(self.reach());
        while half < widest {
            parabola.widen(around(piece, k, half));
            let mut fit = *out;
            parabola.fit(&mut fit);
            if !agrees(&fit) {
                break;
            }
            agreed = Some(fit);
            half = ((half as f64 * WIDER).round() as usize).max(half + 1);
        }
        parabola.widen(around(piece, k, widest));
        parabola.fit(out);
        let all = half >= widest && agrees(out);
        if let Some(fit) = agreed.filter(|_| !all) {
            (out.alpha[i], out.omega[i]) = (fit.alpha[i], fit.omega[i]);
            out.omega_variance[i] = fit.omega_variance[i];
            out.alpha_variance[i] = fit.alpha_variance[i];
        }
    }
}

/// Half width of the widest neighbourhood in rows, with `refresh` rows per new value.
fn half_width(recording: &Recording, refresh: usize) -> usize {
    let step = recording.step() * refresh as f64;
    let rows = ((HALF_WIDTH / step).round() as usize).clamp(FEWEST, MOST) * refresh;
    rows.max(recording.reach())
}

/// Sums over a neighbourhood of a sample that grows to both sides: powers of the time τ relative to the
/// sample, and their products with angle and speed of a wheel.
struct Parabola<'a> {
    recording: &'a Recording,
    sample: usize,
    wheel: usize,
    /// Reciprocal of the variance of angle and speed; zero for a channel that was not measured.
    weight: [f64; 2],
    range: Range<usize>,
    /// Σ τ^j, j = 0..4.
    powers: [f64; 5],
    /// Σ τ^j (α - α_k), j = 0..2, and Σ τ^j ω, j = 0..1.
    alpha: [f64; 3],
    omega: [f64; 2],
}

impl<'a> Parabola<'a> {
    fn new(recording: &'a Recording, (sample, wheel): (usize, usize), noise: &MotionNoise) -> Self {
        let Measured { alpha, omega } = recording.measured();
        let sigma = [noise.alpha[wheel], noise.omega[wheel]].map(|sigma| sigma.max(1e-9));
        let weight = |measured, sigma: f64| if measured { 1.0 / (sigma * sigma) } else { 0.0 };
        Self {
            recording,
            sample,
            wheel,
            weight: [weight(alpha, sigma[0]), weight(omega, sigma[1])],
            range: sample..sample,
            powers: [0.0; 5],
            alpha: [0.0; 3],
            omega: [0.0; 2],
        }
    }

    /// The row itself, if its speed was measured.
    fn at_row(&self) -> Option<LocalMotion> {
        let (r, k, i) = (self.recording, self.sample, self.wheel);
        let [a, w] = self.weight;
        if !(w > 0.0 && r.fresh()[k]) {
            return None;
        }
        let mut out = LocalMotion::default();
        (out.alpha[i], out.omega[i]) = (r.alpha()[k][i], r.omega()[k][i]);
        out.omega_variance[i] = 1.0 / w;
        out.alpha_variance[i] = if a > 0.0 { 1.0 / a } else { 0.0 };
        Some(out)
    }

    /// The same of a corner of the angles.
    fn at_corner(&self, corner: &Corner) -> LocalMotion {
        let (i, variance) = (self.wheel, 1.0 / self.weight[0]);
        let mut out = LocalMotion::default();
        (out.alpha[i], out.omega[i]) = (corner.alpha, corner.omega);
        [out.alpha_variance[i], out.omega_variance[i]] = corner.variance.map(|v| v * variance);
        out
    }

    /// Adds the rows of a wider range to the sums.
    fn widen(&mut self, to: Range<usize>) {
        let (r, k, i) = (self.recording, self.sample, self.wheel);
        let (now, angle) = (r.t()[k], r.alpha()[k][i]);
        for rows in [to.start..self.range.start, self.range.end..to.end] {
            let channels = r.alpha()[rows.clone()].iter().zip(&r.omega()[rows.clone()]);
            let stamps = r.t()[rows.clone()].iter().zip(&r.fresh()[rows]);
            for ((t, fresh), (alpha, omega)) in stamps.zip(channels) {
                // a row that repeats the last value is not a measurement
                if !fresh {
                    continue;
                }
                let tau = t - now;
                let square = tau * tau;
                for (sum, power) in
                    self.powers.iter_mut().zip([1.0, tau, square, square * tau, square * square])
                {
                    *sum += power;
                }
                let (alpha, omega) = (alpha[i] - angle, omega[i]);
                for (sum, power) in self.alpha.iter_mut().zip([1.0, tau, square]) {
                    *sum += power * alpha;
                }
                self.omega = [self.omega[0] + omega, self.omega[1] + tau * omega];
            }
        }
        self.range = to;
    }

    /// Writes the motion of the wheel; the sample itself if the neighbourhood does not determine it.
    ///
    /// ```text
    /// rows (1, τ, ½ τ²) of the angle and (0, 1, τ) of the speed
    /// ```
    fn fit(&self, out: &mut LocalMotion) {
        let (i, [a, w], [s0, s1, s2, s3, s4]) = (self.wheel, self.weight, self.powers);
        let measured = a > 0.0;
        #[rustfmt::skip]
        let normal = Matrix3::new(
            if measured { a * s0 } else { 1.0 }, a * s1, 0.5 * a * s2,
            a * s1, a * s2 + w * s0, 0.5 * a * s3 + w * s1,
            0.5 * a * s2, 0.5 * a * s3 + w * s1, 0.25 * a * s4 + w * s2,
        );
        let [v0, v1, v2] = self.alpha;
        let right =
            Vector3::new(a * v0, a * v1 + w * self.omega[0], 0.5 * a * v2 + w * self.omega[1]);
        let (r, k) = (self.recording, self.sample);
        let Some(covariance) = inverse_of_three(&normal) else {
            (out.alpha[i], out.omega[i]) = (r.alpha()[k][i], r.omega()[k][i]);
            return;
        };
        let c = covariance * right;
        (out.alpha[i], out.omega[i]) = (r.alpha()[k][i] + c[0], c[1]);
        out.acceleration[i] = c[2];
        let rows = self.rows_per_count();
        out.omega_variance[i] = rows * covariance[(1, 1)].max(0.0);
        out.alpha_variance[i] = if measured { rows * covariance[(0, 0)].max(0.0) } else { 0.0 };
    }

    /// Rows of the neighbourhood for each of its counts where the counts of an encoder hide the speed, otherwise one:
    /// the errors of rows with the same count are not independent, so that together they determine the motion like one
    /// row.
    fn rows_per_count(&self) -> f64 {
        let (r, i, rows) = (self.recording, self.wheel, &self.range);
        if r.reach() == 1 {
            return 1.0;
        }
        let changes = r.alpha()[rows.clone()].windows(2).filter(|w| w[0][i] != w[1][i]).count();
        rows.len() as f64 / (1 + changes) as f64
    }
}

/// Intersects the common interval with that of a fit; whether the intersection is not empty.
fn meets(fit: &LocalMotion, i: usize, low: &mut f64, high: &mut f64) -> bool {
    let reach = AGREE * fit.omega_variance[i].sqrt();
    *low = low.max(fit.omega[i] - reach);
    *high = high.min(fit.omega[i] + reach);
    low <= high
}

#[cfg(test)]
mod tests {
    use super::super::{Channels, DriveUnit, Noise, Recording};

    #[test]
    fn a_parabola_is_found_exactly() {
        let t: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k % 2)).collect();
        let alpha = t.iter().map(|t| [1.0 + 2.0 * t + 1.5 * t * t, -t]).collect();
        let omega = t.iter().map(|t| [2.0 + 3.0 * t, -1.0]).collect();
        let torque = vec![[0.0; 2]; 60];
        let c = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        for (k, m) in r.local_motion().iter().enumerate() {
            let t = r.t()[k];
            assert!((m.omega[0] - (2.0 + 3.0 * t)).abs() < 1e-6, "{k} {m:?}");
            assert!((m.acceleration[0] - 3.0).abs() < 1e-5, "{k} {m:?}");
            assert!((m.alpha[1] + t).abs() < 1e-6);
            assert_eq!(*m, r.local_motion_at(k));
        }
    }

    /// A wheel accelerated and braked in turn by the steps of a held input, at 20 Hz.
    fn stepped(alpha: bool, omega: bool) -> (Recording, Vec<f64>) {
        let (h, mut at, mut w) = (0.05, 0.0, 3.0);
        let (mut angles, mut speeds) = (vec![], vec![]);
        for k in 0..40 {
            angles.push([at; 2]);
            speeds.push(w);
            let a = 30.0 * f64::from(k).sin().signum();
            (at, w) = (at + h * w + 0.5 * h * h * a, w + h * a);
        }
        let t = (0..40).map(|k| h * f64::from(k)).collect();
        let omega = omega.then(|| speeds.iter().map(|w| [*w; 2]).collect());
        let torque = vec![[0.0; 2]; 40];
        let c = Channels { t, alpha: alpha.then_some(angles), omega, torque };
        let mut r = Recording::new("steps", c, DriveUnit::NewtonMetre).unwrap();
        r.set_most_noise(Noise { alpha: [1e-4; 2], omega: [1e-3; 2], torque: [0.0; 2] });
        (r, speeds)
    }

    #[test]
    fn speeds_between_the_steps_of_a_held_input_lie_within_their_errors() {
        for (alpha, omega) in [(true, false), (false, true), (true, true)] {
            let (r, truth) = stepped(alpha, omega);
            for (k, m) in r.local_motion().iter().enumerate().skip(2).take(36) {
                let error = m.omega_variance[0].sqrt();
                assert!((m.omega[0] - truth[k]).abs() < 1e-6 + 2.0 * error, "{k} {m:?}");
                assert!(!omega || error < 4e-3, "{error}");
            }
        }
    }

    #[test]
    fn copies_share_one_motion_until_the_noise_of_the_sensors_is_set() {
        let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let rough = |k: usize| 0.01 * ((k * k) as f64).sin();
        let omega = t.iter().enumerate().map(|(k, t)| [t.sin() + rough(k), -t + rough(k + 7)]);
        let (omega, torque) = (Some(omega.collect()), vec![[0.0; 2]; 200]);
        let c = Channels { t, alpha: None, omega, torque };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        let other = r.with_torque(vec![[1.0; 2]; 200]);
        assert!(std::ptr::eq(r.local_motion(), other.local_motion()));
        let mut quiet = r.clone();
        let Noise { alpha, torque, .. } = r.noise();
        quiet.set_most_noise(Noise { alpha, omega: [1e-4; 2], torque });
        // less noise: narrower neighbourhoods agree
        assert_ne!(quiet.local_motion(), r.local_motion());
        assert_eq!(quiet.local_motion()[70], quiet.local_motion_at(70));
    }
}
