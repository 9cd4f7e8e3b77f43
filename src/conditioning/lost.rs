//! Rows that a logger lost, in which a held input took values that were not recorded.

use super::thresholds::TIMES;
use crate::math::median_step;
use crate::recording::{REGULAR, is_gap};

/// An input that is held from row to row, with its mean until the next row where rows in between were lost, and the
/// number of these. `None` if none is lost, or the rows are not even.
///
/// ```text
/// mean = M_k + (n - 1)/(2 n) (M_k+n - M_k)
/// n: steps from a row to the next; the lost values are on the line between them
/// ```
/// Held at M_k over n steps the input would be late by (n - 1)/2 of them on average, and inertias too large.
#[must_use]
pub fn held_over_lost_rows(t: &[f64], torque: &[[f64; 2]]) -> Option<(Vec<[f64; 2]>, usize)> {
    let step = median_step(t);
    let steps = |k: usize| {
        let steps = (t[k + 1] - t[k]) / step;
        let whole = steps.round();
        ((steps - whole).abs() < TIMES.whole_rows && !is_gap(t[k], t[k + 1], step)).then_some(whole)
    };
    let whole: Vec<Option<f64>> = (0..t.len().saturating_sub(1)).map(steps).collect();
    let single = whole.iter().filter(|n| **n == Some(1.0)).count();
    if (single as f64) < REGULAR * whole.len() as f64 {
        return None;
    }
    let (mut mean, mut lost) = (torque.to_vec(), 0);
    for (k, n) in whole.into_iter().enumerate() {
        let Some(n) = n.filter(|n| *n > 1.0) else { continue };
        let share = (n - 1.0) / (2.0 * n);
        mean[k] = [0, 1].map(|i| torque[k][i] + share * (torque[k + 1][i] - torque[k][i]));
        lost += n as usize - 1;
    }
    (lost > 0).then_some((mean, lost))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_impulse_of_a_rising_input_is_that_of_all_rows() {
        let all: Vec<(f64, [f64; 2])> =
            (0..100).map(|k| (0.01 * f64::from(k), [f64::from(k), 2.0])).collect();
        let kept = all.iter().enumerate().filter(|(k, _)| ![20, 40, 41].contains(k));
        let (t, torque): (Vec<f64>, Vec<[f64; 2]>) = kept.map(|(_, row)| *row).unzip();
        let (mean, lost) = held_over_lost_rows(&t, &torque).unwrap();
        assert_eq!(lost, 3);
        let impulse = |t: &[f64], m: &[[f64; 2]], i: usize| -> f64 {
            t.windows(2).zip(m).map(|(t, m)| (t[1] - t[0]) * m[i]).sum()
        };
        let (times, inputs): (Vec<f64>, Vec<[f64; 2]>) = all.into_iter().unzip();
        for i in 0..2 {
            let off = impulse(&t, &mean, i) - impulse(&times, &inputs, i);
            assert!(off.abs() < 1e-9, "{off}");
        }
        // as recorded it is late: 0.01 * (1 + 1 + 2) of the three lost values
        let off = impulse(&times, &inputs, 0) - impulse(&t, &torque, 0);
        assert!((off - 0.04).abs() < 1e-9, "{off}");
    }

    #[test]
    fn uneven_rows_and_pauses_of_a_logger_are_no_lost_rows() {
        let torque: Vec<[f64; 2]> = (0..200).map(|k| [f64::from(k); 2]).collect();
        let uneven = |k: i32| 0.01 * (f64::from(k) + 0.4 * f64::from(k * k % 7) / 7.0);
        let t: Vec<f64> = (0..200).map(uneven).collect();
        assert!(held_over_lost_rows(&t, &torque).is_none());
        let t: Vec<f64> =
            (0..200).map(|k| 0.01 * f64::from(k) + if k < 100 { 0.0 } else { 1.0 }).collect();
        assert!(held_over_lost_rows(&t, &torque).is_none());
    }
}
