//! A model: a robot, the effects it is made of, and their parameters.

use std::ops::Range;
use std::sync::Arc;

use super::Variations;
use super::base::{A1, A2, A3};
use crate::catalogue::nearest;
use crate::effects::{self, BASE, Change, Effect, Motion, ParameterKind, ParameterSpec, Terms};
use crate::robot::{BaseParameters, Robot};

/// Why effects cannot be combined into a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// No such effect in the catalogue.
    #[error("no effect is called `{id}`{}; `experiment effects` lists them", hint(near))]
    UnknownEffect {
        /// As written.
        id: String,
        /// The closest id.
        near: Option<String>,
    },
    /// The effect is in the model already.
    #[error("the effect `{id}` is in the model twice; remove one")]
    Repeated {
        /// As written, the second time.
        id: String,
    },
    /// Two effects that each add a second mass to the drivetrain.
    #[error(
        "the model already has a two-mass drivetrain by `{present}`, and `{added}` would add a second one. \
         A model can contain only one; remove one of the two"
    )]
    TwoCouplings {
        /// The effect in the model.
        present: String,
        /// The effect to be added.
        added: String,
    },
    /// No such parameter.
    #[error("the model has no parameter `{symbol}`; it has {known}")]
    UnknownParameter {
        /// As written.
        symbol: String,
        /// All symbols.
        known: String,
    },
    /// The mass matrix cannot be inverted.
    #[error(
        "the mass matrix is not positive definite (m11 = {m11:.3e}, m12 = {m12:.3e}, m22 = {m22:.3e}); a1 must exceed |a2|"
    )]
    MassNotPositive {
        /// Entry.
        m11: f64,
        /// Entry.
        m12: f64,
        /// Entry.
        m22: f64,
    },
}

fn hint(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}

/// One parameter of a model.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Id of the effect it belongs to.
    pub effect: String,
    /// Symbol, meaning, unit, range.
    pub spec: ParameterSpec,
    /// Value at which the parameter is fixed; `None` if it is estimated.
    pub fixed: Option<f64>,
    /// Initial value for estimation, if not the typical value.
    #[serde(skip)]
    pub start: Option<f64>,
}

/// A robot and the effects that act on it. Parameter vectors `p` contain one value per parameter, in the
/// order of [`Model::parameters`], base parameters first (a1..a5).
#[derive(Clone)]
pub struct Model {
    robot: Robot,
    effects: Vec<Arc<dyn Effect>>,
    slots: Vec<Range<usize>>,
    variations: Vec<Variations>,
    parameters: Vec<Parameter>,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Model").field("effects", &self.effect_ids()).finish_non_exhaustive()
    }
}

impl Model {
    /// The paper's model, eq. (14): inertia, centrifugal torques, Coulomb friction.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::{model::Model, robot::Robot};
    /// let model = Model::base(Robot::amigobot());
    /// assert_eq!(model.symbols(), ["a1", "a2", "a3", "a4", "a5"]);
    /// ```
    #[must_use]
    pub fn base(robot: Robot) -> Self {
        let mut model = Self::empty(robot);
        for id in BASE {
            model.push(effects::find(id).expect("the base effects are registered").into());
        }
        model
    }

    fn empty(robot: Robot) -> Self {
        Self { robot, effects: vec![], slots: vec![], variations: vec![], parameters: vec![] }
    }

    /// The base model with effects of the catalogue added.
    ///
    /// # Errors
    /// Unknown or repeated ids.
    pub fn with_effects<S: AsRef<str>>(robot: Robot, ids: &[S]) -> Result<Self, ModelError> {
        ids.iter().try_fold(Self::base(robot), |model, id| model.add(id.as_ref()))
    }

    /// This model with one more effect of the catalogue.
    ///
    /// # Errors
    /// Unknown or repeated ids.
    pub fn add(&self, id: &str) -> Result<Self, ModelError> {
        let effect = effects::find(id).ok_or_else(|| {
            let ids: Vec<String> = effects::all().iter().map(|e| e.id()).collect();
            let near = nearest(id, ids.iter().map(String::as_str)).map(str::to_owned);
            ModelError::UnknownEffect { id: id.into(), near }
        })?;
        self.add_effect(effect.into())
    }

