//! Torques that are polynomials of the two wheel speeds: what most effects add up to.

/// A pair of polynomials of second degree in the wheel speeds, one a wheel: the factors of
/// 1, w1, w2, w1², w1 w2, w2².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SpeedPolynomial {
    pub(super) factors: [[f64; 2]; 6],
}

impl SpeedPolynomial {
    /// The polynomials that have the values of `value` [of speeds, rad/s], which must be such polynomials
    /// themselves: six places determine them.
    pub(super) fn through(value: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let places = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]];
        let values = places.map(value);
        let mut factors = [[0.0; 2]; 6];
        for i in 0..2 {
            let [zero, first, before, second, behind, both] = values.map(|v| v[i]);
            factors[0][i] = zero;
            factors[1][i] = 0.5 * (first - before);
            factors[2][i] = 0.5 * (second - behind);
            factors[3][i] = 0.5 * (first + before) - zero;
            factors[5][i] = 0.5 * (second + behind) - zero;
            factors[4][i] = (both - first) - (second - zero);
        }
        Self { factors }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, factor) in self.factors.iter_mut().zip(&other.factors) {
            *sum = [sum[0] + factor[0], sum[1] + factor[1]];
        }
    }

    /// Takes the constant out.
    pub(super) fn take_constant(&mut self) -> [f64; 2] {
        std::mem::take(&mut self.factors[0])
    }

    /// The polynomials after a linear map.
    pub(super) fn mapped(&self, map: impl Fn(&[f64; 2]) -> [f64; 2]) -> Self {
        Self { factors: self.factors.each_ref().map(map) }
    }

    /// The values at these speeds, less the constant.
    #[inline]
    pub(super) fn rest(&self, [w1, w2]: [f64; 2]) -> [f64; 2] {
        let [_, f1, f2, f11, f12, f22] = &self.factors;
        let one = |i: usize| w1 * (f1[i] + w1 * f11[i] + w2 * f12[i]) + w2 * (f2[i] + w2 * f22[i]);
        [one(0), one(1)]
    }

    /// The derivatives by the two speeds, a row a wheel.
    #[inline]
    pub(super) fn slope(&self, [w1, w2]: [f64; 2]) -> [[f64; 2]; 2] {
        let [_, f1, f2, f11, f12, f22] = &self.factors;
        let one = |i: usize| {
            [f1[i] + 2.0 * w1 * f11[i] + w2 * f12[i], f2[i] + 2.0 * w2 * f22[i] + w1 * f12[i]]
        };
        [one(0), one(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_places_determine_the_polynomials_and_their_slopes() {
        let truth = |[a, b]: [f64; 2]| {
            [0.3 - 1.1 * a + 0.7 * b + 0.2 * a * a - 0.4 * a * b + 0.9 * b * b, b * (b - a) - 2.0]
        };
        let mut found = SpeedPolynomial::through(truth);
        let constant = found.take_constant();
        let (w, h) = ([1.7, -2.3], 1e-3);
        let (rest, slope) = (found.rest(w), found.slope(w));
        for i in 0..2 {
            assert!((constant[i] + rest[i] - truth(w)[i]).abs() < 1e-13);
            for k in 0..2 {
                let at = |h: f64| truth([0, 1].map(|n| w[n] + if n == k { h } else { 0.0 }))[i];
                // central differences are exact for second degree, to rounding over h
                assert!((slope[i][k] - (at(h) - at(-h)) / (2.0 * h)).abs() < 1e-10);
            }
        }
    }
}
