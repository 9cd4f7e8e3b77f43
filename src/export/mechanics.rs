//! The part of a model that rigid-body simulators can express: mass, damping, friction, weight, actuators.

use nalgebra::{DMatrix, DVector};

use crate::effects::{Change, Effect, Motion};
use crate::math::pseudo_inverse;
use crate::model::Model;
use crate::robot::Robot;

/// Parameters of a model with the same meaning in any rigid-body simulator, per unit of the input.
///
/// Determined by evaluating the effects, not by their names: an effect is included if its mass and friction
/// levels are constant and its torque is a linear combination of the terms below at every motion tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanics {
    /// Mass matrix of the wheels (m11, m12, m22) [kg m^2].
    pub mass: [f64; 3],
    /// Centrifugal constant a3 [kg m^2].
    pub centrifugal: f64,
    /// Viscous damping as a symmetric matrix (d11, d12, d22) [N m s/rad].
    pub damping: [f64; 3],
    /// Levels of dry friction along wheel 1, wheel 2, turning and forward [N m].
    pub friction: [f64; 4],
    /// Constant torque to be subtracted from the actuators on each wheel [N m].
    pub offset: [f64; 2],
    /// Torque due to weight on each wheel at headings 0 and 90 degrees [N m].
    pub weight: [f64; 2],
    /// Distance behind the axle at which the weight acts, in half tracks.
    pub lever: f64,
    /// Factor between recorded and acting input on each wheel.
    pub gain: [f64; 2],
    /// Largest acting input; infinite without a limit.
    pub limit: f64,
    /// Time constant of a first-order lag of the input \[s\].
    pub lag_s: f64,
    /// Pure delay of the input \[s\].
    pub delay_s: f64,
    /// Effects that are not included, and the reasons.
    pub left_out: Vec<LeftOut>,
}

/// An effect that has no counterpart.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct LeftOut {
    /// Its id.
    pub effect: String,
    /// Why it has none.
    pub reason: &'static str,
}

/// Number of terms: torques of the two wheels at a motion.
const TERMS: usize = 10;

/// Residual of a linear combination, as a share of the largest torque, below which it represents the effect:
/// rounding of a few dozen sums.
const EXACT: f64 = 1e-9;

impl Mechanics {
    /// Mechanics of a model with parameter values `p`; time-dependent effects are evaluated at `t` \[s\].
    #[must_use]
    pub fn of(model: &Model, p: &[f64], t: f64) -> Self {
        let mut out = Self {
            mass: [0.0; 3],
            centrifugal: 0.0,
            damping: [0.0; 3],
            friction: [0.0; 4],
            offset: [0.0; 2],
            weight: [0.0; 2],
            lever: 0.0,
            gain: [1.0; 2],
            limit: f64::INFINITY,
            lag_s: 0.0,
            delay_s: 0.0,
            left_out: vec![],
        };
        for (e, effect) in model.effects().iter().enumerate() {
            let p = &p[model.slots(e)];
            let added = if effect.acts_on_input() {
                out.add_input(&**effect, p)
            } else {
                out.add_terms(&**effect, p, model.robot(), t)
            };
            if let Err(reason) = added {
                out.left_out.push(LeftOut { effect: effect.id(), reason });
            }
        }
        out
    }

