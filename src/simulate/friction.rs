//! Dry friction at rest is set-valued: sticking and slipping directions are determined exactly.

use crate::effects::{DIRECTIONS, Terms, along, with_friction};
use crate::math::sgn;
use crate::model::{ModelError, solve_mass};

/// State of the four friction directions: sliding with a sign, or sticking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Sign of the friction in each of [`DIRECTIONS`]; zero if the direction sticks or has no level.
    pub sign: [f64; 4],
    /// Sticking directions: the speed along them is zero and stays zero.
    pub stuck: [bool; 4],
    /// The resulting acceleration [rad/s^2].
    pub acceleration: [f64; 2],
}

impl Contact {
    /// The one direction in which the wheels can accelerate: `None` if all directions are free, `Some([0,
    /// 0])` if none is.
    #[must_use]
    pub fn freedom(&self) -> Option<[f64; 2]> {
        let mut stuck = (0..4).filter(|&j| self.stuck[j]);
        match (stuck.next(), stuck.next()) {
            (None, _) => None,
            (Some(j), None) => Some(perpendicular(j)),
            _ => Some([0.0; 2]),
        }
    }
}

/// The direction of the remaining motion if direction `j` sticks.
#[must_use]
pub(super) fn perpendicular(j: usize) -> [f64; 2] {
    let [d1, d2] = DIRECTIONS[j];
    [-d2, d1]
}

/// The torque of dry friction on each wheel, with the signs of a contact state.
#[inline]
pub(super) fn friction(level: &[f64; 4], sign: &[f64; 4]) -> [f64; 2] {
    with_friction([0.0; 2], &level.map(|level| level.max(0.0)), sign)
}

/// `n (n·b)/(n' A n)`, or zero if no direction is free.
pub(super) fn along_freedom(mass: &[f64; 3], b: &[f64; 2], n: &[f64; 2]) -> [f64; 2] {
    let [m11, m12, m22] = *mass;
    let inertia = m11 * n[0] * n[0] + 2.0 * m12 * n[0] * n[1] + m22 * n[1] * n[1];
    if inertia <= 0.0 {
        return [0.0; 2];
    }
    let q = (n[0] * b[0] + n[1] * b[1]) / inertia;
    [n[0] * q, n[1] * q]
}

/// Determines which directions stick, which slip, and the accelerations.
///
/// ```text
/// minimise over a:  1/2 a' A a - a' b + Σ_{j at rest} level_j |d_j·a|,
/// b = M - torque - Σ_{j moving} d_j level_j sgn(d_j·ω)
/// ```
/// Source: Gauss' principle of least constraint with Coulomb friction (Moreau); for the two
/// wheels alone it is the four-case complementarity problem stick/slip x stick/slip. The function
/// is strictly convex with kinks along lines through the origin, so its minimum is the best of
/// the origin, the minimum along each kink, and the minimum in each sector.
///
/// `terms` [kg m^2, N m], `torque` [N m], `omega` [rad/s]. A direction is at rest if the speed
/// along it is exactly zero.
///
/// # Errors
/// If the mass matrix is not positive definite.
pub fn contact(
    terms: &Terms<f64>,
    torque: &[f64; 2],
    omega: &[f64; 2],
) -> Result<Contact, ModelError> {
    let mut b = [torque[0] - terms.torque[0], torque[1] - terms.torque[1]];
    let mut sign = [0.0; 4];
    let mut resting = [0_usize; 4];
    let mut count = 0;
    for j in 0..4 {
        let level = terms.level[j];
        let speed = along(j, omega);
        if level <= 0.0 {
            continue;
        }
        if speed == 0.0 {
            resting[count] = j;
            count += 1;
            continue;
        }
        sign[j] = sgn(speed);
        for i in 0..2 {
            b[i] -= DIRECTIONS[j][i] * level * sign[j];
        }
    }
    let resting = &resting[..count];
    let free = solve_mass(&terms.mass, &b)?;
    if resting.is_empty() {
        return Ok(Contact { sign, stuck: [false; 4], acceleration: free });
    }
    let acceleration = match *resting {
        [j] => of_one_at_rest(terms, &b, &free, j)?,
        _ => least_constraint(terms, &b, resting),
    };
    let mut stuck = [false; 4];
    for &j in resting {
        let rate = along(j, &acceleration);
        sign[j] = sgn(rate);
        stuck[j] = rate == 0.0;
    }
    Ok(Contact { sign, stuck, acceleration })
}

/// [`least_constraint`] with only direction `j` at rest: it slides in the direction of its free acceleration if
/// its friction does not prevent that, and sticks otherwise.
fn of_one_at_rest(
    terms: &Terms<f64>,
    b: &[f64; 2],
    free: &[f64; 2],
    j: usize,
) -> Result<[f64; 2], ModelError> {
    let side = sgn(along(j, free));
    let [f1, f2] = DIRECTIONS[j].map(|share| share * terms.level[j] * side);
    let sliding = solve_mass(&terms.mass, &[b[0] - f1, b[1] - f2])?;
    let slides = along(j, &sliding) * side > 0.0;
    Ok(if slides { sliding } else { along_freedom(&terms.mass, b, &perpendicular(j)) })
}

