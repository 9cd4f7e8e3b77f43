//! The formulas of a model, recorded from its effects.

use crate::effects::{Change, Effect, Motion, Terms};
use crate::math::{Formula, Symbol, record};
use crate::model::Model;

/// Inputs of [`Traced::terms`] before the parameters: t, alpha1, alpha2, omega1, omega2.
pub(super) const MOTION: usize = 5;
/// Inputs of [`Traced::drive`] before the parameters: M1, M2 of the sample before and of this one.
pub(super) const MOMENTS: usize = 4;
/// The place of recording; any would do, since only formulas without branches are taken.
const PLACE: [f64; MOTION] = [0.7, 0.3, -0.4, 1.1, -0.6];
const RECORDED: [f64; MOMENTS] = [0.11, -0.07, 0.13, -0.09];

/// Why a model cannot be written as a function of the present instant.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Obstacle {
    /// The effect.
    pub effect: String,
    /// Why.
    pub reason: String,
}

/// The formulas of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// From (t, alpha1, alpha2, omega1, omega2, parameters) to the mass matrix (m11, m12, m22),
    /// the resisting torque on each wheel and the four levels of dry friction.
    pub terms: Formula,
    /// From (M1, M2 of the sample before, M1, M2, parameters) to the torques that act, before lag and delay.
    pub drive: Formula,
    /// Number of the parameter that is the time constant of a first-order lag, if there is one.
    pub lag: Option<usize>,
    /// Number of the parameter that is a pure delay, if there is one.
    pub delay: Option<usize>,
}

/// Records the formulas of a model; `p` are the values of its parameters.
///
/// # Errors
/// Every effect that is neither a formula of the present instant nor a lag or delay of the input: states of
/// its own (wheel slip, compliance), another memory of earlier torques, or a branch on a value.
///
/// # Examples
/// ```
/// use amigo_ident::{export::trace, model::Model, robot::Robot};
/// let model = Model::with_effects(Robot::amigobot(), &["slope"]).unwrap();
/// let p = model.initial();
/// let traced = trace(&model, &p).unwrap();
/// let inputs = [&[0.0, 0.1, 0.2, 3.0, 2.0], &p[..]].concat();
/// assert_eq!(traced.terms.evaluate(&inputs)[0], p[0]); // m11 = a1
/// let slip = model.add("wheel_slip").unwrap();
/// assert_eq!(trace(&slip, &slip.initial()).unwrap_err()[0].effect, "wheel_slip");
/// ```
pub fn trace(model: &Model, p: &[f64]) -> Result<Traced, Vec<Obstacle>> {
    let obstacles: Vec<Obstacle> = (0..model.effects().len())
        .filter_map(|e| {
            let reason = obstacle(model, e, p)?;
            Some(Obstacle { effect: model.effects()[e].id(), reason: reason.into() })
        })
        .collect();
    if !obstacles.is_empty() {
        return Err(obstacles);
    }
    let every: Vec<usize> = (0..model.effects().len()).collect();
    let memory = |kind: Memory| every.iter().copied().find(|&e| memory(model, e, p) == Some(kind));
    let (lag, delay) = (memory(Memory::Lag), memory(Memory::Delay));
    let instant: Vec<usize> =
        every.iter().copied().filter(|&e| Some(e) != lag && Some(e) != delay).collect();
    let parameter = |e: usize| model.slots(e).start;
    Ok(Traced {
        terms: terms(model, &every, p),
        drive: drive(model, &instant, p),
        lag: lag.map(parameter),
        delay: delay.map(parameter),
    })
}

/// How an input effect remembers earlier torques.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Memory {
    Lag,
    Delay,
}

/// Whether effect number `e` is a lag or a delay whose one parameter is its time, by its answer to a ramp and
/// a step.
fn memory(model: &Model, e: usize, p: &[f64]) -> Option<Memory> {
    let effect = &model.effects()[e];
    let own = &p[model.slots(e)];
    let [time] = *own else { return None };
    if effect.change() != Change::TimeShift || !(time >= 0.0) {
        return None;
    }
    let step = time.max(1e-6) / 50.0;
    let t: Vec<f64> = (0..=1000).map(|k| step * f64::from(k)).collect();
    let answer = |of: &dyn Fn(f64) -> f64| -> Option<Vec<[f64; 2]>> {
        effect.drive(&t, &t.iter().map(|&t| [of(t); 2]).collect::<Vec<_>>(), own)
    };
    let (ramp, rise) = (answer(&|t| t)?, answer(&|t| f64::from(u8::from(t > 0.0)))?);
    // after twenty time constants a lag follows a ramp late by its time, to 2e-9
    if (t[1000] - ramp[1000][0] - time).abs() > 1e-6 * step.max(time) {
        return None;
    }
    // half a time constant after a step a lag has begun to rise, and a delay has not
    Some(if rise[25][0] > 0.1 { Memory::Lag } else { Memory::Delay })
}

