//! The formulas of a model, recorded from its effects.

use crate::effects::{BodyState, Change, Coupling, Effect, Motion, Terms};
use crate::math::{Formula, Symbol, record};
use crate::model::{Model, cramer};

/// Inputs of [`Traced::terms`] before the parameters: t, alpha1, alpha2, omega1, omega2, and for a second
/// body its speeds u1, u2 and twists phi1, phi2.
pub(super) const MOTION: usize = 9;
/// Inputs of [`Traced::input`] before the parameters: M1, M2 of the previous and of the present sample.
pub(super) const TORQUES: usize = 4;
/// Values of the state at which formulas are recorded; arbitrary, because only formulas without branches are
/// accepted.
const PLACE: [f64; MOTION] = [0.7, 0.3, -0.4, 1.1, -0.6, 0.9, -0.5, 0.02, -0.03];
const RECORDED: [f64; TORQUES] = [0.11, -0.07, 0.13, -0.09];

/// Why a model is not a function of the present state.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Obstacle {
    /// Id of the effect.
    pub effect: String,
    /// Why it is none.
    pub reason: String,
}

/// The formulas of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// From (t, alpha1, alpha2, omega1, omega2, u1, u2, phi1, phi2, parameters) to the mass matrix (m11, m12,
    /// m22), the resisting torque on each wheel and the four levels of dry friction. In a two-mass drivetrain
    /// the mass is that of the rotors, and the torque transmitted to the body is a resisting torque.
    pub terms: Formula,
    /// From the same inputs to the rates (du1, du2, dphi1, dphi2) of the second body [rad/s^2, rad/s]; empty
    /// without one.
    pub body: Formula,
    /// From the same inputs to the fastest rate of the coupling [1/s]; zero without one.
    pub fastest: Formula,
    /// From (M1, M2 of the previous sample, M1, M2, parameters) to the torques before lag and delay.
    pub input: Formula,
    /// From the same inputs, with M after lag and delay, to the acting torques.
    pub behind: Formula,
    /// Number of the parameter that is the time constant of a first-order lag, if there is one.
    pub lag: Option<usize>,
    /// Number of the parameter that is a pure delay, if there is one.
    pub delay: Option<usize>,
}

/// Records the formulas of a model; `p` are the values of its parameters.
///
/// # Errors
/// Every effect that is neither a function of the present state nor a lag or delay of the input: it depends
/// on earlier torques in another way, or branches on a value.
///
/// # Examples
/// ```
/// use amigo_ident::{export::trace, model::Model, robot::Robot};
/// let model = Model::with_effects(Robot::amigobot(), &["slope"]).unwrap();
/// let p = model.initial();
/// let traced = trace(&model, &p).unwrap();
/// let (wheels, rigid) = ([0.0, 0.1, 0.2, 3.0, 2.0], [0.0; 4]);
/// let inputs = [&wheels[..], &rigid, &p].concat();
/// assert_eq!(traced.terms.evaluate(&inputs)[0], p[0]); // m11 = a1
/// assert!(traced.body.outputs.is_empty());
/// let slip = model.add("wheel_slip").unwrap();
/// let traced = trace(&slip, &slip.initial()).unwrap();
/// assert_eq!(traced.body.outputs.len(), 4); // rates of u1, u2, phi1, phi2
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
    // a delay commutes with a lag and with what changes the input at one instant, so that only the place of the lag
    // counts
    let place = lag.or(delay).unwrap_or(every.len());
    let others = |e: &usize| Some(*e) != lag && Some(*e) != delay;
    let (before, behind): (Vec<usize>, Vec<usize>) =
        every.iter().copied().filter(others).partition(|e| *e < place);
    let parameter = |e: usize| model.slots(e).start;
    Ok(Traced {
        terms: formula(model, p, |x| numbers(&x.separated().wheel)),
        body: formula(model, p, |x| x.separated().body.map_or(vec![], |b| b.rates.to_vec())),
        fastest: formula(model, p, |x| vec![x.separated().body.map_or(0.0.into(), |b| b.fastest)]),
        input: input(model, &before, p),
        behind: input(model, &behind, p),
        lag: lag.map(parameter),
        delay: delay.map(parameter),
    })
}

/// How an input effect depends on earlier torques.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Memory {
    Lag,
    Delay,
}

/// Whether effect number `e` is a lag or a delay whose only parameter is its time, from its response to a
/// ramp and a step.
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
        effect.input(&t, &t.iter().map(|&t| [of(t); 2]).collect::<Vec<_>>(), own)
    };
    let (ramp, rise) = (answer(&|t| t)?, answer(&|t| f64::from(u8::from(t > 0.0)))?);
    // after twenty time constants a lag follows a ramp with a delay equal to its time constant, to 2e-9
    if (t[1000] - ramp[1000][0] - time).abs() > 1e-6 * step.max(time) {
        return None;
    }
    // half a time constant after a step the output of a lag has begun to rise, that of a delay has not
    Some(if rise[25][0] > 0.1 { Memory::Lag } else { Memory::Delay })
}

