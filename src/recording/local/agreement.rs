//! The widest neighbourhood of a row that agrees with all narrower ones.

use super::corner::AGREE;
use crate::recording::LocalMotion;

/// Angle and speed of one wheel at a row, with their variances.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    pub(super) alpha: f64,
    pub(super) omega: f64,
    pub(super) alpha_variance: f64,
    pub(super) omega_variance: f64,
}

/// Parabolas of both wheels over a neighbourhood.
pub(super) struct Fits {
    /// Determinants of the normal equations: a neighbourhood determines the motion of a wheel where it is positive.
    pub(super) determinant: [f64; 2],
    /// Angles and speeds of the row itself.
    pub(super) row: ([f64; 2], [f64; 2]),
    pub(super) alpha: [f64; 2],
    pub(super) omega: [f64; 2],
    pub(super) acceleration: [f64; 2],
    pub(super) alpha_variance: [f64; 2],
    pub(super) omega_variance: [f64; 2],
}

impl Fits {
    /// Of wheel `i`; the row itself, without variance, if it is not determined.
    fn of(&self, i: usize) -> Fit {
        if self.determinant[i] > 0.0 {
            let [alpha_variance, omega_variance] =
                [self.alpha_variance, self.omega_variance].map(|variance| variance[i]);
            return Fit {
                alpha: self.alpha[i],
                omega: self.omega[i],
                alpha_variance,
                omega_variance,
            };
        }
        let (alpha, omega) = (self.row.0[i], self.row.1[i]);
        Fit { alpha, omega, alpha_variance: 0.0, omega_variance: 0.0 }
    }

    /// Writes the motion of wheel `i`.
    pub(super) fn write(&self, i: usize, out: &mut LocalMotion) {
        self.of(i).write(i, out);
        out.acceleration[i] = if self.determinant[i] > 0.0 { self.acceleration[i] } else { 0.0 };
    }
}

impl Fit {
    fn write(&self, i: usize, out: &mut LocalMotion) {
        (out.alpha[i], out.omega[i]) = (self.alpha, self.omega);
        (out.alpha_variance[i], out.omega_variance[i]) = (self.alpha_variance, self.omega_variance);
    }
}

/// The neighbourhoods of a wheel so far: the intersection of their intervals of the speed.
pub(super) struct Agreement {
    wheel: usize,
    low: f64,
    high: f64,
    /// The widest that agrees with all narrower ones.
    agreed: Option<Fit>,
    /// Those that agree, in ascending order.
    widths: Widths,
    /// Whether all have agreed.
    pub(super) goes_on: bool,
}

impl Agreement {
    /// Begins with the narrowest one, if there is any.
    pub(super) fn new(wheel: usize, narrowest: Option<Fit>) -> Self {
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let widths = Widths::default();
        let mut this = Self { wheel, low, high, agreed: narrowest, widths, goes_on: true };
        if let Some(fit) = &narrowest {
            this.meets(fit);
        }
        this
    }

    /// Adds a wider one, of `half` rows to either side; none after the first that does not agree.
    pub(super) fn see(&mut self, fits: &Fits, half: usize) {
        if !self.goes_on {
            return;
        }
        let fit = fits.of(self.wheel);
        self.goes_on = self.meets(&fit);
        if self.goes_on {
            self.agreed = Some(fit);
            self.widths.push(half, &fit);
        }
    }

    /// See [`Widths::curvature`].
    pub(super) fn curvature(&self) -> Option<f64> {
        self.widths.curvature()
    }

    /// Intersects the common interval with that of a fit; whether the intersection is not empty.
    fn meets(&mut self, fit: &Fit) -> bool {
        let reach = AGREE * fit.omega_variance.sqrt();
        self.low = self.low.max(fit.omega - reach);
        self.high = self.high.min(fit.omega + reach);
        self.low <= self.high
    }

    /// Replaces angle and speed of the widest neighbourhood by those that agreed.
    pub(super) fn write(&self, out: &mut LocalMotion) {
        if let Some(fit) = self.agreed.filter(|_| !self.goes_on) {
            fit.write(self.wheel, out);
        }
    }
}

/// Speeds from neighbourhoods of several widths that agree.
#[derive(Default)]
struct Widths {
    /// Half width in rows, speed and its variance; the sequence of half widths has no more than eight.
    all: [(f64, f64, f64); 8],
    count: usize,
}

impl Widths {
    fn push(&mut self, half: usize, fit: &Fit) {
        if let Some(place) = self.all.get_mut(self.count) {
            *place = (half as f64, fit.omega, fit.omega_variance);
            self.count += 1;
        }
    }

    /// Estimate of the square of the error of the widest by the shape of the motion, from the widest of at most half its
    /// width; it may be negative by chance. `None` if there is none.
    ///
    /// ```text
    /// b² = ((w_n - w_c)² - (v_n - v_c))/(1 - h_n/h_c)²
    /// ```
    /// An acceleration that steps in the neighbourhood causes an error in proportion to its half width h. The variance of
    /// the difference is the difference of the variances, because the rows of the narrower one are part of the wider.
    ///
    /// Source: Hausman, Econometrica 46 (1978), of the variance.
    fn curvature(&self) -> Option<f64> {
        let (last, narrower) = self.all[..self.count].split_last()?;
        let (half, omega, variance) = last;
        let (h, w, v) = narrower.iter().rev().find(|(h, ..)| 2.0 * h <= *half)?;
        Some(((w - omega).powi(2) - (v - variance)) / (1.0 - h / half).powi(2))
    }
}