    /// This model with one more effect, registered or custom.
    ///
    /// # Errors
    /// The model already contains an effect with this id, or two effects with a second mass: the state of
    /// simulator and filter allows only one.
    pub fn add_effect(&self, effect: Arc<dyn Effect>) -> Result<Self, ModelError> {
        if self.effects.iter().any(|present| present.id() == effect.id()) {
            return Err(ModelError::Repeated { id: effect.id() });
        }
        let mut model = self.clone();
        model.push(effect);
        match model.couplings().as_slice() {
            [present, added, ..] => {
                let id = |e: usize| model.effects[e].id();
                Err(ModelError::TwoCouplings { present: id(*present), added: id(*added) })
            }
            _ => Ok(model),
        }
    }

    fn push(&mut self, effect: Arc<dyn Effect>) {
        let start = self.parameters.len();
        let id = effect.id();
        let specs = effect.parameters().into_iter();
        self.parameters.extend(specs.map(|spec| Parameter {
            effect: id.clone(),
            spec,
            fixed: None,
            start: None,
        }));
        self.slots.push(start..self.parameters.len());
        self.variations.push(Variations::of(&*effect, &self.robot));
        self.effects.push(effect);
    }

    /// This model without effect number `e`; fixed parameters stay fixed.
    #[must_use]
    pub fn without(&self, e: usize) -> Self {
        let mut model = Self::empty(self.robot.clone());
        for (k, effect) in self.effects.iter().enumerate().filter(|(k, _)| *k != e) {
            let start = model.parameters.len();
            model.push(effect.clone());
            for (new, old) in (start..).zip(self.slots(k)) {
                let Parameter { fixed, start, .. } = self.parameters[old];
                (model.parameters[new].fixed, model.parameters[new].start) = (fixed, start);
            }
        }
        model
    }

    /// This model with a fixed parameter.
    ///
    /// # Errors
    /// Unknown symbols.
    pub fn fix(&self, symbol: &str, value: f64) -> Result<Self, ModelError> {
        let index = self.index_of(symbol)?;
        let mut model = self.clone();
        model.parameters[index].fixed = Some(value);
        Ok(model)
    }

    /// This model with parameter number `j` estimated, not fixed.
    #[must_use]
    pub fn estimating(&self, j: usize) -> Self {
        let mut model = self.clone();
        model.parameters[j].fixed = None;
        model
    }

    /// This model with an initial value for parameter number `j`.
    #[must_use]
    pub fn starting_at(&self, j: usize, value: f64) -> Self {
        let mut model = self.clone();
        model.parameters[j].start = Some(value);
        model
    }

    /// This model with a1..a3 of `p` as the inertias that effects take from the robot ([`Robot::estimated`]).
    #[must_use]
    pub fn with_inertia_of(&self, p: &[f64]) -> Self {
        let mut model = self.clone();
        let known = self.robot.construction.parameters();
        model.robot.estimated = Some(BaseParameters { a1: p[A1], a2: p[A2], a3: p[A3], ..known });
        model
    }

    /// The index of a parameter in `p`.
    ///
    /// # Errors
    /// Unknown symbols.
    pub fn index_of(&self, symbol: &str) -> Result<usize, ModelError> {
        self.parameters.iter().position(|p| p.spec.symbol == symbol).ok_or_else(|| {
            ModelError::UnknownParameter { symbol: symbol.into(), known: self.symbols().join(", ") }
        })
    }

