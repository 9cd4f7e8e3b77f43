//! A fuzzy state emulator as a function in the languages of [`super::files`].

use super::fill::Content;
use super::traced::{MOTION, TORQUES, Traced};
use crate::math::{Formula, Symbol, record};
use crate::recording::DriveUnit;
use crate::simulate::{FuzzyDynamics, Hold};

/// A fuzzy system and its origin.
#[derive(Clone, Copy, Debug)]
pub struct FuzzyIdentified<'a> {
    /// The system.
    pub dynamics: &'a FuzzyDynamics,
    /// Name of the robot.
    pub robot: &'a str,
    /// Unit of the recorded torques.
    pub drive_unit: DriveUnit,
    /// The input between two samples.
    pub hold: Hold,
    /// Name of the experiment.
    pub experiment: &'a str,
    /// The method that fitted it.
    pub method: &'a str,
}

/// Writes a fuzzy system as `model.py`, `model.m`, `model.c`, `model.mo`, `model.js`; names and texts.
///
/// ```text
/// dw - f(w) = G M        eq. (17), in the form of the physical models: mass 1, resisting torque -f, no dry friction
/// ```
/// The rules are recorded from [`TakagiSugeno::output`](crate::simulate::TakagiSugeno::output).
#[must_use]
pub fn fuzzy_files(identified: &FuzzyIdentified) -> Vec<(String, String)> {
    let traced = traced(identified.dynamics);
    let header = header(identified);
    Content { traced: &traced, header, constants: vec![], hold: identified.hold }.files()
}

fn traced(fuzzy: &FuzzyDynamics) -> Traced {
    let gain = &fuzzy.input_gain;
    Traced {
        terms: record(&[0.1; MOTION], |x| {
            let [f1, f2] = fuzzy.system.output(&[x[3], x[4]]);
            let rest = [0.0; 4].map(Symbol::from);
            [&[1.0, 0.0, 1.0].map(Symbol::from), &[-f1, -f2][..], &rest].concat()
        }),
        body: Formula::default(),
        fastest: record(&[0.0; MOTION], |_| vec![0.0.into()]),
        input: record(&[0.1; TORQUES], |m| {
            [0, 1].map(|i| m[2] * gain[i][0] + m[3] * gain[i][1]).to_vec()
        }),
        behind: record(&[0.1; TORQUES], |m| m[2..].to_vec()),
        lag: None,
        delay: None,
    }
}

fn header(it: &FuzzyIdentified) -> Vec<String> {
    let system = &it.dynamics.system;
    let [(low1, high1), (low2, high2)] = system.range();
    let version = env!("CARGO_PKG_VERSION");
    vec![
        format!("Fuzzy Takagi-Sugeno emulator of the robot \"{}\".", it.robot),
        format!(
            "Experiment {}, method {}, {} {version}.",
            it.experiment,
            it.method,
            env!("CARGO_PKG_NAME")
        ),
        String::new(),
        "    dw = f(w) + G M".into(),
        String::new(),
        format!("f: {} rules over w1 in {low1} to {high1} rad/s and w2 in {low2} to {high2} rad/s; beyond", system.rules()),
        "these ranges the value at the edge. Outside the training data, f is".into(),
        "extrapolated. Wheel 1 is the right one; alpha [rad], w = omega [rad/s], M recorded torques".into(),
        format!("[{}]. The mass is 1, the torque -f, and there is no dry friction: the friction", it.drive_unit.symbol()),
        "at rest is approximated by the rules. The integrator is Runge-Kutta 4 at a fixed step".into(),
        "of at most 1 ms.".into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{Consequents, Defuzzification, Structure, TakagiSugeno};

    #[test]
    fn the_recorded_rules_are_those_of_the_system_and_read_no_value() {
        for consequents in [Consequents::Constant, Consequents::Affine] {
            let ranges = [(0.0, 20.0), (-5.0, 15.0)];
            let mut system =
                TakagiSugeno::uniform(4, ranges, consequents, Defuzzification::WeightedAverage);
            let count = system.parameters().len();
            let values: Vec<f64> = (0..count).map(|k| (1.3 * k as f64).sin()).collect();
            system.set_parameters(&values);
            let gain = [[30.0, 2.0], [3.0, 28.0]];
            let fuzzy = FuzzyDynamics::new(system, gain, 1.0, Structure::Parallel, &[]);
            let traced = traced(&fuzzy);
            assert!(!traced.terms.read && !traced.input.read);
            for w in [[3.0, 7.0], [-4.0, 30.0], [19.0, -5.0]] {
                let mut place = [0.0; MOTION];
                place[3..5].copy_from_slice(&w);
                let (found, [f1, f2]) = (traced.terms.evaluate(&place), fuzzy.system.output(&w));
                assert_eq!(found[..3], [1.0, 0.0, 1.0]);
                // the other implementation sums in a different order
                assert!((found[3] + f1).abs() < 1e-12 && (found[4] + f2).abs() < 1e-12);
            }
            let acting = traced.input.evaluate(&[0.0, 0.0, 0.2, -0.1]);
            assert!((acting[0] - 5.8).abs() < 1e-12 && (acting[1] + 2.2).abs() < 1e-12);
        }
    }
}
