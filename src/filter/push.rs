//! The transition matrix of the rigid robot in blocks of two by two, so that products skip the zero blocks. Without
//! slow torques there are four states, of angles and speeds.

use nalgebra::{Matrix2, SMatrix, Vector2};

use super::correction::Covariance;
use super::step::has_slow;

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
    pub(super) fn transition<const N: usize>(&self) -> Covariance<N> {
        let mut f = Covariance::<N>::identity();
        let by_angle = self.by_angle.unwrap_or_else(Matrix2::zeros);
        for i in 0..2 {
            for k in 0..2 {
                let row = [by_angle[(i, k)], self.by_speed[(i, k)], self.by_torque[(i, k)]];
                for (block, by) in row.into_iter().take(N / 2).enumerate() {
                    f[(2 + i, 2 * block + k)] += by;
                    f[(i, 2 * block + k)] += 0.5 * self.h * by;
                }
            }
            f[(i, 2 + i)] += self.h;
            if has_slow::<N>() {
                f[(4 + i, 4 + i)] = self.decay;
            }
        }
        f
    }

    /// Effect of a torque that lasts over the step.
    #[inline]
    pub(super) fn gain<const N: usize>(&self) -> SMatrix<f64, N, 2> {
        let mut gain = SMatrix::<f64, N, 2>::zeros();
        gain.fixed_view_mut::<2, 2>(0, 0).copy_from(&(self.by_torque * (0.5 * self.h)));
        gain.fixed_view_mut::<2, 2>(2, 0).copy_from(&self.by_torque);
        gain
    }

    /// States after the step under a further torque [N m].
    #[inline]
    pub(super) fn moved<const N: usize>(&self, x: &[f64; N], torque: [f64; 2]) -> [f64; N] {
        let pair = |i: usize| Vector2::new(x[i], x[i + 1]);
        let (alpha, omega, mut acting) = (pair(0), pair(2), Vector2::from(torque));
        if has_slow::<N>() {
            acting = pair(4) + acting;
        }
        let mut change = self.by_speed * omega + self.by_torque * acting;
        if let Some(by_angle) = &self.by_angle {
            change += by_angle * alpha;
        }
        let alpha = alpha + (omega + change * 0.5) * self.h;
        let omega = omega + change;
        let mut out = [0.0; N];
        for i in 0..2 {
            (out[i], out[2 + i]) = (alpha[i], omega[i]);
            if has_slow::<N>() {
                out[4 + i] = x[4 + i] * self.decay;
            }
        }
        out
    }

    /// `F P F'`.
    #[inline]
    pub(super) fn spread<const N: usize>(&self, p: &Covariance<N>) -> Covariance<N> {
        let block = |i: usize, k: usize| p.fixed_view::<2, 2>(2 * i, 2 * k).into_owned();
        let (aa, aw, ww) = (block(0, 0), block(0, 1), block(1, 1));
        // of the slow torques with angles, speeds and themselves
        let slow = has_slow::<N>().then(|| [block(0, 2), block(1, 2), block(2, 2)]);
        let (s, t, h) = (&self.by_speed, &self.by_torque, self.h);
        // columns of the angles and of the speeds in the rows of the speeds and of the angles of F P
        let (mut by_a, mut by_w) = (s * aw.transpose(), s * ww);
        if let Some([ad, wd, _]) = &slow {
            by_a += t * ad.transpose();
            by_w += t * wd.transpose();
        }
        if let Some(by_angle) = &self.by_angle {
            by_a += by_angle * aa;
            by_w += by_angle * aw;
        }
        let half = 0.5 * h;
        let speeds = [aw.transpose() + by_a, ww + by_w];
        let angles = [aa + aw.transpose() * h + by_a * half, aw + ww * h + by_w * half];
        // the same of the slow torques
        let beside = slow.map(|[ad, wd, dd]| {
            let mut by_d = s * wd + t * dd;
            if let Some(by_angle) = &self.by_angle {
                by_d += by_angle * ad;
            }
            [ad + wd * h + by_d * half, wd + by_d, dd]
        });
        // times F'
        let along = |row: &[Matrix2<f64>; 2], beside: Option<&Matrix2<f64>>| {
            let mut change = row[1] * s.transpose();
            if let Some(beside) = beside {
                change += beside * t.transpose();
            }
            match &self.by_angle {
                Some(by_angle) => change + row[0] * by_angle.transpose(),
                None => change,
            }
        };
        let of_speeds = along(&speeds, beside.as_ref().map(|[_, wd, _]| wd));
        let of_angles = along(&angles, beside.as_ref().map(|[ad, ..]| ad));
        let ww = speeds[1] + of_speeds;
        let aw = angles[1] + of_angles;
        let aa = angles[0] + (angles[1] + of_angles * 0.5) * h;
        let decay = self.decay;
        let slow = beside.map(|[ad, wd, dd]| [ad * decay, wd * decay, dd * (decay * decay)]);
        assembled([aa, aw, ww], slow)
    }

    /// Adds `G Q G'`, Q the variance `torque` of a torque that lasts over the step, G its effect on the states.
    #[inline]
    pub(super) fn add_noise<const N: usize>(&self, torque: &Matrix2<f64>, p: &mut Covariance<N>) {
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
fn assembled<const N: usize>(
    [aa, aw, ww]: [Matrix2<f64>; 3],
    slow: Option<[Matrix2<f64>; 3]>,
) -> Covariance<N> {
    let mut out = Covariance::<N>::zeros();
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
    if let Some([ad, wd, dd]) = slow {
        set(0, 2, &ad);
        set(1, 2, &wd);
        set(2, 2, &dd);
    }
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
            let (f, gain) = (push.transition::<6>(), push.gain::<6>());
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

    #[test]
    fn four_states_are_six_without_slow_torques() {
        let numbers = |n: usize| (0..n).map(|k| ((7 * k + 3) as f64).sin()).collect::<Vec<f64>>();
        let root = Covariance::<4>::from_row_slice(&numbers(16));
        let small = root * root.transpose();
        let mut large = Covariance::<6>::zeros();
        large.fixed_view_mut::<4, 4>(0, 0).copy_from(&small);
        let by_speed = Matrix2::new(-0.3, 0.05, 0.02, -0.2);
        let by_torque = Matrix2::new(1.1, 0.2, 0.2, 0.9);
        for by_angle in [None, Some(Matrix2::new(0.1, -0.4, 0.3, 0.2))] {
            let push = Push { h: 0.1, by_angle, by_speed, by_torque, decay: 0.0 };
            let spread = push.spread(&large).fixed_view::<4, 4>(0, 0).into_owned();
            assert_eq!(push.spread(&small), spread);
            let transition = push.transition::<6>().fixed_view::<4, 4>(0, 0).into_owned();
            assert_eq!(push.transition::<4>(), transition);
            assert_eq!(push.gain::<4>(), push.gain::<6>().fixed_rows::<4>(0).into_owned());
            let (few, torque) = ([0.3, -0.2, 1.1, 0.7], [0.4, -0.6]);
            let moved = push.moved(&[0.3, -0.2, 1.1, 0.7, 0.0, 0.0], torque);
            assert_eq!(push.moved(&few, torque)[..], moved[..4]);
        }
    }
}
