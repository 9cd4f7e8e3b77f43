//! Torques that are second-degree polynomials of the two wheel speeds, as those of most effects are.

/// A pair of second-degree polynomials in the wheel speeds, one per wheel: the coefficients of 1, w1, w2, w1
/// (w1 - w2), w2 (w1 - w2), w1 w2.
///
/// Terms with a difference of speeds are exactly zero for equal speeds, and both wheels are summed in the
/// same order: a robot that is driven straight stays straight, whereas rounding errors would let an unstable
/// one turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SpeedPolynomial {
    pub(crate) factors: [[f64; 2]; 6],
}

impl SpeedPolynomial {
    /// The polynomials through `value` [of speeds, rad/s], which must itself be a second-degree polynomial:
    /// six points determine it.
    pub(crate) fn through(value: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let places = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]];
        let values = places.map(value);
        let mut factors = [[0.0; 2]; 6];
        for i in 0..2 {
            let [zero, first, before, second, behind, both] = values.map(|v| v[i]);
            factors[0][i] = zero;
            factors[1][i] = 0.5 * (first - before);
            factors[2][i] = 0.5 * (second - behind);
            let square_first = 0.5 * (first + before) - zero;
            let square_second = 0.5 * (second + behind) - zero;
            let product = (both - first) - (second - zero);
            factors[3][i] = square_first;
            factors[4][i] = -square_second;
            factors[5][i] = square_first + product + square_second;
        }
        Self { factors }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, factor) in self.factors.iter_mut().zip(&other.factors) {
            *sum = [sum[0] + factor[0], sum[1] + factor[1]];
        }
    }

    /// Removes and returns the constant.
    pub(crate) fn take_constant(&mut self) -> [f64; 2] {
        std::mem::take(&mut self.factors[0])
    }

    /// The polynomials after a linear map.
    pub(crate) fn mapped(&self, map: impl Fn(&[f64; 2]) -> [f64; 2]) -> Self {
        Self { factors: self.factors.each_ref().map(map) }
    }

    /// The values at these speeds without the constant.
    #[inline]
    pub(crate) fn rest(&self, [w1, w2]: [f64; 2]) -> [f64; 2] {
        let [_, by_first, by_second, turn_first, turn_second, product] = &self.factors;
        let (turn, both) = (w1 - w2, w1 * w2);
        let one = |i: usize| {
            (by_first[i] * w1 + by_second[i] * w2)
                + turn * (turn_first[i] * w1 + turn_second[i] * w2)
                + product[i] * both
        };
        [one(0), one(1)]
    }

    /// The derivatives with respect to the two speeds, one row per wheel.
    #[inline]
    pub(crate) fn slope(&self, [w1, w2]: [f64; 2]) -> [[f64; 2]; 2] {
        let [_, by_first, by_second, turn_first, turn_second, product] = &self.factors;
        let turn = w1 - w2;
        let one = |i: usize| {
            let inner = turn_first[i] * w1 + turn_second[i] * w2;
            let first = by_first[i] + inner + turn * turn_first[i] + product[i] * w2;
            let second = by_second[i] - inner + turn * turn_second[i] + product[i] * w1;
            [first, second]
        };
        [one(0), one(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_equal_speeds_leaves_exactly_nothing() {
        let turning = |[a, b]: [f64; 2]| [0.37 * b * (b - a), 0.37 * a * (a - b)];
        let found = SpeedPolynomial::through(turning).mapped(|t| [31.7 * t[0] + 2.3 * t[1], t[0]]);
        assert_eq!(found.rest([7.3, 7.3]), [0.0, 0.0]);
    }

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
