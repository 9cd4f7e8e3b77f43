//! A constant torque of the motion that the input also shows at rest: the offset of its sensor.

use crate::conditioning::{Channel, Finding, Kind};
use crate::effects::{self, Motion};
use crate::math::round_significant;
use crate::report::format;
use crate::robot::Robot;
use crate::study::{ParameterStudy, Study};

/// Standard errors within which the input at rest and the torque in motion agree (three sigma).
const AGREES: f64 = 3.0;

/// The sentence on the offset of the sensor, and what to do; `None` if no constant torque was found, or if the input at
/// rest is another one: a torque that friction holds at rest ends with the rest.
pub(super) fn notice(study: &Study) -> Option<(String, String)> {
    let diagnosis = study.diagnosis.as_ref()?;
    let findings: Vec<&Finding> = study.recordings.iter().flat_map(|r| &r.conditioning).collect();
    let id = diagnosis.found.iter().find(|id| is_sensor(id, &diagnosis.parameters, &findings))?;
    let effect = effects::find(id)?.description().title.to_lowercase();
    let rest = [0, 1].map(|i| at_rest(&findings, i).map_or(0.0, |(mean, _)| mean));
    let unit = diagnosis.logging.unit.symbol();
    let [right, left] = rest.map(|mean| format::significant(mean, 3));
    let sentence = format!(
        "The {effect} is the input at rest ({right} and {left} {unit}): an offset of its sensor, not a torque on the robot."
    );
    // a number of TOML
    let [right, left] = rest.map(|mean| round_significant(-mean, 3));
    let remedy = format!(
        "To remove it, write offset = {right} in M1 and offset = {left} in M2 under columns (in the unit of the file)."
    );
    Some((sentence, remedy))
}

/// Whether an effect is a constant torque of the size of the input at rest, on both wheels.
fn is_sensor(id: &str, parameters: &[ParameterStudy], findings: &[&Finding]) -> bool {
    let own: Vec<_> = parameters.iter().filter(|p| p.effect == id).map(|p| &p.estimate).collect();
    let values: Vec<f64> = own.iter().map(|e| e.value).collect();
    let Some(torque) = constant_torque(id, &values) else { return false };
    let error = own.iter().map(|e| e.std_error).fold(0.0, f64::max);
    (0..2).any(|i| at_rest(findings, i).is_some())
        && (0..2).all(|i| {
            let (mean, std_error) = at_rest(findings, i).unwrap_or_default();
            (torque[i] - mean).abs() <= AGREES * error.hypot(std_error)
        })
}

/// The torque that an effect takes from the input of both wheels, if it is the same in every motion.
fn constant_torque(id: &str, p: &[f64]) -> Option<[f64; 2]> {
    let effect = effects::find(id).filter(|e| e.parameters().len() == p.len())?;
    let robot = Robot::amigobot();
    let of = |t: f64, alpha, omega| effect.terms(&Motion::at(t, alpha, omega, &robot), p);
    let rest = of(0.0, [0.0; 2], [0.0; 2]);
    let is_constant = rest == of(3.0, [1.0, 2.5], [4.0, -7.0]) && rest.level == [0.0; 4];
    (is_constant && rest.mass == [0.0; 3] && !effect.acts_on_input()).then_some(rest.torque)
}

/// Mean of the input of a wheel at rest over the recordings that show one, and its largest standard error.
fn at_rest(findings: &[&Finding], wheel: usize) -> Option<(f64, f64)> {
    let of = |finding: &&Finding| match finding.kind {
        Kind::RestOffset { mean, std_error } if finding.channel == Channel::Input(wheel) => {
            Some((mean, std_error))
        }
        _ => None,
    };
    let all: Vec<(f64, f64)> = findings.iter().filter_map(of).collect();
    let mean = crate::math::mean(all.iter().map(|(mean, _)| *mean));
    let error = all.iter().map(|(_, error)| *error).fold(0.0, f64::max);
    (!all.is_empty()).then_some((mean, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::Action;
    use crate::identify::Estimate;

    #[test]
    fn a_constant_torque_of_the_size_of_the_input_at_rest_is_an_offset_of_the_sensor() {
        let parameter = |symbol: &str, value: f64| ParameterStudy {
            effect: "torque_offset".into(),
            meaning: String::new(),
            estimate: Estimate::new(symbol, "N m".into(), value, 4e-4),
        };
        let parameters = [parameter("o1", 0.0201), parameter("o2", -0.0153)];
        let finding = |i: usize, mean: f64| Finding {
            channel: Channel::Input(i),
            kind: Kind::RestOffset { mean, std_error: 1.3e-4 },
            action: Action::Noted,
        };
        let sensor = [finding(0, 0.02003), finding(1, -0.0150)];
        let held = [finding(0, 0.05), finding(1, 0.05)];
        let is = |findings: &[Finding]| {
            is_sensor("torque_offset", &parameters, &findings.iter().collect::<Vec<_>>())
        };
        assert!(is(&sensor) && !is(&held) && !is(&[]));
        assert!(constant_torque("viscous_friction", &[0.1]).is_none());
        // in motion a friction that differs by direction is a constant torque too
        assert_eq!(constant_torque("coulomb_asymmetry", &[0.1, 0.2]), Some([0.1, 0.2]));
    }
}