    /// The robot whose geometry and construction data the effects use.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }
    /// The effects, base first.
    #[must_use]
    pub fn effects(&self) -> &[Arc<dyn Effect>] {
        &self.effects
    }
    /// The indices in `p` of the parameters of effect number `e`.
    #[must_use]
    pub fn slots(&self, e: usize) -> Range<usize> {
        self.slots[e].clone()
    }
    /// Which terms of effect number `e` vary, and with what.
    #[must_use]
    pub fn variations(&self, e: usize) -> Variations {
        self.variations[e]
    }
    /// Ids of the effects, base first.
    #[must_use]
    pub fn effect_ids(&self) -> Vec<String> {
        self.effects.iter().map(|e| e.id()).collect()
    }
    /// Ids of the effects beyond the base.
    #[must_use]
    pub fn added_ids(&self) -> Vec<String> {
        self.effect_ids().split_off(BASE.len())
    }
    /// All parameters, in the order of `p`.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    /// All symbols, in the order of `p`.
    #[must_use]
    pub fn symbols(&self) -> Vec<String> {
        self.parameters.iter().map(|p| p.spec.symbol.clone()).collect()
    }
    /// Indices in `p` of the parameters that are estimated by descent; integers are chosen beforehand.
    #[must_use]
    pub fn free(&self) -> Vec<usize> {
        let free =
            |&j: &usize| self.parameters[j].fixed.is_none() && !self.parameters[j].spec.whole;
        (0..self.parameters.len()).filter(free).collect()
    }
    /// Indices in `p` of the estimated parameters that enter linearly, through terms (not through the input).
    #[must_use]
    pub fn linear(&self) -> Vec<usize> {
        let of_input: Vec<bool> = (0..self.effects.len())
            .flat_map(|e| self.slots(e).map(move |_| e))
            .map(|e| self.effects[e].acts_on_input())
            .collect();
        self.free()
            .into_iter()
            .filter(|&j| self.parameters[j].spec.kind == ParameterKind::Linear && !of_input[j])
            .collect()
    }
    /// Initial values: fixed values, given initial values, construction values for a1..a5, typical values for
    /// all others.
    #[must_use]
    pub fn initial(&self) -> Vec<f64> {
        let a = self.robot.construction.parameters();
        let base = [a.a1, a.a2, a.a3, a.a4, a.a5];
        self.parameters
            .iter()
            .enumerate()
            .map(|(j, p)| p.fixed.or(p.start).or(base.get(j).copied()).unwrap_or(p.spec.typical))
            .collect()
    }

    /// Mass, torque and dry-friction levels at one instant.
    #[must_use]
    pub fn terms(&self, x: &Motion<f64>, p: &[f64]) -> Terms<f64> {
        let mut sum = Terms::zero();
        for (effect, slots) in self.effects.iter().zip(&self.slots) {
            sum.add(&effect.terms(x, &p[slots.clone()]));
        }
        sum
    }

    /// Whether an effect of the model shifts the input in time, so that the dead time is part of the model.
    #[must_use]
    pub fn shifts_input(&self) -> bool {
        self.effects.iter().any(|effect| effect.change() == Change::TimeShift)
    }

    /// Whether an effect of the model is a delay of the input, which is indistinguishable from a shift of the
    /// rows.
    #[must_use]
    pub fn delays_input(&self) -> bool {
        self.effects.iter().any(|effect| effect.is_delay())
    }

    /// Whether the model has a two-mass drivetrain.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        self.coupling_effect().is_some()
    }

    /// The number of the effect that adds the second mass; a model has at most one.
    #[must_use]
    pub fn coupling_effect(&self) -> Option<usize> {
        self.couplings().first().copied()
    }

    /// The numbers of all effects that add a second mass.
    fn couplings(&self) -> Vec<usize> {
        let (robot, p) = (&self.robot, self.initial());
        let (alpha, omega) = ([0.0; 2], [0.0; 2]);
        let x = Motion::at(0.0, alpha, omega, robot);
        let is_one = |&e: &usize| self.effects[e].coupling(&x, &p[self.slots(e)]).is_some();
        (0..self.effects.len()).filter(is_one).collect()
    }

    /// Whether an effect of the model changes the input.
    #[must_use]
    pub fn acts_on_input(&self) -> bool {
        self.effects.iter().any(|effect| effect.acts_on_input())
    }

    /// The acting input, computed from the recorded input by all input effects in turn.
    #[must_use]
    pub fn input(&self, t: &[f64], recorded: &[[f64; 2]], p: &[f64]) -> Vec<[f64; 2]> {
        let mut m = recorded.to_vec();
        for (effect, slots) in self.effects.iter().zip(&self.slots) {
            if let Some(changed) = effect.input(t, &m, &p[slots.clone()]) {
                m = changed;
            }
        }
        m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_body_behind_the_wheels_is_refused_with_both_names() {
        let robot = Robot::amigobot();
        for [first, second] in [["wheel_slip", "compliance"], ["compliance", "wheel_slip"]] {
            let one = Model::with_effects(robot.clone(), &[first, "viscous_friction"]).unwrap();
            let error = one.add(second).unwrap_err();
            let (present, added) = (first.to_owned(), second.to_owned());
            assert_eq!(error, ModelError::TwoCouplings { present, added });
            assert!(one.without(one.coupling_effect().unwrap()).add(second).is_ok());
        }
    }
}
