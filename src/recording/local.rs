//! A smooth look at a recording without any model: the local motion around each sample.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::{LocalMotion, Measured, Noise, Recording};

/// Half width of the widest neighbourhood \[s\], and its limits in samples.
const HALF_WIDTH: f64 = 0.06;
const FEWEST: usize = 3;
const MOST: usize = 30;
/// Ratio of one neighbourhood to the next wider one.
const WIDER: f64 = 1.6;
/// Standard errors within which two neighbourhoods agree.
const AGREE: f64 = 2.0;

impl Recording {
    /// The local motion around every sample: weighted least squares of
    /// `alpha = c0 + c1 τ + ½ c2 τ²` and `omega = c1 + c2 τ` over at most ± 0.06 s (at least three
    /// samples to either side, fewer at the ends of a piece), each channel weighted by its noise.
    ///
    /// Angle and speed come from the widest neighbourhood whose interval of two standard errors meets those
    /// of all narrower ones, since friction breaks the parabola where a wheel reverses; the acceleration
    /// from the widest.
    ///
    /// Source: intersection of confidence intervals, Goldenshluger and Nemirovski, Math. Methods Stat. 6
    /// (1997); Katkovnik, IEEE Trans. Signal Process. 47 (1999).
    ///
    /// It is computed once; copies of the recording with another input share it.
    #[must_use]
    pub fn local_motion(&self) -> &[LocalMotion] {
        self.kept_motion().get_or_init(|| self.parabolas_of_all())
    }

    fn parabolas_of_all(&self) -> Vec<LocalMotion> {
        let (noise, half) = (self.noise(), self.half_width());
        let mut out = vec![LocalMotion::default(); self.len()];
        for piece in self.pieces() {
            for k in piece.clone() {
                out[k] = self.parabolas(piece, k, half, &noise);
            }
        }
        out
    }

    /// [`Recording::local_motion`] around sample `k` alone.
    #[must_use]
    pub fn local_motion_at(&self, k: usize) -> LocalMotion {
        self.local_motion_seen(k, &self.noise())
    }

    /// The same with the noise of the channels as given; one of infinite noise is not looked at.
    #[must_use]
    pub fn local_motion_seen(&self, k: usize, noise: &Noise) -> LocalMotion {
        self.piece_of(k).map_or_else(LocalMotion::default, |piece| {
            self.parabolas(piece, k, self.half_width(), noise)
        })
    }

    fn half_width(&self) -> usize {
        let refresh = self.rows_per_refresh();
        ((HALF_WIDTH / (self.step() * refresh as f64)).round() as usize).clamp(FEWEST, MOST)
            * refresh
    }

    fn parabolas(&self, piece: &Range<usize>, k: usize, half: usize, noise: &Noise) -> LocalMotion {
        let range =
            |half: usize| k.saturating_sub(half).max(piece.start)..(k + half + 1).min(piece.end);
        let mut out = LocalMotion::default();
        for i in 0..2 {
            let sigma = [noise.alpha[i].max(1e-9), noise.omega[i].max(1e-9)];
            self.parabola(&range, Parabola::new(self, (k, i), sigma), half, &mut out);
        }
        out
    }

    /// Angle and speed of a wheel by the widest neighbourhood that agrees with all narrower ones, its
    /// acceleration by the widest of all.
    fn parabola(
        &self,
        range: &impl Fn(usize) -> Range<usize>,
        mut parabola: Parabola,
        widest: usize,
        out: &mut LocalMotion,
    ) {
        let i = parabola.wheel;
        let both = self.measured().alpha && self.measured().omega;
        let mut half = if both { 1 } else { 2 } * self.rows_per_refresh();
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut agreed: Option<LocalMotion> = None;
        while half < widest {
            parabola.widen(range(half));
            let mut fit = *out;
            parabola.fit(&mut fit);
            if !meets(&fit, i, &mut low, &mut high) {
                break;
            }
            agreed = Some(fit);
            half = ((half as f64 * WIDER).round() as usize).max(half + 1);
        }
        parabola.widen(range(widest));
        parabola.fit(out);
        let all = half >= widest && meets(out, i, &mut low, &mut high);
        if let Some(fit) = agreed.filter(|_| !all) {
            (out.alpha[i], out.omega[i]) = (fit.alpha[i], fit.omega[i]);
            out.omega_variance[i] = fit.omega_variance[i];
            out.alpha_variance[i] = fit.alpha_variance[i];
        }
    }
}

/// Sums over a neighbourhood of a sample that grows to both sides: powers of the time τ since that sample, and
/// their products with angle and speed of a wheel.
struct Parabola<'a> {
    recording: &'a Recording,
    sample: usize,
    wheel: usize,
    /// One over the variance of angle and speed; zero for a channel that was not measured.
    weight: [f64; 2],
    range: Range<usize>,
    /// Σ τ^j, j = 0..4.
    powers: [f64; 5],
    /// Σ τ^j (α - α_k), j = 0..2, and Σ τ^j ω, j = 0..1.
    alpha: [f64; 3],
    omega: [f64; 2],
}

impl<'a> Parabola<'a> {
    fn new(recording: &'a Recording, (sample, wheel): (usize, usize), sigma: [f64; 2]) -> Self {
        let Measured { alpha, omega } = recording.measured();
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

    /// Adds what a wider range has beside the present one.
    fn widen(&mut self, to: Range<usize>) {
        for n in (to.start..self.range.start).chain(self.range.end..to.end) {
            let (r, k, i) = (self.recording, self.sample, self.wheel);
            // a row that repeats the last value was not measured then
            if !r.fresh()[n] {
                continue;
            }
            let tau = r.t()[n] - r.t()[k];
            let square = tau * tau;
            for (sum, power) in
                self.powers.iter_mut().zip([1.0, tau, square, square * tau, square * square])
            {
                *sum += power;
            }
            let (alpha, omega) = (r.alpha()[n][i] - r.alpha()[k][i], r.omega()[n][i]);
            for (sum, power) in self.alpha.iter_mut().zip([1.0, tau, square]) {
                *sum += power * alpha;
            }
            self.omega = [self.omega[0] + omega, self.omega[1] + tau * omega];
        }
        self.range = to;
    }

    /// Writes the motion of the wheel; the sample itself where the neighbourhood does not give it.
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
        let scale = Vector3::from_fn(|j, _| 1.0 / normal[(j, j)].max(1e-300).sqrt());
        let scaled = normal.component_mul(&(scale * scale.transpose()));
        let (r, k) = (self.recording, self.sample);
        let Some(inverse) = scaled.try_inverse() else {
            (out.alpha[i], out.omega[i]) = (r.alpha()[k][i], r.omega()[k][i]);
            return;
        };
        let covariance = inverse.component_mul(&(scale * scale.transpose()));
        let c = covariance * right;
        (out.alpha[i], out.omega[i]) = (r.alpha()[k][i] + c[0], c[1]);
        out.acceleration[i] = c[2];
        out.omega_variance[i] = covariance[(1, 1)].max(0.0);
        out.alpha_variance[i] = if measured { covariance[(0, 0)].max(0.0) } else { 0.0 };
    }
}

/// Narrows the common interval by that of a fit; whether anything is left of it.
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

    #[test]
    fn copies_share_one_motion_until_the_noise_of_the_sensors_is_told() {
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
