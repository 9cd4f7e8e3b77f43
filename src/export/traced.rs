//! The formulas of a model, recorded from its effects.

use crate::effects::{Effect, Motion, Terms};
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
    /// the resisting moment on each wheel and the four levels of dry friction.
    pub terms: Formula,
    /// From (M1, M2 of the sample before, M1, M2, parameters) to the moments that act.
    pub drive: Formula,
}

/// Records the formulas of a model; `p` are the values of its parameters.
///
/// # Errors
/// Every effect that has no formula of the present instant: states of its own (wheel slip,
/// compliance), a memory of earlier moments (lag, delay), or a branch on a value.
///
/// # Examples
/// ```
/// use amigo_ident::{export::trace, model::Model, robot::Robot};
/// let model = Model::with_effects(Robot::amigobot(), &["slope"]).unwrap();
/// let p = model.initial();
/// let traced = trace(&model, &p).unwrap();
/// let inputs = [&[0.0, 0.1, 0.2, 3.0, 2.0], &p[..]].concat();
/// assert_eq!(traced.terms.evaluate(&inputs)[0], p[0]); // m11 = a1
/// let lag = model.add("actuator_lag").unwrap();
/// assert_eq!(trace(&lag, &lag.initial()).unwrap_err()[0].effect, "actuator_lag");
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
    Ok(Traced { terms: terms(model, &every, p), drive: drive(model, &every, p) })
}

/// Why effect number `e` cannot be written, if so.
fn obstacle(model: &Model, e: usize, p: &[f64]) -> Option<&'static str> {
    let effect = &model.effects()[e];
    let x = motion(model, PLACE);
    if effect.coupling(&x, &p[model.slots(e)]).is_some() {
        return Some("it puts a body with states of its own behind the wheels");
    }
    let (terms, drive) = (terms(model, &[e], p), drive(model, &[e], p));
    if drive.depends_on(0) || drive.depends_on(1) {
        return Some("the moment that acts depends on earlier moments (a lag or a delay)");
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
        assert_eq!(count, all().len() - 4); // lag, delay, slip, compliance
    }
}
