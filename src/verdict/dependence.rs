//! What the residual torque depends on, in words.

use crate::compare::{Acting, Curve, Variable};
use crate::diagnose::THRESHOLDS;
use crate::recording::DriveUnit;
use crate::report::format;

/// What the residual torque of the last model depends on, as the curves of the report show it. `tested` is the variable
/// on which it depends significantly beside noise that is coloured; `unit` that of the input.
pub(super) fn residual_torque(
    curves: &[Curve],
    tested: Option<Variable>,
    unit: DriveUnit,
) -> String {
    let shown = most_left(curves).filter(|c| c.left() >= THRESHOLDS.named_share);
    let is_left = if curves.iter().any(|c| c.share_after.is_some()) { " that is left" } else { "" };
    let on = |curve: &Curve| {
        let (variable, acting) = (curve.variable.words(), curve.acting.words());
        format!("the {variable}{acting} ({})", amount(curve, unit))
    };
    let follows = shown.filter(|curve| curve.variable.answers());
    let depends = match (shown, tested) {
        (Some(curve), _) if follows.is_some() => format!(
            "The residual torque{is_left} follows {}, as it does under a controller whatever disturbs the robot",
            on(curve)
        ),
        (Some(curve), _) => format!("The residual torque{is_left} depends most on {}", on(curve)),
        (None, Some(variable)) => {
            format!("The residual torque depends on the {}", variable.words())
        }
        (None, None) => "The residual torque depends little on anything that was tried".to_owned(),
    };
    let end = match (tested, shown.is_some_and(is_most_of_it)) {
        (Some(_), _) | (None, true) => ".",
        (None, false) => {
            "; coloured noise of the recorded input and disturbances from outside look like this too."
        }
    };
    let beside = follows.and(most_pointing(curves)).map_or(String::new(), |curve| {
        format!(" Of speeds, place and time it depends most on {}.", on(curve))
    });
    depends + end + &beside
}

/// The curve that shows most of the residual torque over anything but what answers every disturbance, where it shows a
/// part worth naming.
pub(super) fn most_pointing(curves: &[Curve]) -> Option<&Curve> {
    let pointing = curves.iter().filter(|curve| !curve.variable.answers());
    let most = pointing.max_by(|a, b| a.left().total_cmp(&b.left()));
    most.filter(|curve| curve.left() >= THRESHOLDS.named_share)
}

/// The curve that shows most of the residual torque that is left.
pub(super) fn most_left(curves: &[Curve]) -> Option<&Curve> {
    curves.iter().max_by(|a, b| a.left().total_cmp(&b.left()))
}

/// Whether a curve is the larger part of the residual torque of the model as given.
pub(super) fn is_most_of_it(curve: &Curve) -> bool {
    curve.left() >= THRESHOLDS.unexplained
}

/// "72 % of it, up to 0.31 N m"; as a share of the input "up to 31 % of that".
fn amount(curve: &Curve, unit: DriveUnit) -> String {
    let largest = curve.largest_left();
    let most = match curve.acting {
        Acting::Gain => format!("up to {} of that", format::percent(largest)),
        _ => format!("up to {} {}", format::significant(largest, 2), unit.symbol()),
    };
    // after effects were found the share is one of the residual torque before
    match curve.share_after {
        Some(_) => most,
        None => format!("{} of it, {most}", format::percent(curve.share_before)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{CurveBin, Mean};

    const UNIT: DriveUnit = DriveUnit::NewtonMetre;

    fn curve(variable: Variable, before: f64, after: Option<f64>) -> Curve {
        let means = [-0.31, 0.02].map(|value| Mean { value, std_error: 0.01, blocks: 9 });
        let after_means = after.map(|_| means);
        let bin = CurveBin { at: 0.0, joined: false, before: means, after: after_means };
        Curve {
            variable,
            acting: Acting::Torque,
            bins: vec![bin],
            share_before: before,
            share_after: after,
            log_significance: 50.0,
        }
    }

    #[test]
    fn the_verdict_names_the_variable_that_the_figure_shows() {
        let given = [curve(Variable::Input1, 0.72, None), curve(Variable::Time, 0.1, None)];
        let words = residual_torque(&given, Some(Variable::TurnRate), UNIT);
        assert_eq!(
            words,
            "The residual torque follows the input of wheel 1 (72 % of it, up to 0.31 N m), as it does under a \
             controller whatever disturbs the robot. Of speeds, place and time it depends most on the time (10 % of \
             it, up to 0.31 N m)."
        );
        let left =
            [curve(Variable::TurnRate, 0.7, Some(0.0)), curve(Variable::Time, 0.1, Some(0.05))];
        let words = residual_torque(&left, Some(Variable::TurnRate), UNIT);
        assert_eq!(
            words,
            "The residual torque that is left depends most on the time (up to 0.31 N m)."
        );
    }

    #[test]
    fn what_changes_its_sign_with_the_motion_is_called_a_resistance() {
        let acting = |variable, acting| Curve { acting, ..curve(variable, 0.8, None) };
        let against = residual_torque(&[acting(Variable::Heading, Acting::Resistance)], None, UNIT);
        assert_eq!(
            against,
            "The residual torque depends most on the heading, as a resistance to the motion (80 % of it, up to \
             0.31 N m)."
        );
        let fading = residual_torque(&[acting(Variable::Time, Acting::Gain)], None, UNIT);
        assert!(
            fading.ends_with("the time, as a share of the input (80 % of it, up to 31 % of that).")
        );
    }

    #[test]
    fn what_is_not_significant_beside_coloured_noise_says_so() {
        let given = [curve(Variable::Input1, 0.32, None)];
        let words = residual_torque(&given, None, UNIT);
        assert!(words.contains("whatever disturbs the robot; coloured noise"), "{words}");
        let nothing = residual_torque(&[curve(Variable::Time, 0.001, None)], None, UNIT);
        assert!(nothing.starts_with("The residual torque depends little on anything"), "{nothing}");
    }
}
