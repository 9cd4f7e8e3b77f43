//! Cubic splines through the rows of a signal.

use crate::math::Real;

/// The natural cubic spline through values at increasing times: of all curves through them the one that bends least.
///
/// ```text
/// s(t) = (1 - x) y_k + x y_k+1 - h²/6 ((1 - x)(1 - (1 - x)²) z_k + x (1 - x²) z_k+1),    x = (t - t_k)/h
/// h_k-1 z_k-1 + 2 (h_k-1 + h_k) z_k + h_k z_k+1 = 6 ((y_k+1 - y_k)/h_k - (y_k - y_k-1)/h_k-1)
/// ```
/// z: second derivatives, zero at both ends. Source: de Boor, A Practical Guide to Splines (1978), chapter IV.
pub(super) struct Spline<'a, T> {
    t: &'a [f64],
    y: &'a [[T; 2]],
    z: Vec<[T; 2]>,
}

impl<'a, T: Real> Spline<'a, T> {
    pub(super) fn new(t: &'a [f64], y: &'a [[T; 2]]) -> Self {
        Self { t, y, z: second_derivatives(t, y) }
    }

    /// The value at a time; beyond the ends that value is held. `row` is where the last time was found, and is moved.
    pub(super) fn at(&self, time: T, row: &mut usize) -> [T; 2] {
        let last = self.t.len() - 1;
        if time.value() <= self.t[0] {
            return self.y[0];
        }
        if time.value() >= self.t[last] {
            return self.y[last];
        }
        while *row > 0 && self.t[*row] > time.value() {
            *row -= 1;
        }
        while *row + 1 < last && self.t[*row + 1] <= time.value() {
            *row += 1;
        }
        let k = *row;
        let h = self.t[k + 1] - self.t[k];
        let x = (time - self.t[k]) / h;
        let rest = -x + 1.0;
        let bend = h * h / 6.0;
        let (a, b) = (rest * (-(rest * rest) + 1.0), x * (-(x * x) + 1.0));
        [0, 1].map(|i| {
            let line = rest * self.y[k][i] + x * self.y[k + 1][i];
            line - (a * self.z[k][i] + b * self.z[k + 1][i]) * bend
        })
    }

    /// Mean from row `k` to the next.
    pub(super) fn mean(&self, k: usize) -> [T; 2] {
        let h = self.t[k + 1] - self.t[k];
        [0, 1].map(|i| {
            let line = (self.y[k][i] + self.y[k + 1][i]) * 0.5;
            line - (self.z[k][i] + self.z[k + 1][i]) * (h * h / 24.0)
        })
    }
}

/// Second derivatives at the rows, by elimination of a tridiagonal system.
fn second_derivatives<T: Real>(t: &[f64], y: &[[T; 2]]) -> Vec<[T; 2]> {
    let n = t.len();
    let mut z = vec![[T::from(0.0); 2]; n];
    let mut above = vec![0.0; n];
    for k in 1..n.saturating_sub(1) {
        let (before, behind) = (t[k] - t[k - 1], t[k + 1] - t[k]);
        let pivot = 2.0 * (before + behind) - before * above[k - 1];
        above[k] = behind / pivot;
        for i in 0..2 {
            let bend = (y[k + 1][i] - y[k][i]) / behind - (y[k][i] - y[k - 1][i]) / before;
            z[k][i] = (bend * 6.0 - z[k - 1][i] * before) / pivot;
        }
    }
    for k in (1..n.saturating_sub(1)).rev() {
        for i in 0..2 {
            z[k][i] = z[k][i] - z[k + 1][i] * above[k];
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_through_a_worked_example_has_the_published_values() {
        // scipy.interpolate.CubicSpline([0, 1, 2.5, 4], [1, 3, -1, 2], bc_type="natural")
        let t = [0.0, 1.0, 2.5, 4.0];
        let y = [1.0, 3.0, -1.0, 2.0].map(|y| [y, 2.0 * y]);
        let spline = Spline::new(&t, &y);
        let mut row = 0;
        let published = [
            (0.3, 1.9443243243243242),
            (1.0, 3.0),
            (1.7, 1.3185425425425432),
            (2.5, -1.0),
            (3.9, 1.6367647647647654),
            (0.5, 2.472972972972973),
            (-1.0, 1.0),
            (7.0, 2.0),
        ];
        for (time, value) in published {
            let found = spline.at(time, &mut row);
            assert!((found[0] - value).abs() < 1e-12 && (found[1] - 2.0 * value).abs() < 1e-12);
        }
        // and its integral over each interval
        for (k, mean) in
            [2.315315315315315, 1.094594594594595, -0.11486486486486484].iter().enumerate()
        {
            assert!((spline.mean(k)[0] - mean).abs() < 1e-12, "{k}");
        }
    }
}
