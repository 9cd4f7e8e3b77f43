//! The moment balance as a linear regression: one column a linear parameter.

use crate::effects::{Motion, along};
use crate::math::sgn;
use crate::model::Model;

/// Columns and right-hand side of the moment balance of both wheels at one instant.
///
/// ```text
/// column j = balance(parameter j one, other linear ones zero) - balance(all linear ones zero)
/// right    = drive - balance(all linear ones zero)
/// ```
/// Derived from the effects themselves, so it cannot disagree with the simulation. `acceleration`
/// [rad/s^2], `drive` [N m] the acting one; fills `row[wheel][column]` and returns the right-hand
/// side [N m].
pub(super) fn balance_rows(
    model: &Model,
    p: &[f64],
    linear: &[usize],
    motion: &Motion<f64>,
    acceleration: &[f64; 2],
    drive: &[f64; 2],
    row: &mut [Vec<f64>; 2],
) -> [f64; 2] {
    let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &motion.omega)));
    let mut unit = p.to_vec();
    for &j in linear {
        unit[j] = 0.0;
    }
    let given = model.terms(motion, &unit).moment(acceleration, &sign);
    for (column, &j) in linear.iter().enumerate() {
        unit[j] = 1.0;
        let with = model.terms(motion, &unit).moment(acceleration, &sign);
        unit[j] = 0.0;
        for wheel in 0..2 {
            row[wheel][column] = with[wheel] - given[wheel];
        }
    }
    [drive[0] - given[0], drive[1] - given[1]]
}