/// The minimum of the convex function in the docs of [`contact`]; a kink candidate is exactly on
/// its kink, so that `along` gives an exact zero.
fn least_constraint(terms: &Terms<f64>, b: &[f64; 2], resting: &[usize]) -> [f64; 2] {
    let [m11, m12, m22] = terms.mass;
    let quadratic = |a: &[f64; 2]| {
        0.5 * (m11 * a[0] * a[0] + 2.0 * m12 * a[0] * a[1] + m22 * a[1] * a[1])
            - a[0] * b[0]
            - a[1] * b[1]
    };
    let cost = |a: &[f64; 2]| {
        quadratic(a) + resting.iter().map(|&j| terms.level[j] * along(j, a).abs()).sum::<f64>()
    };
    let mut best = ([0.0; 2], 0.0);
    let mut consider = |a: [f64; 2]| {
        let value = cost(&a);
        if value < best.1 {
            best = (a, value);
        }
    };
    for &j in resting {
        let n = perpendicular(j);
        let force = n[0] * b[0] + n[1] * b[1];
        let hold: f64 = resting.iter().map(|&k| terms.level[k] * along(k, &n).abs()).sum();
        let mass = m11 * n[0] * n[0] + 2.0 * m12 * n[0] * n[1] + m22 * n[1] * n[1];
        let q = sgn(force) * (force.abs() - hold).max(0.0) / mass;
        consider([n[0] * q, n[1] * q]);
    }
    for pattern in 0..1_usize << resting.len() {
        let side = |k: usize| if pattern >> k & 1 == 1 { 1.0 } else { -1.0 };
        let mut force = *b;
        for (k, &j) in resting.iter().enumerate() {
            for i in 0..2 {
                force[i] -= DIRECTIONS[j][i] * terms.level[j] * side(k);
            }
        }
        let Ok(a) = solve_mass(&terms.mass, &force) else { continue };
        if resting.iter().enumerate().all(|(k, &j)| along(j, &a) * side(k) > 0.0) {
            consider(a);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn terms(level: [f64; 4]) -> Terms<f64> {
        Terms { mass: [0.032, -0.0024, 0.032], torque: [0.0; 2], level }
    }

    #[test]
    fn wheels_at_rest_stay_while_the_torques_are_below_the_level() {
        let c = contact(&terms([0.125, 0.125, 0.0, 0.0]), &[0.12, -0.1], &[0.0; 2]).unwrap();
        assert_eq!((c.acceleration, c.stuck), ([0.0; 2], [true, true, false, false]));
    }

    #[test]
    fn one_wheel_breaks_away_and_the_other_is_held_against_the_coupling() {
        let c = contact(&terms([0.125, 0.125, 0.0, 0.0]), &[0.3, 0.0], &[0.0; 2]).unwrap();
        assert_eq!(c.stuck, [false, true, false, false]);
        assert_eq!(c.acceleration[1], 0.0);
        assert!((c.acceleration[0] - (0.3 - 0.125) / 0.032).abs() < 1e-12);
    }

    #[test]
    fn straight_driving_is_held_straight_by_scrub_friction() {
        let c = contact(&terms([0.1, 0.1, 0.05, 0.0]), &[0.30, 0.28], &[3.0, 3.0]).unwrap();
        assert_eq!(c.stuck, [false, false, true, false]);
        assert!((c.acceleration[0] - c.acceleration[1]).abs() == 0.0);
        assert!((c.acceleration[0] - (0.58 - 0.2) / (2.0 * (0.032 - 0.0024))).abs() < 1e-12);
    }

    #[test]
    fn the_choice_is_the_minimum_of_the_convex_function_over_random_cases() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for _ in 0..2000 {
            let mut level = [0.0; 4];
            level.iter_mut().for_each(|l| *l = f64::max(0.0, rng.random_range(-0.1..0.2)));
            let t = terms(level);
            let m = [rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5)];
            let c = contact(&t, &m, &[0.0; 2]).unwrap();
            let cost = |a: [f64; 2]| {
                0.5 * (0.032 * (a[0] * a[0] + a[1] * a[1]) - 0.0048 * a[0] * a[1])
                    - a[0] * m[0]
                    - a[1] * m[1]
                    + (0..4).map(|j| level[j] * along(j, &a).abs()).sum::<f64>()
            };
            let at = cost(c.acceleration);
            for _ in 0..20 {
                let near = c.acceleration.map(|a| a + rng.random_range(-0.5..0.5));
                assert!(cost(near) >= at - 1e-12, "{c:?} {near:?}");
            }
        }
    }

    #[test]
    fn a_single_direction_at_rest_sticks_or_slides_as_the_convex_function_demands() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let (mut held, mut moving) = (0, 0);
        for _ in 0..2000 {
            let t = terms([0; 4].map(|_| rng.random_range(0.01..0.2)));
            let m = [rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5)];
            for (j, omega) in [[0.0, 2.0], [-1.5, 0.0], [3.0, 3.0], [2.0, -2.0]].iter().enumerate()
            {
                let found = contact(&t, &m, omega).unwrap();
                let sign = [0, 1, 2, 3].map(|k| sgn(along(k, omega)));
                let resisting = friction(&t.level, &sign);
                let expected =
                    least_constraint(&t, &[m[0] - resisting[0], m[1] - resisting[1]], &[j]);
                assert_eq!(found.stuck[j], along(j, &expected) == 0.0);
                if found.stuck[j] {
                    held += 1
                } else {
                    moving += 1
                }
                for i in 0..2 {
                    assert!((found.acceleration[i] - expected[i]).abs() < 1e-11, "{j} {found:?}");
                }
            }
        }
        assert!(held > 500 && moving > 500, "{held} {moving}");
    }
}
