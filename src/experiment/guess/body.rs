//! The motion of the body, which is not that of a wheel: position, orientation and angular velocity as vectors.
//!
//! The components 1, 2 and 3 of a pose are no motors 1, 2 and 3: their names state an odometry, a pose or an inertial
//! sensor. Beside x, y and a heading, `v` and `omega` are the speeds of the body and no voltage and no wheel.

use super::guessed::{Candidate, Guess};
use crate::io::{PreviewColumn, words};

/// Words of sources that state the motion of the body.
const BODY: [&str; 10] = [
    "odometry",
    "odom",
    "pose",
    "twist",
    "imu",
    "gps",
    "gnss",
    "orientation",
    "mocap",
    "optitrack",
];
/// Names of the heading beside x and y, and of the speeds of a body with these.
const HEADINGS: [&str; 7] = ["theta", "yaw", "heading", "psi", "phi", "th", "orientation"];
const SPEEDS: [&str; 12] =
    ["v", "w", "omega", "vx", "vy", "vz", "wz", "velocity", "vel", "speed", "linear", "angular"];
/// Columns that are named in the answer.
const SHOWN: usize = 24;

/// Removes the quantity of the components of vectors of the body.
pub(super) fn apply(all: &mut [Candidate]) {
    let names: Vec<Vec<String>> = all.iter().map(|c| words(&c.column.name)).collect();
    for (one, name) in all.iter_mut().zip(&names) {
        if is_of_body(name, &names) {
            one.named.quantity = None;
            one.named.side = None;
            one.named.foreign = true;
        }
    }
}

/// Whether a name is that of a component of a vector of three of the body, or of its pose in the plane.
fn is_of_body(name: &[String], names: &[Vec<String>]) -> bool {
    is_of_vector(name, names) || is_of_pose(name, names)
}

/// Whether a name is one word for a place, a heading or a speed beside x, y and a heading.
fn is_of_pose(name: &[String], names: &[Vec<String>]) -> bool {
    let is_heading = |name: &[String]| matches!(name, [one] if HEADINGS.contains(&one.as_str()));
    let has = |word: &str| names.iter().any(|n| matches!(&n[..], [one] if one == word));
    let is_one = matches!(name, [one] if matches!(one.as_str(), "x" | "y") || SPEEDS.contains(&one.as_str()));
    (is_one || is_heading(name)) && has("x") && has("y") && names.iter().any(|n| is_heading(n))
}

/// Whether a name is that of a component of a vector of three of the body.
fn is_of_vector(name: &[String], names: &[Vec<String>]) -> bool {
    let Some((number, rest)) = name.split_last() else { return false };
    let has = |number: &str| names.iter().any(|n| n.split_last() == Some((&number.into(), rest)));
    let is_number = ["1", "2", "3"].contains(&number.as_str());
    is_number
        && rest.iter().any(|w| BODY.contains(&w.as_str()))
        && ["1", "2", "3"].into_iter().all(has)
}

/// Replaces the questions by the answer that the log has no wheels, if it has the motion of the body alone.
pub(super) fn alone(columns: &[PreviewColumn], out: &mut Guess) {
    let is_used = |name: &str| out.columns.iter().any(|c| c.name == name);
    let names: Vec<Vec<String>> = columns.iter().map(|c| words(&c.name)).collect();
    let has_wheels = out.columns.iter().any(|c| c.key != "t");
    if has_wheels || !names.iter().any(|name| is_of_body(name, &names)) {
        return;
    }
    let others: Vec<String> =
        columns.iter().filter(|c| !is_used(&c.name)).map(|c| format!("`{}`", c.name)).collect();
    let more = others.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let listed = others[..others.len().min(SHOWN)].join(", ");
    out.questions.clear();
    out.ask(format!(
        "this log has no columns of the wheels. Looked for: an angle or a speed of the right and of the left wheel (encoder \
         counts, rpm, m/s), and the torque, current, voltage or PWM of their motors. Its columns are {listed}{more}: the \
         motion of the body, from which the dynamics of the wheels cannot be found. Record the encoders and the inputs of the \
         motors in the same log; if columns above are those of the wheels, write them in place of \"?\""
    ));
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    fn log(names: &[&str]) -> Vec<PreviewColumn> {
        let column = |(k, name): (usize, &&str)| PreviewColumn {
            name: (*name).into(),
            values: (0..200).map(|n| (0.05 * f64::from(n) + k as f64).sin()).collect(),
            ..PreviewColumn::default()
        };
        let time = PreviewColumn {
            name: "clock".into(),
            values: (0..200).map(|n| 0.01 * f64::from(n)).collect(),
            ..PreviewColumn::default()
        };
        [time].into_iter().chain(names.iter().enumerate().map(column)).collect()
    }

    #[test]
    fn a_log_of_poses_alone_has_no_wheels() {
        let pose = ["Position", "Orientation", "AngularVelocity"];
        let names: Vec<String> = pose
            .iter()
            .flat_map(|name| (1..4).map(move |k| format!("Odometry.{name}.{k}")))
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let found = guess(&log(&names));
        let asked = found.asked();
        assert!(asked.starts_with("this log has no columns of the wheels"), "{asked}");
        assert!(asked.contains("`Odometry.Position.1`") && found.questions.len() == 1, "{asked}");
        assert!(found.columns.iter().all(|c| c.key == "t"), "{found:?}");
        // beside wheels a pose is only unused
        let wheels = ["left_rpm", "right_rpm", "left_volts", "right_volts"];
        let found = guess(&log(&[&names[..], &wheels].concat()));
        assert!(!found.asked().contains("no columns of the wheels"), "{}", found.asked());
        assert!(found.columns.iter().any(|c| c.name == "right_rpm"), "{found:?}");
    }

    #[test]
    fn a_pose_in_the_plane_with_its_speeds_has_no_wheels() {
        let pose = ["x", "y", "theta", "v", "omega"];
        let found = guess(&log(&pose));
        assert!(
            found.asked().starts_with("this log has no columns of the wheels"),
            "{}",
            found.asked()
        );
        let wheels = ["omega_r", "omega_l", "u_r [V]", "u_l [V]"];
        let found = guess(&log(&[&pose[..], &wheels].concat()));
        assert!(found.columns.iter().any(|c| c.name == "omega_r"), "{found:?}");
        assert!(found.columns.iter().all(|c| !pose.contains(&c.name.as_str())), "{found:?}");
    }

    #[test]
    fn three_motors_by_number_are_no_body() {
        let asked = guess(&log(&["vel.1", "vel.2", "vel.3"])).asked();
        assert!(!asked.contains("no columns of the wheels"), "{asked}");
    }
}