/// Whether an input effect that is no lag or delay stands behind one.
fn behind_memory(model: &Model, e: usize, p: &[f64]) -> bool {
    let effect = &model.effects()[e];
    effect.acts_on_drive() && (0..e).any(|before| memory(model, before, p).is_some())
}

/// Why effect number `e` cannot be written, if so.
fn obstacle(model: &Model, e: usize, p: &[f64]) -> Option<&'static str> {
    let effect = &model.effects()[e];
    let x = motion(model, PLACE);
    if effect.coupling(&x, &p[model.slots(e)]).is_some() {
        return Some("it puts a body with states of its own behind the wheels");
    }
    let (terms, drive) = (terms(model, &[e], p), drive(model, &[e], p));
    if memory(model, e, p).is_some() {
        return None;
    }
    if drive.depends_on(0) || drive.depends_on(1) {
        return Some("the torque that acts depends on earlier torques, and by no lag or delay");
    }
    if behind_memory(model, e, p) {
        return Some(
            "it acts on the input behind a lag or a delay; put it before that in the list of effects",
        );
    }
    if terms.read || drive.read {
        return Some("its equation branches on a value");
    }
    None
}

fn motion<T: Copy>(model: &Model, x: [T; MOTION]) -> Motion<'_, T> {
    let [t, alpha1, alpha2, omega1, omega2] = x;
    Motion {
        t,
        alpha: [alpha1, alpha2],
        omega: [omega1, omega2],
        variance: [0.0; 4],
        robot: model.robot(),
    }
}

fn terms(model: &Model, effects: &[usize], p: &[f64]) -> Formula {
    record(&[&PLACE, p].concat(), |x| {
        let (place, p) = x.split_at(MOTION);
        let place = motion(model, std::array::from_fn(|k| place[k]));
        let mut sum = Terms::zero();
        for &e in effects {
            sum.add(&model.effects()[e].terms_symbolic(&place, &p[model.slots(e)]));
        }
        [&sum.mass[..], &sum.torque, &sum.level].concat()
    })
}

/// Two samples go in, so that a memory of the first shows in the second.
fn drive(model: &Model, effects: &[usize], p: &[f64]) -> Formula {
    record(&[&RECORDED, p].concat(), |x| {
        let (m, p) = x.split_at(MOMENTS);
        let mut m: Vec<[Symbol; 2]> = vec![[m[0], m[1]], [m[2], m[3]]];
        for &e in effects {
            let effect: &dyn Effect = &*model.effects()[e];
            if let Some(changed) = effect.drive_symbolic(&[0.0, 0.01], &m, &p[model.slots(e)]) {
                m = changed;
            }
        }
        m[1].to_vec()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::all;
    use crate::robot::Robot;

    #[test]
    fn the_recorded_formulas_give_the_bits_of_the_effects_wherever_they_are_evaluated() {
        let mut count = 0;
        for effect in all() {
            let base = Model::base(Robot::amigobot());
            let model = base.add(&effect.id()).unwrap_or(base);
            let p = model.initial();
            let Ok(traced) = trace(&model, &p) else { continue };
            count += 1;
            for k in 0..40 {
                let at = |i: usize| 7.0 * (1.7 * f64::from(k) + 2.3 * i as f64).sin();
                let place = [at(0).abs(), at(1), at(2), at(3), at(4)];
                let terms = model.terms(&motion(&model, place), &p);
                let expected = [&terms.mass[..], &terms.torque, &terms.level].concat();
                let found = traced.terms.evaluate(&[&place[..], &p].concat());
                assert_eq!(found, expected, "{}", effect.id());
                let m = [0.1 * at(5), 0.1 * at(6)];
                let acting = traced.drive.evaluate(&[&[f64::NAN; 2], &m[..], &p].concat());
                assert_eq!(acting, model.drive(&[0.0], &[m], &p)[0], "{}", effect.id());
            }
        }
        assert_eq!(count, all().len() - 2); // slip, compliance
    }

    #[test]
    fn a_lag_and_a_delay_are_known_by_what_they_do() {
        let robot = Robot::amigobot();
        let ids = ["torque_saturation", "actuator_lag", "actuator_delay"];
        let model = Model::with_effects(robot.clone(), &ids).unwrap();
        let traced = trace(&model, &model.initial()).unwrap();
        let index = |symbol: &str| model.index_of(symbol).ok();
        assert_eq!((traced.lag, traced.delay), (index("tau"), index("delay")));
        let behind = Model::with_effects(robot, &["actuator_lag", "torque_saturation"]).unwrap();
        let obstacles = trace(&behind, &behind.initial()).unwrap_err();
        assert_eq!(obstacles[0].effect, "torque_saturation");
    }
}
