//! The transition matrix of the rigid robot in blocks of two by two, so that products skip the zero blocks.

use nalgebra::{Matrix2, SMatrix, Vector2};

use super::correction::Covariance;

/// Transition of the states (alpha, omega, d), two of each, over a step.
///
/// ```text
/// dω = S_a alpha + S_w omega + S_d d
/// alpha <- alpha + h omega + h/2 dω,   omega <- omega + dω,   d <- c d
/// ```
#[derive(Clone, Debug)]
pub(super) struct Push {
    /// Length of the step \[s\].
    pub(super) h: f64,
    /// Change of the speeds by the angles, where they have any.
    pub(super) by_angle: Option<Matrix2<f64>>,
    /// Change of the speeds by the speeds.
    pub(super) by_speed: Matrix2<f64>,
    /// Change of the speeds by a torque that lasts over the step.
    pub(super) by_torque: Matrix2<f64>,
    /// Remaining part of a slow torque.
    pub(super) decay: f64,
}

impl Push {
    /// No step.
    pub(super) fn none() -> Self {
        let none = Matrix2::zeros();
        Self { h: 0.0, by_angle: None, by_speed: none, by_torque: none, decay: 1.0 }
    }

    /// The transition matrix.
    pub(super) fn transition(&self) -> Covariance<6> {
        let mut f = Covariance::<6>::identity();
        let by_angle = self.by_angle.unwrap_or_else(Matrix2::zeros);
        for i in 0..2 {
            for k in 0..2 {
                let row = [by_angle[(i, k)], self.by_speed[(i, k)], self.by_torque[(i, k)]];
                for (block, by) in row.into_iter().enumerate() {
                    f[(2 + i, 2 * block + k)] += by;
                    f[(i, 2 * block + k)] += 0.5 * self.h * by;
                }
            }
            f[(i, 2 + i)] += self.h;
            f[(4 + i, 4 + i)] = self.decay;
        }
        f
    }

    /// Effect of a torque that lasts over the step.
    #[inline]
    pub(super) fn gain(&self) -> SMatrix<f64, 6, 2> {
        let mut gain = SMatrix::<f64, 6, 2>::zeros();
        gain.fixed_view_mut::<2, 2>(0, 0).copy_from(&(self.by_torque * (0.5 * self.h)));
        gain.fixed_view_mut::<2, 2>(2, 0).copy_from(&self.by_torque);
        gain
    }

    /// States after the step under a further torque [N m].
    #[inline]
    pub(super) fn moved(&self, x: &[f64; 6], torque: [f64; 2]) -> [f64; 6] {
        let (alpha, omega, slow) =
            (Vector2::new(x[0], x[1]), Vector2::new(x[2], x[3]), Vector2::new(x[4], x[5]));
        let acting = Vector2::new(x[4] + torque[0], x[5] + torque[1]);
        let mut change = self.by_speed * omega + self.by_torque * acting;
        if let Some(by_angle) = &self.by_angle {
            change += by_angle * alpha;
        }
        let alpha = alpha + (omega + change * 0.5) * self.h;
        let (omega, slow) = (omega + change, slow * self.decay);
        [alpha[0], alpha[1], omega[0], omega[1], slow[0], slow[1]]
    }

