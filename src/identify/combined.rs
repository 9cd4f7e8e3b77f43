//! All columns of the torque balance of both wheels as linear combinations of a few quantities of the motion, four side
//! by side: for models whose torques are polynomials of the speeds.

use wide::f64x4;

use crate::effects::{DIRECTIONS, along};
use crate::math::sgn;
use crate::model::SpeedPolynomial;

/// Number of quantities: one, w1, w2, (w1 - w2) w1, (w1 - w2) w2, w1 w2, the signs along the four directions of dry
/// friction, and the two accelerations.
pub(super) const QUANTITIES: usize = 12;
/// Place of the accelerations.
pub(super) const ACCELERATIONS: usize = 10;
/// Columns in a register.
pub(super) const TOGETHER: usize = 4;

/// The columns of wheel 1, then those of wheel 2, in groups of [`TOGETHER`]; the last of each wheel is the part with
/// all linear parameters at zero, with the opposite sign, as it stands on the side of the input.
pub(super) struct Combined {
    /// Factors of the quantities that occur in a group.
    groups: Vec<Vec<(usize, f64x4)>>,
}

/// Factors of the quantities in a column, by wheel.
pub(super) type Factors = [[f64; QUANTITIES]; 2];

impl Combined {
    /// From the factors of the columns, last those of the part with all linear parameters at zero.
    pub(super) fn new(columns: &[Factors]) -> Self {
        let width = columns.len() - 1;
        let factor = |wheel: usize, c: usize, n: usize| {
            let factor = columns[c][wheel][n];
            if c < width { factor } else { -factor }
        };
        let places: Vec<(usize, usize)> =
            (0..2).flat_map(|wheel| (0..=width).map(move |c| (wheel, c))).collect();
        let group = |places: &[(usize, usize)]| {
            let of = |n: usize| {
                let mut factors = [0.0; TOGETHER];
                factors
                    .iter_mut()
                    .zip(places)
                    .for_each(|(f, (wheel, c))| *f = factor(*wheel, *c, n));
                (n, factors)
            };
            let occurring = (0..QUANTITIES).map(of).filter(|(_, f)| *f != [0.0; TOGETHER]);
            occurring.map(|(n, factors)| (n, f64x4::new(factors))).collect()
        };
        Self { groups: places.chunks(TOGETHER).map(group).collect() }
    }

    /// The torques of each group at these quantities [N m].
    #[inline]
    pub(super) fn at(&self, quantities: [f64; QUANTITIES]) -> impl Iterator<Item = f64x4> {
        self.groups.iter().map(move |group| {
            group.iter().fold(f64x4::ZERO, |sum, (n, factors)| {
                sum + *factors * f64x4::splat(quantities[*n])
            })
        })
    }
}

/// The quantities at speeds [rad/s] and accelerations [rad/s²].
#[inline]
pub(super) fn quantities(omega: [f64; 2], [a1, a2]: [f64; 2]) -> [f64; QUANTITIES] {
    let ([w1, w2], turn) = (omega, omega[0] - omega[1]);
    let [s1, s2, s3, s4] = [0, 1, 2, 3].map(|j| sgn(along(j, &omega)));
    [1.0, w1, w2, turn * w1, turn * w2, w1 * w2, s1, s2, s3, s4, a1, a2]
}

/// The factors for a mass matrix (m11, m12, m22), a polynomial of the speeds and levels of dry friction.
pub(super) fn factors_of(
    [m11, m12, m22]: [f64; 3],
    polynomial: &SpeedPolynomial,
    level: &[f64; 4],
) -> Factors {
    [(0, [m11, m12]), (1, [m12, m22])].map(|(wheel, [a1, a2])| {
        let [c, w1, w2, t1, t2, p] = polynomial.factors.map(|factor| factor[wheel]);
        let [f1, f2, f3, f4] = [0, 1, 2, 3].map(|j| DIRECTIONS[j][wheel] * level[j]);
        [c, w1, w2, t1, t2, p, f1, f2, f3, f4, a1, a2]
    })
}