    fn add_terms(
        &mut self,
        effect: &dyn Effect,
        p: &[f64],
        robot: &Robot,
        t: f64,
    ) -> Result<(), &'static str> {
        let places = places(robot, t);
        if effect.coupling(&places[0], p).is_some() {
            return Err("it has a second mass; the robot is written as if it were rigid");
        }
        let terms: Vec<_> = places.iter().map(|x| effect.terms(x, p)).collect();
        let close = |a: f64, b: f64| (a - b).abs() <= EXACT * a.abs().max(b.abs());
        let first = &terms[0];
        let constant = terms.iter().all(|other| {
            let mass = first.mass.iter().zip(&other.mass).all(|(a, b)| close(*a, *b));
            mass && first.level.iter().zip(&other.level).all(|(a, b)| close(*a, *b))
        });
        if !constant {
            return Err("its inertia or dry friction varies with the motion");
        }
        let torque: Vec<f64> = terms.iter().flat_map(|term| term.torque).collect();
        let found = combination(&places, &torque)
            .ok_or("its torque is no constant, damping, centrifugal torque or weight")?;
        let weight = [found[6], found[7]];
        let lever = lever(weight, [found[8], found[9]]).ok_or("its torque is that of no weight")?;
        for i in 0..3 {
            self.mass[i] += first.mass[i];
        }
        for j in 0..4 {
            self.friction[j] += first.level[j];
        }
        if weight != [0.0; 2] {
            self.lever = lever;
        }
        for i in 0..2 {
            self.offset[i] += found[i];
            self.weight[i] += weight[i];
        }
        for i in 0..3 {
            self.damping[i] += found[2 + i];
        }
        self.centrifugal += found[5];
        Ok(())
    }

    /// Determines gain, limit, lag and delay from the response of an input effect to a slow ramp and a step.
    fn add_input(&mut self, effect: &dyn Effect, p: &[f64]) -> Result<(), &'static str> {
        let t: Vec<f64> = (0..=STEPS).map(|k| f64::from(k) * STEP).collect();
        let response = |size: f64, of: &dyn Fn(f64) -> f64| {
            let m: Vec<[f64; 2]> = t.iter().map(|&t| [size * of(t); 2]).collect();
            effect.input(&t, &m, p).unwrap_or(m)
        };
        if effect.change() == Change::TimeShift {
            let ramp = response(1.0, &|t| t);
            let late = t[t.len() - 1] - ramp[ramp.len() - 1][0];
            let step = response(1.0, &|t| f64::from(u8::from(t > 0.0)));
            let lag = |t: f64| 1.0 - (-t / late).exp();
            // a step at the first row rises within it, which is a delay of half a row
            let is_lag = late > 0.0
                && t.iter().zip(&step).all(|(t, m)| (m[0] - lag(*t)).abs() < STEP / late);
            return match (is_lag, late >= 0.0) {
                (true, _) => {
                    self.lag_s += late;
                    Ok(())
                }
                (false, true) => {
                    self.delay_s += late;
                    Err("a pure delay of the input; delay the commands by it")
                }
                (false, false) => Err("the input acts before it is recorded"),
            };
        }
        let last = |size: f64| response(size, &|_| 1.0)[STEPS as usize];
        let (small, large) = (last(1e-6), last(1e6));
        let gain = [0, 1].map(|i| small[i] / 1e-6);
        if gain.contains(&0.0) {
            return Err("it has a dead zone");
        }
        let linear = (0..2).all(|i| (large[i] / 1e6 - gain[i]).abs() < EXACT * gain[i].abs());
        let flat = last(1e7) == large && large[0] == large[1];
        match (linear, flat) {
            (true, _) => {
                self.gain = [0, 1].map(|i| self.gain[i] * gain[i]);
                Ok(())
            }
            (false, true) => {
                self.limit = self.limit.min(large[0]);
                Ok(())
            }
            _ => Err("the acting input is no gain, limit, lag or delay of the recorded one"),
        }
    }
}

/// Step \[s\] and length of the test inputs: 2 s, beyond any delay of the catalogue's ranges.
const STEP: f64 = 1e-3;
const STEPS: u32 = 2000;

/// Motions at which the terms are distinguishable: headings all round, both signs of both speeds.
fn places(robot: &Robot, t: f64) -> Vec<Motion<'_, f64>> {
    (0..24)
        .map(|k| {
            let k = f64::from(k);
            let turn = robot.l1() / robot.r() * 0.9 * k;
            let alpha = [0.37 * k + turn, 0.37 * k - turn];
            let omega = [7.0 * (1.3 * k + 0.4).sin(), 6.0 * (2.1 * k + 0.9).cos()];
            Motion { t, alpha, omega, variance: [0.0; 4], robot }
        })
        .collect()
}