/// Why effect number `e` cannot be exported, if it cannot.
fn obstacle(model: &Model, e: usize, p: &[f64]) -> Option<&'static str> {
    let terms = formula(model, p, |x| {
        let coupling = x.coupling(e).map(|c| vec![c.rotor, c.stiffness, c.damping]);
        [numbers(&x.sum([e], &x.motion)), coupling.unwrap_or_default()].concat()
    });
    let input = input(model, &[e], p);
    if memory(model, e, p).is_some() {
        return None;
    }
    if input.depends_on(0) || input.depends_on(1) {
        return Some("the torque that acts depends on earlier torques, and by no lag or delay");
    }
    if terms.read || input.read {
        return Some("its equation branches on a value");
    }
    None
}

/// A model at an instant with symbolic state and parameters.
struct Place<'a> {
    model: &'a Model,
    motion: Motion<'a, Symbol>,
    body: BodyState<Symbol>,
    p: &'a [Symbol],
}

/// Terms on the wheels, and rates of a second body.
struct Separated {
    wheel: Terms<Symbol>,
    body: Option<Body>,
}

/// A second body at one instant.
struct Body {
    /// Rates of its speeds and twists.
    rates: [Symbol; 4],
    /// The fastest rate of the coupling.
    fastest: Symbol,
}

impl Place<'_> {
    fn coupling(&self, e: usize) -> Option<Coupling<Symbol>> {
        let own = &self.p[self.model.slots(e)];
        self.model.effects()[e].coupling_symbolic(&self.motion, own)
    }

    fn every(&self) -> std::ops::Range<usize> {
        0..self.model.effects().len()
    }

    fn sum(&self, effects: impl IntoIterator<Item = usize>, x: &Motion<Symbol>) -> Terms<Symbol> {
        let mut sum = Terms::zero();
        for e in effects {
            sum.add(&self.model.effects()[e].terms_symbolic(x, &self.p[self.model.slots(e)]));
        }
        sum
    }

    /// The equations of the simulation: of the robot as a whole, or of wheels and second body.
    fn separated(&self) -> Separated {
        let Some(coupling) = self.every().find_map(|e| self.coupling(e)) else {
            return Separated { wheel: self.sum(self.every(), &self.motion), body: None };
        };
        let (on_body, on_wheel): (Vec<usize>, Vec<usize>) =
            self.every().partition(|&e| self.model.effects()[e].energy().of_the_body());
        let mut wheel = self.sum(on_wheel, &self.motion);
        let mut body = self.sum(on_body, &self.motion.of_body(&self.body));
        let fastest = coupling.fastest_rate(&body.mass);
        coupling.separate(&mut wheel, &mut body);
        let passed = coupling.passed(&self.motion.omega, &self.body);
        let [d1, d2] = cramer(&body.mass, &[0, 1].map(|i| passed[i] - body.torque[i]));
        let [r1, r2] = [0, 1].map(|i| self.motion.omega[i] - self.body.speed[i]);
        wheel.torque = [0, 1].map(|i| wheel.torque[i] + passed[i]);
        Separated { wheel, body: Some(Body { rates: [d1, d2, r1, r2], fastest }) }
    }
}

fn numbers(terms: &Terms<Symbol>) -> Vec<Symbol> {
    [&terms.mass[..], &terms.torque, &terms.level].concat()
}

/// Records a formula at the given instant.
fn formula(model: &Model, p: &[f64], f: impl Fn(&Place) -> Vec<Symbol>) -> Formula {
    record(&[&PLACE, p].concat(), |x| {
        let (place, p) = x.split_at(MOTION);
        let [t, alpha1, alpha2, omega1, omega2, u1, u2, phi1, phi2]: [Symbol; MOTION] =
            std::array::from_fn(|k| place[k]);
        let motion = Motion::at(t, [alpha1, alpha2], [omega1, omega2], model.robot());
        let body = BodyState { speed: [u1, u2], twist: [phi1, phi2] };
        f(&Place { model, motion, body, p })
    })
}

