//! Gains as data and as code.

use serde_json::{Value, json};

use super::document::Identified;
use super::gain_errors::GainErrors;
use super::gains::{Gains, Operation};
use crate::recording::DriveUnit;

/// `gains.json`, and the feed-forward as code: `feedforward.c`, `feedforward.py`, `Feedforward.java`.
#[must_use]
pub fn gains_files(
    it: &Identified,
    gains: &Gains,
    errors: &GainErrors,
    operation: &Operation,
) -> Vec<(String, String)> {
    let data = json(it, gains, errors, operation);
    let data = serde_json::to_string_pretty(&data).unwrap_or_default() + "\n";
    let mut files = vec![("gains.json".to_owned(), data)];
    files.extend(code(it, gains, errors));
    files
}

fn json(it: &Identified, gains: &Gains, errors: &GainErrors, operation: &Operation) -> Value {
    let robot = it.model.robot();
    let (c, unit) = (&robot.construction, it.drive_unit.symbol());
    let (r, l1) = (robot.r(), robot.l1());
    let mass = c.m4_kg + c.m1_kg + c.m2_kg;
    // kA of turning over kA of driving straight, in units of the wheel
    let ratio = gains.wheel_turning.ka / gains.wheel.ka;
    let torque = it.drive_unit == DriveUnit::NewtonMetre;
    let inertia = if torque {
        2.0 * (l1 / r).powi(2) * gains.wheel_turning.ka
    } else {
        mass * l1 * l1 * ratio
    };
    let [straight, turning] = errors.shows_inertia(gains);
    let (inertia, source) = match (turning && (torque || straight), torque) {
        (false, _) => (None, "not identified by these recordings".to_owned()),
        (true, true) => {
            let words = "identified; about the middle of the axle, wheels and rotors reflected";
            (Some(inertia), words.to_owned())
        }
        (true, false) => {
            let words = "identified ratio of angular to linear kA, times a mass of";
            (Some(inertia), format!("{words} {mass} kg of the construction data"))
        }
    };
    json!({
        "experiment": it.experiment,
        "method": it.method,
        "robot": robot.name,
        "input_unit": unit,
        "units": { "linear": format!("{unit}, {unit} s/m, {unit} s^2/m"),
                   "angular": format!("{unit}, {unit} s/rad, {unit} s^2/rad"),
                   "wheel": format!("{unit}, {unit} s/rad, {unit} s^2/rad") },
        "linear": gains.linear,
        "angular": gains.angular,
        "wheel": gains.wheel,
        "wheel_turning": gains.wheel_turning,
        "line_error": { "linear": gains.line_error[0], "angular": gains.line_error[1], "unit": unit },
        "wheel_radius_m": { "value": r, "source": "construction data" },
        "track_width_m": { "value": 2.0 * l1,
            "source": "construction data: recordings of the wheels alone do not identify it" },
        "moment_of_inertia_kg_m2": { "value": inertia, "source": source },
        "std_error": { "linear": errors.linear, "angular": errors.angular },
        "not_identified": errors.not_identified(gains, it.drive_unit),
        "dead_time_s": gains.dead_time,
        "control_period_s": operation.period,
        "top_speed_rad_s": operation.top_speed,
        "largest_input": operation.largest_input,
        "control": { "linear": gains.forward, "angular": gains.turning },
        "not_in_the_gains": gains.left_out,
    })
}

/// `feedforward.c`, `feedforward.py` and `Feedforward.java` (WPILib).
fn code(it: &Identified, gains: &Gains, errors: &GainErrors) -> Vec<(String, String)> {
    [
        ("feedforward.c", include_str!("frame/feedforward.c"), "//"),
        ("feedforward.py", include_str!("frame/feedforward.py"), "#"),
        ("Feedforward.java", include_str!("frame/Feedforward.java"), "//"),
    ]
    .map(|(name, frame, sign)| (name.to_owned(), filled(frame, sign, it, gains, errors)))
    .into()
}

fn filled(frame: &str, sign: &str, it: &Identified, gains: &Gains, errors: &GainErrors) -> String {
    let robot = it.model.robot();
    let unit = it.drive_unit.symbol();
    let mut header = vec![
        format!(
            "Feed-forward of the robot \"{}\": experiment {}, {}.",
            robot.name, it.experiment, it.method
        ),
        format!("Input in {unit}; speeds in m/s and rad/s, accelerations in m/s^2 and rad/s^2."),
    ];
    let left =
        gains.left_out.iter().map(|l| format!("Not in the gains: {}: {}.", l.effect, l.reason));
    header.extend(left);
    header.extend(errors.not_identified(gains, it.drive_unit));
    let header: Vec<String> = header
        .iter()
        .map(|line| format!("{sign} {}", line.replace(['\n', '\r', '\\'], " ")))
        .collect();
    let number = |x: f64| format!("{x:?}");
    let places = [
        ("{{header}}", header.join("\n")),
        ("{{linear_ks}}", number(gains.linear.ks)),
        ("{{linear_kv}}", number(gains.linear.kv)),
        ("{{linear_ka}}", number(gains.linear.ka)),
        ("{{angular_ks}}", number(gains.angular.ks)),
        ("{{angular_kv}}", number(gains.angular.kv)),
        ("{{angular_ka}}", number(gains.angular.ka)),
        ("{{track_width}}", number(2.0 * robot.l1())),
        ("{{wheel_radius}}", number(robot.r())),
        ("{{linear_kp}}", number(gains.forward.kp)),
        ("{{linear_ki}}", number(gains.forward.ki)),
        ("{{angular_kp}}", number(gains.turning.kp)),
        ("{{angular_ki}}", number(gains.turning.ki)),
    ];
    places.iter().fold(frame.to_owned(), |text, (place, value)| text.replace(place, value))
}