/// Distance behind the axle at which a weight acts that causes these driving and turning torques at headings
/// 0 and 90 degrees, in half tracks; `None` if no single distance is consistent with both headings.
fn lever(drives: [f64; 2], turns: [f64; 2]) -> Option<f64> {
    let square = drives[0] * drives[0] + drives[1] * drives[1];
    let lever = (turns[0] * drives[0] + turns[1] * drives[1]) / square.max(f64::MIN_POSITIVE);
    let size = turns[0].abs().max(turns[1].abs());
    let left = |i: usize| (turns[i] - lever * drives[i]).abs() <= EXACT * size;
    (left(0) && left(1)).then_some(lever)
}

/// The coefficients of (offset 1, offset 2, d11, d12, d22, a3, weight driving at 0 and 90 degrees, weight
/// turning at 0 and 90 degrees) that reproduce the torques, or `None`.
fn combination(places: &[Motion<'_, f64>], torque: &[f64]) -> Option<[f64; TERMS]> {
    let size = torque.iter().fold(0.0_f64, |a, m| a.max(m.abs()));
    if size == 0.0 {
        return Some([0.0; TERMS]);
    }
    let columns = DMatrix::from_fn(torque.len(), TERMS, |row, j| at(&places[row / 2], row % 2)[j]);
    let wanted = DVector::from_column_slice(torque);
    let found = pseudo_inverse(&columns, 1e-12)? * &wanted;
    let error = (&columns * &found - wanted).amax();
    // coefficients at the level of rounding are set to zero
    let real = |j: usize| found[j].abs() * columns.column(j).amax() > EXACT * size;
    (error <= EXACT * size).then(|| std::array::from_fn(|j| if real(j) { found[j] } else { 0.0 }))
}

/// The terms for wheel `i` at a motion.
fn at(x: &Motion<f64>, i: usize) -> [f64; TERMS] {
    let [w1, w2] = x.omega;
    let (sin, cos) = x.heading().sin_cos();
    if i == 0 {
        [1.0, 0.0, w1, w2, 0.0, w2 * (w2 - w1), cos, sin, sin, -cos]
    } else {
        [0.0, 1.0, 0.0, w1, w2, w1 * (w1 - w2), cos, sin, -sin, cos]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(effects: &[&str]) -> (Model, Mechanics) {
        let model = Model::with_effects(Robot::amigobot(), effects).unwrap();
        let found = Mechanics::of(&model, &model.initial(), 0.0);
        (model, found)
    }

    #[test]
    fn the_terms_of_effects_are_found_without_their_names() {
        let ids = ["viscous_friction", "turning_scrub", "slope", "torque_offset", "actuator_lag"];
        let (model, found) = of(&ids);
        let p = |symbol: &str| model.initial()[model.index_of(symbol).unwrap()];
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs().max(1e-3), "{a} {b}");
        near(found.mass[0], p("a1"));
        near(found.mass[1], p("a2"));
        near(found.centrifugal, p("a3"));
        near(found.friction[0], p("a4"));
        near(found.weight[0], p("g_c"));
        near(found.weight[1], p("g_s"));
        near(found.lever, p("k_g"));
        assert!(found.friction[2] > 0.0 && found.friction[3] == 0.0);
        assert!(found.damping[0] > 0.0 && found.damping[1].abs() < 1e-12);
        assert!(found.lag_s > 0.0 && found.left_out.is_empty(), "{found:?}");
    }

    #[test]
    fn what_has_no_counterpart_is_named_with_the_reason() {
        for (id, word) in [
            ("stribeck", "varies"),
            ("quadratic_drag", "no constant"),
            ("actuator_delay", "delay"),
            ("backlash_deadzone", "dead zone"),
            ("wheel_slip", "second mass"),
        ] {
            let (_, found) = of(&[id]);
            assert_eq!(found.left_out.len(), 1, "{id}: {found:?}");
            assert_eq!(found.left_out[0].effect, id);
            assert!(found.left_out[0].reason.contains(word), "{found:?}");
        }
        assert!((of(&["torque_saturation"]).1.limit).is_finite());
        assert!(of(&["torque_gain"]).1.gain[0] != 1.0 || of(&["torque_gain"]).1.gain[1] != 1.0);
    }
}
