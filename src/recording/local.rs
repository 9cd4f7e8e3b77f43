//! A smooth look at a recording without any model: the local motion around each sample.

use std::ops::Range;

use super::{Noise, Recording};

/// Half width of the widest neighbourhood [s], and its limits in samples.
const HALF_WIDTH: f64 = 0.06;
const FEWEST: usize = 3;
const MOST: usize = 30;
/// Ratio of one neighbourhood to the next wider one.
const WIDER: f64 = 1.6;
/// Standard errors within which two neighbourhoods agree.
const AGREE: f64 = 2.0;

/// Motion around one sample, from a parabola through the angles and speeds of its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LocalMotion {
    /// Wheel angles [rad].
    pub alpha: [f64; 2],
    /// Wheel speeds [rad/s].
    pub omega: [f64; 2],
    /// Wheel accelerations [rad/s^2].
    pub acceleration: [f64; 2],
    /// Variance of the speeds that the noise of the channels leaves [rad^2/s^2].
    pub omega_variance: [f64; 2],
    /// Variance of the angles [rad^2].
    pub alpha_variance: [f64; 2],
}

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
    #[must_use]
    pub fn local_motion(&self) -> Vec<LocalMotion> {
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
        let piece = self.pieces().iter().find(|piece| piece.contains(&k));
        piece.map_or_else(LocalMotion::default, |piece| {
            self.parabolas(piece, k, self.half_width(), noise)
        })
    }

    fn half_width(&self) -> usize {
        ((HALF_WIDTH / self.step()).round() as usize).clamp(FEWEST, MOST)
    }

    fn parabolas(&self, piece: &Range<usize>, k: usize, half: usize, noise: &Noise) -> LocalMotion {
        let range =
            |half: usize| k.saturating_sub(half).max(piece.start)..(k + half + 1).min(piece.end);
        let mut out = LocalMotion::default();
        for i in 0..2 {
            let sigma = [noise.alpha[i].max(1e-9), noise.omega[i].max(1e-9)];
            self.fit_parabola(range(half), k, i, sigma, &mut out);
            self.narrow(&range, (k, i), half, sigma, &mut out);
        }
        out
    }

    /// Replaces angle and speed of wheel `i` by those of the widest neighbourhood that agrees with all
    /// narrower ones.
    fn narrow(
        &self,
        range: &impl Fn(usize) -> Range<usize>,
        (k, i): (usize, usize),
        widest: usize,
        sigma: [f64; 2],
        out: &mut LocalMotion,
    ) {
        let both = self.measured().alpha && self.measured().omega;
        let mut half = if both { 1 } else { 2 };
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut agreed: Option<LocalMotion> = None;
        while half < widest {
            let mut fit = *out;
            self.fit_parabola(range(half), k, i, sigma, &mut fit);
            if !meets(&fit, i, &mut low, &mut high) {
                break;
            }
            agreed = Some(fit);
            half = ((half as f64 * WIDER).round() as usize).max(half + 1);
        }
        let all = half >= widest && meets(out, i, &mut low, &mut high);
        if let Some(fit) = agreed.filter(|_| !all) {
            (out.alpha[i], out.omega[i]) = (fit.alpha[i], fit.omega[i]);
            out.omega_variance[i] = fit.omega_variance[i];
            out.alpha_variance[i] = fit.alpha_variance[i];
        }
    }

    fn fit_parabola(
        &self,
        range: Range<usize>,
        k: usize,
        i: usize,
        sigma: [f64; 2],
        out: &mut LocalMotion,
    ) {
        let measured = self.measured();
        let mut normal = nalgebra::Matrix3::<f64>::zeros();
        let mut right = nalgebra::Vector3::<f64>::zeros();
        for n in range {
            let tau = self.t()[n] - self.t()[k];
            let mut add = |row: [f64; 3], value: f64, sigma: f64| {
                let row = nalgebra::Vector3::from(row);
                normal += row * row.transpose() / (sigma * sigma);
                right += row * (value / (sigma * sigma));
            };
            if measured.alpha {
                let value = self.alpha()[n][i] - self.alpha()[k][i];
                add([1.0, tau, 0.5 * tau * tau], value, sigma[0]);
            }
            if measured.omega {
                add([0.0, 1.0, tau], self.omega()[n][i], sigma[1]);
            }
        }
        if !measured.alpha {
            normal[(0, 0)] = 1.0;
        }
        let scale = nalgebra::Vector3::from_fn(|j, _| 1.0 / normal[(j, j)].max(1e-300).sqrt());
        let scaled = normal.component_mul(&(scale * scale.transpose()));
        let Some(inverse) = scaled.try_inverse() else {
            out.alpha[i] = self.alpha()[k][i];
            out.omega[i] = self.omega()[k][i];
            return;
        };
        let covariance = inverse.component_mul(&(scale * scale.transpose()));
        let c = covariance * right;
        out.alpha[i] = self.alpha()[k][i] + c[0];
        out.omega[i] = c[1];
        out.acceleration[i] = c[2];
        out.omega_variance[i] = covariance[(1, 1)].max(0.0);
        out.alpha_variance[i] = if measured.alpha { covariance[(0, 0)].max(0.0) } else { 0.0 };
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
    use super::super::{Channels, DriveUnit, Recording};

    #[test]
    fn a_parabola_is_found_exactly() {
        let t: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k % 2)).collect();
        let alpha = t.iter().map(|t| [1.0 + 2.0 * t + 1.5 * t * t, -t]).collect();
        let omega = t.iter().map(|t| [2.0 + 3.0 * t, -1.0]).collect();
        let moment = vec![[0.0; 2]; 60];
        let c = Channels { t, alpha: Some(alpha), omega: Some(omega), moment };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        for (k, m) in r.local_motion().iter().enumerate() {
            let t = r.t()[k];
            assert!((m.omega[0] - (2.0 + 3.0 * t)).abs() < 1e-6, "{k} {m:?}");
            assert!((m.acceleration[0] - 3.0).abs() < 1e-5, "{k} {m:?}");
            assert!((m.alpha[1] + t).abs() < 1e-6);
            assert_eq!(*m, r.local_motion_at(k));
        }
    }
}
