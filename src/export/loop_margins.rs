//! Stability margins of a speed loop with a dead time.

use std::f64::consts::PI;

/// First-order dynamics of a speed with dead time: `kA dv/dt + kV v = u(t - θ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plant {
    pub(super) ka: f64,
    pub(super) kv: f64,
    pub(super) dead_time: f64,
}

/// Margins of a loop; infinite if it does not reach the gain or phase concerned.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Margins {
    /// Gain margin, as a factor.
    pub gain: f64,
    /// Phase margin \[degrees\].
    pub phase_deg: f64,
    /// Delay margin \[s\].
    pub delay_s: f64,
    /// Crossover frequency (unity gain) [rad/s].
    pub crossover_rad_s: f64,
}

/// Margins of the loop with a controller kp + ki/s.
///
/// ```text
/// L(jω) = (kp + ki/(jω)) e^{-jωθ} / (kA jω + kV)
/// ```
/// The magnitude and, above the crossover, the phase decrease with ω, so each crossing is found by bisection.
pub(super) fn margins(plant: &Plant, kp: f64, ki: f64) -> Margins {
    let size = |w: f64| kp.hypot(ki / w) / (plant.ka * w).hypot(plant.kv);
    let phase = |w: f64| (-ki).atan2(kp * w) - (plant.ka * w).atan2(plant.kv) - w * plant.dead_time;
    let highest = 1e3 / plant.dead_time;
    let lowest = 1e-9 * highest;
    let crossover =
        if size(lowest) > 1.0 { falls_to(&size, 1.0, lowest, highest) } else { f64::NAN };
    if crossover.is_nan() {
        let (gain, phase_deg, delay_s) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        return Margins { gain, phase_deg, delay_s, crossover_rad_s: 0.0 };
    }
    let left = PI + phase(crossover);
    let turn = falls_to(&phase, -PI, crossover, highest);
    Margins {
        gain: 1.0 / size(turn),
        phase_deg: left.to_degrees(),
        delay_s: left / crossover,
        crossover_rad_s: crossover,
    }
}

/// Where a decreasing function reaches a value, between two frequencies.
fn falls_to(f: &impl Fn(f64) -> f64, value: f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low.ln(), high.ln());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle.exp()) > value { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_integrator_with_a_dead_time_has_the_margins_of_the_textbook() {
        // L = k/s e^{-θ s}: ωc = k, phase margin 90° - k θ, gain margin π/(2 k θ)
        let plant = Plant { ka: 1.0, kv: 0.0, dead_time: 0.1 };
        let found = margins(&plant, 5.0, 0.0);
        assert!((found.crossover_rad_s - 5.0).abs() < 1e-9);
        assert!((found.phase_deg - (90.0 - 0.5_f64.to_degrees())).abs() < 1e-9);
        assert!((found.gain - PI / (2.0 * 5.0 * 0.1)).abs() < 1e-9);
        assert!((found.delay_s - (PI / 2.0 - 0.5) / 5.0).abs() < 1e-9);
    }

    #[test]
    fn a_loop_that_never_reaches_unity_gain_has_no_limit() {
        let plant = Plant { ka: 1.0, kv: 2.0, dead_time: 0.1 };
        assert_eq!(margins(&plant, 1.0, 0.0).gain, f64::INFINITY);
    }
}
