//! Text on the dependence of the residual torque.

use crate::compare::{Acting, Curve, Interval};
use crate::recording::DriveUnit;
use crate::report::format;
use crate::study::{DependenceStudy, Events, is_most_of_it};

/// "The residual torque depends most on the heading (72 % of it, up to 0.31 N m)." `unit`: unit of the input.
pub(super) fn words(dependence: &DependenceStudy, unit: DriveUnit) -> String {
    let DependenceStudy { shown, beside, tested, is_left, events } = dependence;
    let residual = if *is_left { "remaining residual torque" } else { "residual torque" };
    let on = |curve: &Curve| {
        let (variable, acting) = (curve.variable.words(), curve.acting.words());
        format!("the {variable}{acting} ({})", amount(curve, unit))
    };
    let is_most = shown.as_ref().is_some_and(is_most_of_it);
    let at = events.as_ref().map(|events| at_single_times(events, residual, unit));
    // what happens at single times also correlates with whatever the robot did then
    if let Some(at) = at.as_ref().filter(|_| tested.is_none() && !is_most) {
        return at.clone();
    }
    let depends = match (shown, tested) {
        (Some(curve), _) if curve.variable.answers() => format!(
            "The {residual} varies most with {}; under feedback control it does so for any disturbance",
            on(curve)
        ),
        (Some(curve), _) => format!("The {residual} depends most on {}", on(curve)),
        // a test that assumes noise of one spectrum found a variable whose curve shows nothing
        (None, _) => {
            "The residual torque does not depend clearly on any variable that was tried".to_owned()
        }
    };
    let end = match (tested.filter(|_| shown.is_some()), is_most) {
        (Some(_), _) | (None, true) => ".",
        (None, false) => {
            "; coloured noise of the recorded input and external disturbances look the same."
        }
    };
    let beside = beside.as_ref().map_or(String::new(), |curve| {
        format!(" Among speeds, angles and time, it depends most on {}.", on(curve))
    });
    let at = at.map_or(String::new(), |at| format!(" {at}"));
    depends + end + &beside + &at
}

/// "At single times the residual torque is larger than any stationary noise explains: 0.3 N m on wheel 1 from 9.4 to
/// 10.4 s of run_b.csv, and 3 times more."
fn at_single_times(events: &Events, residual: &str, unit: DriveUnit) -> String {
    let Interval { recording, wheel, from, to, torque, .. } = events.largest();
    let more = match events.intervals.len() - 1 {
        0 => String::new(),
        1 => ", and once more".to_owned(),
        more => format!(", and {more} times more"),
    };
    format!(
        "At single times the {residual} is larger than any stationary noise explains: {} {} on wheel {} from {from:.1} to \
         {to:.1} s of {}{more}. Something acted on the robot then, or the recorded input did not reach the motors.",
        format::significant(*torque, 2),
        unit.symbol(),
        wheel + 1,
        events.names[*recording],
    )
}

/// "72 % of it, up to 0.31 N m"; for a gain "up to 31 % of the input".
fn amount(curve: &Curve, unit: DriveUnit) -> String {
    let largest = curve.largest_left();
    let most = match curve.acting {
        Acting::Gain => format!("up to {} of the input", format::percent(largest)),
        _ => format!("up to {} {}", format::significant(largest, 2), unit.symbol()),
    };
    // after effects were found the share refers to the residual torque without them
    match curve.share_after {
        Some(_) => most,
        None => format!("{} of it, {most}", format::percent(curve.share_before)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{CurveBin, Mean, Variable};

    fn of(curves: &[Curve], tested: Option<Variable>) -> String {
        words(&DependenceStudy::of(curves, tested, None), DriveUnit::NewtonMetre)
    }

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
        let words = of(&given, Some(Variable::TurnRate));
        assert_eq!(
            words,
            "The residual torque varies most with the input of wheel 1 (72 % of it, up to 0.31 N m); under feedback \
             control it does so for any disturbance. Among speeds, angles and time, it depends most on the time (10 % \
             of it, up to 0.31 N m)."
        );
        let left =
            [curve(Variable::TurnRate, 0.7, Some(0.0)), curve(Variable::Time, 0.1, Some(0.05))];
        let words = of(&left, Some(Variable::TurnRate));
        assert_eq!(
            words,
            "The remaining residual torque depends most on the time (up to 0.31 N m)."
        );
    }

    #[test]
    fn what_happens_at_single_times_is_reported_with_its_time() {
        let at = |recording, wheel, from, torque| {
            let to = from + 0.9;
            Interval { recording, wheel, from, to, torque, blocks: 1 }
        };
        let intervals = vec![at(0, 0, 3.0, 0.1), at(1, 1, 9.0, -0.3)];
        let events =
            || Some(Events { intervals: intervals.clone(), names: vec!["a".into(), "b".into()] });
        let curves = [curve(Variable::TurnRate, 0.089, None)];
        let of =
            |tested| words(&DependenceStudy::of(&curves, tested, events()), DriveUnit::NewtonMetre);
        let alone = of(None);
        assert!(
            alone.starts_with(
                "At single times the residual torque is larger than any stationary noise explains: −0.3 N m on wheel 2 from \
                 9.0 to 9.9 s of b, and once more."
            ),
            "{alone}"
        );
        let beside = of(Some(Variable::TurnRate));
        assert!(
            beside.starts_with("The residual torque depends most on the turn rate"),
            "{beside}"
        );
        assert!(beside.contains(". At single times"), "{beside}");
    }

    #[test]
    fn what_changes_its_sign_with_the_motion_is_called_a_resistance() {
        let acting = |variable, acting| Curve { acting, ..curve(variable, 0.8, None) };
        let against = of(&[acting(Variable::Heading, Acting::Resistance)], None);
        assert_eq!(
            against,
            "The residual torque depends most on the heading, as a resistance to the motion (80 % of it, up to \
             0.31 N m)."
        );
        let fading = of(&[acting(Variable::Time, Acting::Gain)], None);
        assert!(fading.ends_with(
            "the time, in proportion to the input (80 % of it, up to 31 % of the input)."
        ));
    }

    #[test]
    fn what_is_not_significant_beside_coloured_noise_is_reported_as_such() {
        let given = [curve(Variable::Input1, 0.32, None)];
        let words = of(&given, None);
        assert!(words.contains("for any disturbance; coloured noise"), "{words}");
        let nothing = of(&[curve(Variable::Time, 0.001, None)], None);
        assert!(
            nothing.starts_with("The residual torque does not depend clearly on any variable"),
            "{nothing}"
        );
    }
}