/// Two samples are given, so that a dependence on the first is visible in the second.
fn input(model: &Model, effects: &[usize], p: &[f64]) -> Formula {
    record(&[&RECORDED, p].concat(), |x| {
        let (m, p) = x.split_at(TORQUES);
        let mut m: Vec<[Symbol; 2]> = vec![[m[0], m[1]], [m[2], m[3]]];
        for &e in effects {
            let effect: &dyn Effect = &*model.effects()[e];
            if let Some(changed) = effect.input_symbolic(&[0.0, 0.01], &m, &p[model.slots(e)]) {
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

    /// Instant number k for tests, far from the others.
    fn place(k: u32) -> [f64; MOTION] {
        let at = |i: usize| 7.0 * (1.7 * f64::from(k) + 2.3 * i as f64).sin();
        let mut place = std::array::from_fn(at);
        place[0] = at(0).abs();
        place
    }

    fn motion(
        model: &Model,
        [t, alpha1, alpha2, omega1, omega2, ..]: [f64; MOTION],
    ) -> Motion<'_, f64> {
        let (alpha, omega) = ([alpha1, alpha2], [omega1, omega2]);
        Motion::at(t, alpha, omega, model.robot())
    }

    #[test]
    fn the_recorded_formulas_give_the_bits_of_the_effects_wherever_they_are_evaluated() {
        let mut count = 0;
        for effect in all() {
            let base = Model::base(Robot::amigobot());
            let model = base.add(&effect.id()).unwrap_or(base);
            let p = model.initial();
            if model.is_coupled() {
                continue;
            }
            let traced = trace(&model, &p).unwrap();
            count += 1;
            for k in 0..40 {
                let place = place(k);
                let terms = model.terms(&motion(&model, place), &p);
                let expected = [&terms.mass[..], &terms.torque, &terms.level].concat();
                let found = traced.terms.evaluate(&[&place[..], &p].concat());
                assert_eq!(found, expected, "{}", effect.id());
                let m = [0.1 * place[5], 0.1 * place[6]];
                let acting = traced.input.evaluate(&[&[f64::NAN; 2], &m[..], &p].concat());
                assert_eq!(acting, model.input(&[0.0], &[m], &p)[0], "{}", effect.id());
            }
        }
        assert_eq!(count, all().len() - 2); // slip, compliance
    }

    #[test]
    fn a_two_mass_drivetrain_has_the_equations_of_its_documentation() {
        let model = Model::with_effects(Robot::amigobot(), &["compliance", "slope"]).unwrap();
        let p = model.initial();
        let [a1, a2, a3, a4, a5, kt, dt, jr, ..] = p[..] else { panic!("{p:?}") };
        let traced = trace(&model, &p).unwrap();
        let slope = Model::with_effects(Robot::amigobot(), &["slope"]).unwrap();
        let q = [&[0.0; 5], &p[8..]].concat();
        for k in 0..40 {
            let place @ [_, _, _, w1, w2, u1, u2, phi1, phi2] = place(k);
            let inputs = [&place[..], &p].concat();
            let passed = [kt * phi1 + dt * (w1 - u1), kt * phi2 + dt * (w2 - u2)];
            let expected = [jr, 0.0, jr, passed[0], passed[1], a4, a5, 0.0, 0.0];
            let near = |found: &[f64], expected: &[f64]| {
                for (x, y) in found.iter().zip(expected) {
                    assert!((x - y).abs() < 1e-12 * (1.0 + y.abs()), "{found:?} {expected:?}");
                }
            };
            near(&traced.terms.evaluate(&inputs), &expected);
            // (a1 - jr) du1 + a2 du2 + a3 u2 (u2 - u1) + weight = passed torque, at the angles behind the twists
            let [d1, d2, r1, r2] = traced.body.evaluate(&inputs)[..] else { panic!() };
            let mut behind = motion(&slope, place);
            (behind.alpha[0], behind.alpha[1]) = (behind.alpha[0] - phi1, behind.alpha[1] - phi2);
            let weight = slope.terms(&behind, &q).torque;
            near(&[r1, r2], &[w1 - u1, w2 - u2]);
            let left = [
                (a1 - jr) * d1 + a2 * d2 + a3 * u2 * (u2 - u1) + weight[0],
                a2 * d1 + (a1 - jr) * d2 + a3 * u1 * (u1 - u2) + weight[1],
            ];
            near(&left, &passed);
            let lighter = a1 - a2.abs() - jr;
            let mobility = 1.0 / jr + 1.0 / lighter;
            let rate = (dt * mobility).max((kt * mobility).sqrt());
            near(&traced.fastest.evaluate(&inputs), &[rate]);
        }
    }

    #[test]
    fn a_lag_and_a_delay_are_recognised_by_what_they_do() {
        let robot = Robot::amigobot();
        let ids = ["torque_saturation", "actuator_lag", "actuator_delay"];
        let model = Model::with_effects(robot.clone(), &ids).unwrap();
        let traced = trace(&model, &model.initial()).unwrap();
        let index = |symbol: &str| model.index_of(symbol).ok();
        assert_eq!((traced.lag, traced.delay), (index("tau"), index("delay")));
        let limited = |ids: &[&str]| {
            let model = Model::with_effects(robot.clone(), ids).unwrap();
            trace(&model, &model.initial()).map(|traced| {
                let clipped = |formula: &Formula| {
                    let m = [&[0.0, 0.0, 1e3, -1e3], &model.initial()[..]].concat();
                    formula.evaluate(&m)[0] < 1e3
                };
                (clipped(&traced.input), clipped(&traced.behind))
            })
        };
        let (lag, limit, delay) = ("actuator_lag", "torque_saturation", "actuator_delay");
        assert_eq!(limited(&[limit, lag, delay]), Ok((true, false)));
        assert_eq!(limited(&[lag, delay, limit]), Ok((false, true)));
        assert_eq!(limited(&[lag, limit]), Ok((false, true)));
        // the delay commutes with the limit, the lag does not
        assert_eq!(limited(&[lag, limit, delay]), Ok((false, true)));
        assert_eq!(limited(&[delay, limit, lag]), Ok((true, false)));
    }
}
