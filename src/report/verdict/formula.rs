//! Text on a formula for the residual torque.

use crate::diagnose::{Errors, THRESHOLDS};
use crate::report::format;
use crate::study::FormulaStudy;

/// "A formula for this dependence (heading_resistance) lowers the 2 s simulation error to 0.061 rad/s, 1.7 times the
/// noise floor."
pub(super) fn words(formula: &FormulaStudy, errors: &Errors, named: &str) -> String {
    let FormulaStudy { id, in_place, window_rms, .. } = formula;
    let place = if *in_place { ", in place of the effects found," } else { "" };
    let over = match window_rms / errors.floor.sqrt() {
        ratio if !ratio.is_finite() => String::new(),
        ratio if ratio <= THRESHOLDS.at_floor => ", at the noise floor".to_owned(),
        ratio => format!(", {ratio:.1} times the noise floor"),
    };
    let error = format::significant(*window_rms, 3);
    format!(
        "A formula for this dependence ({id}){place} lowers the {named} to {error} rad/s{over}."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_compare_with_the_floor() {
        let formula = |window_rms, in_place| FormulaStudy {
            id: "heading_resistance".into(),
            in_place,
            window_rms,
            ..FormulaStudy::default()
        };
        let (error, floor) = (0.1_f64.powi(2), 0.0358_f64.powi(2));
        let errors = Errors {
            before: error,
            after: error,
            floor,
            most: floor,
            uncertain: 0.0,
            slow_floor: false,
            speed: 1e4,
        };
        assert_eq!(
            words(&formula(0.0612, true), &errors, "2 s simulation error"),
            "A formula for this dependence (heading_resistance), in place of the effects found, lowers the 2 s \
             simulation error to 0.0612 rad/s, 1.7 times the noise floor."
        );
        assert!(
            words(&formula(0.0412, false), &errors, "2 s simulation error")
                .ends_with("0.0412 rad/s, at the noise floor.")
        );
    }
}
