//! Which shapes of an effect are tried.

use crate::effects::{ParameterKind, ParameterSpec};
use crate::recording::Recording;

/// Top speed of the AmigoBot, to which the grid of Stribeck speeds belongs [rad/s].
const AMIGOBOT_SPEED: f64 = 12.0;

/// Size of the signals, which sets the grids of shape parameters.
pub(super) struct Scale {
    moment: f64,
    step: f64,
    duration: f64,
    /// Top speed [rad/s].
    pub(super) speed: f64,
    /// Largest angle that a wheel goes through [rad].
    angle: f64,
}

impl Scale {
    pub(super) fn of(recordings: &[&Recording]) -> Self {
        let largest = recordings
            .iter()
            .flat_map(|r| r.moment().iter().flatten())
            .fold(0.0_f64, |a, m| a.max(m.abs()));
        let step = recordings.iter().map(|r| r.step()).fold(0.0, f64::max);
        let duration = recordings.iter().map(|r| r.duration()).fold(0.0, f64::max);
        let speed = recordings.iter().map(|r| r.top_speed()).fold(0.0, f64::max);
        let span = |r: &Recording, i: usize| {
            let angles = || r.alpha().iter().map(|a| a[i]);
            angles().fold(f64::MIN, f64::max) - angles().fold(f64::MAX, f64::min)
        };
        let spans = recordings.iter().flat_map(|r| [span(r, 0), span(r, 1)]);
        let angle = spans.fold(0.0, f64::max);
        Self { moment: largest, step, duration, speed, angle }
    }

    /// Parameters of the effect at every shape that is tried; linear ones are zero.
    pub(super) fn shapes(&self, id: &str, specs: &[ParameterSpec]) -> Vec<Vec<f64>> {
        let at = |values: &[f64]| {
            let mut values = values.iter();
            let one = |s: &ParameterSpec| match s.kind {
                ParameterKind::Shape => values.next().copied().unwrap_or(s.typical),
                ParameterKind::Linear => 0.0,
            };
            specs.iter().map(one).collect::<Vec<f64>>()
        };
        let Some(first) = specs.iter().find(|s| s.kind == ParameterKind::Shape) else {
            return if self.goes_round(id, f64::NAN) { vec![at(&[])] } else { vec![] };
        };
        let seconds: &[f64] = match id {
            "compliance" => &[0.01, 0.1],
            _ => &[],
        };
        let mut out = Vec::new();
        for value in shape_values(id, first.typical, self) {
            if value < first.range.0 || value > first.range.1 || !self.goes_round(id, value) {
                continue;
            }
            if seconds.is_empty() {
                out.push(at(&[value]));
            }
            out.extend(seconds.iter().map(|second| at(&[value, *second])));
        }
        out
    }

    /// A wave of which less than a period was driven is an offset in disguise.
    fn goes_round(&self, id: &str, value: f64) -> bool {
        match id {
            "torque_ripple" => value * self.angle >= std::f64::consts::TAU,
            "wheel_eccentricity" => self.angle >= std::f64::consts::TAU,
            _ => true,
        }
    }
}

/// Grid of the shape parameter of an effect.
fn shape_values(id: &str, typical: f64, scale: &Scale) -> Vec<f64> {
    match id {
        "stribeck" => [0.15, 0.3, 0.6, 1.2, 2.4].map(|w| w * scale.speed / AMIGOBOT_SPEED).to_vec(),
        "friction_warmup" => {
            [2.0, 5.0, 10.0, 20.0, 40.0].into_iter().filter(|t| *t < 2.0 * scale.duration).collect()
        }
        "torque_saturation" => [0.5, 0.65, 0.8, 0.9].map(|s| s * scale.moment).to_vec(),
        "backlash_deadzone" => [0.02, 0.05, 0.1].map(|s| s * scale.moment).to_vec(),
        "actuator_lag" | "actuator_delay" => vec![scale.step],
        "torque_ripple" => (2..=16).map(f64::from).collect(),
        "wheel_slip" => [0.03, 0.07, 0.15, 0.3, 0.6].to_vec(),
        "compliance" => [0.5, 1.0, 2.0, 4.0, 8.0, 16.0].to_vec(),
        _ if crate::effects::find(id).is_some() => vec![typical],
        // of a formula nothing is known but where the user looks for its shape
        _ => [0.25, 0.5, 1.0, 2.0, 4.0].map(|s| s * typical).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn a_wave_of_less_than_a_turn_is_not_tried() {
        let shapes = |id: &str, angle: f64| {
            let (moment, step, duration, speed) = (0.3, 0.01, 25.0, 12.0);
            let scale = Scale { moment, step, duration, speed, angle };
            scale.shapes(id, &find(id).unwrap().parameters()).len()
        };
        assert_eq!((shapes("wheel_eccentricity", 6.0), shapes("wheel_eccentricity", 6.5)), (0, 1));
        // orders 2 to 16; one radian holds a whole wave of the orders from 7 on
        assert_eq!((shapes("torque_ripple", 6.5), shapes("torque_ripple", 1.0)), (15, 10));
        assert_eq!(shapes("viscous_friction", 0.1), 1);
    }
}