    /// `F P F'`.
    #[inline]
    pub(super) fn spread(&self, p: &Covariance<6>) -> Covariance<6> {
        let block = |i: usize, k: usize| p.fixed_view::<2, 2>(2 * i, 2 * k).into_owned();
        let (aa, aw, ad) = (block(0, 0), block(0, 1), block(0, 2));
        let (ww, wd, dd) = (block(1, 1), block(1, 2), block(2, 2));
        let (s, t, h) = (&self.by_speed, &self.by_torque, self.h);
        // rows of the speeds, and of the angles, of F P
        let mut change =
            [s * aw.transpose() + t * ad.transpose(), s * ww + t * wd.transpose(), s * wd + t * dd];
        if let Some(by_angle) = &self.by_angle {
            for (change, column) in change.iter_mut().zip([&aa, &aw, &ad]) {
                *change += by_angle * column;
            }
        }
        let [by_a, by_w, by_d] = change;
        let half = 0.5 * h;
        let speeds = [aw.transpose() + by_a, ww + by_w, wd + by_d];
        let angles = [
            aa + aw.transpose() * h + by_a * half,
            aw + ww * h + by_w * half,
            ad + wd * h + by_d * half,
        ];
        // times F'
        let along = |row: &[Matrix2<f64>; 3]| {
            let change = row[1] * s.transpose() + row[2] * t.transpose();
            match &self.by_angle {
                Some(by_angle) => change + row[0] * by_angle.transpose(),
                None => change,
            }
        };
        let (of_speeds, of_angles) = (along(&speeds), along(&angles));
        let ww = speeds[1] + of_speeds;
        let aw = angles[1] + of_angles;
        let aa = angles[0] + (angles[1] + of_angles * 0.5) * h;
        let decay = self.decay;
        assembled([aa, aw, ww], [angles[2] * decay, speeds[2] * decay, dd * (decay * decay)])
    }

    /// Adds `G Q G'`, Q the variance `torque` of a torque that lasts over the step, G its effect on the states.
    #[inline]
    pub(super) fn add_noise(&self, torque: &Matrix2<f64>, p: &mut Covariance<6>) {
        let noise = symmetric(self.by_torque * torque * self.by_torque.transpose());
        let half = 0.5 * self.h;
        for (i, k, by) in [(0, 0, half * half), (0, 2, half), (2, 0, half), (2, 2, 1.0)] {
            for (r, c) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                p[(i + r, k + c)] += by * noise[(r, c)];
            }
        }
    }
}

/// A symmetric matrix from blocks of (alpha, omega), and of d with alpha, omega and d.
#[inline]
fn assembled([aa, aw, ww]: [Matrix2<f64>; 3], slow: [Matrix2<f64>; 3]) -> Covariance<6> {
    let mut out = Covariance::<6>::zeros();
    let mut set = |i: usize, k: usize, block: &Matrix2<f64>| {
        for r in 0..2 {
            for c in 0..2 {
                out[(2 * i + r, 2 * k + c)] = block[(r, c)];
                out[(2 * k + c, 2 * i + r)] = block[(r, c)];
            }
        }
    };
    set(0, 0, &symmetric(aa));
    set(0, 1, &aw);
    set(1, 1, &symmetric(ww));
    let [ad, wd, dd] = slow;
    set(0, 2, &ad);
    set(1, 2, &wd);
    set(2, 2, &dd);
    out
}

/// Removes asymmetry by rounding.
#[inline]
fn symmetric(block: Matrix2<f64>) -> Matrix2<f64> {
    (block + block.transpose()) * 0.5
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn the_blocks_are_the_whole_matrices() {
        let numbers = |n: usize| (0..n).map(|k| ((7 * k + 3) as f64).sin()).collect::<Vec<f64>>();
        let root = Covariance::<6>::from_row_slice(&numbers(36));
        let p = root * root.transpose();
        let torque = Matrix2::new(0.7, 0.1, 0.1, 0.4);
        let by_speed = Matrix2::new(-0.3, 0.05, 0.02, -0.2);
        let by_torque = Matrix2::new(1.1, 0.2, 0.2, 0.9);
        for by_angle in [None, Some(Matrix2::new(0.1, -0.4, 0.3, 0.2))] {
            let decay = 0.8;
            let push = Push { h: 0.1, by_angle, by_speed, by_torque, decay };
            let (f, gain) = (push.transition(), push.gain());
            let expected = f * p * f.transpose() + gain * torque * gain.transpose();
            let mut spread = push.spread(&p);
            push.add_noise(&torque, &mut spread);
            assert!((spread - expected).amax() < 1e-13);
            let x = [0.3, -0.2, 1.1, 0.7, 0.02, -0.5];
            let moved = push.moved(&x, [0.4, -0.6]);
            let expected = f * nalgebra::SVector::from(x) + gain * Vector2::new(0.4, -0.6);
            (0..6).for_each(|i| assert!((moved[i] - expected[i]).abs() < 1e-14));
        }
    }
}
