//! An effect defined by a formula of the user.

mod error;

pub use self::error::CustomError;
use super::{
    BASE, DIFFERENTIATED, Description, Energy, Motion, ParameterKind, ParameterSpec, Physics,
    Terms, find,
};
use crate::math::Real;
use crate::math::expression::{Bound, parse};
use crate::robot::Robot;

/// The quantities available in a formula, in addition to the parameters.
pub const QUANTITIES: [&str; 10] =
    ["t", "w1", "w2", "w", "alpha1", "alpha2", "alpha", "v", "beta_dot", "beta"];

/// Largest number of quantities and parameters.
const MOST_NAMES: usize = QUANTITIES.len() + DIFFERENTIATED;

/// Definition of a custom effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CustomDefinition {
    /// Resisting torque on wheel 1 [N m] as a formula in the [`QUANTITIES`] and the parameters.
    pub torque1: String,
    /// The same for wheel 2; if absent, wheel 2 is the mirror image of wheel 1.
    pub torque2: Option<String>,
    /// At most four parameters.
    pub parameters: Vec<ParameterSpec>,
    /// The physical cause; may be empty.
    pub description: String,
}

/// An effect given by a formula for the resisting torque of each wheel.
///
/// ```text
/// mass dω + ... + torque(t, ω, α; p) = M
/// ```
/// The formula may name
///
/// | name | meaning | unit |
/// |---|---|---|
/// | t | time since the start of the recording | s |
/// | w1, w2 | wheel speeds | rad/s |
/// | w | speed of the wheel that the torque acts on | rad/s |
/// | alpha1, alpha2, alpha | wheel angles, likewise | rad |
/// | v | forward speed v_A | m/s |
/// | beta_dot, beta | turn rate and heading | rad/s, rad |
///
/// and its parameters. Without `torque2` wheel 2 gets the mirror image of `torque1`: 1 and 2 are
/// exchanged, so that beta and beta_dot, which are differences of the wheels, change sign.
///
/// Deviation from the registered effects: `sgn(w)` in a formula is taken as written, zero at
/// rest; it does not hold a wheel that stands. Functions are evaluated at the estimate, not
/// averaged over its variance.
///
/// # Examples
/// ```
/// use amigo_ident::effects::{Custom, CustomDefinition, Effect, ParameterSpec};
/// let drag = Custom::new("square_root_drag", CustomDefinition {
///     torque1: "k_r * sgn(w) * sqrt(abs(w))".into(),
///     parameters: vec![ParameterSpec::linear("k_r", "drag", "N m s^0.5", (0.0, 10.0), 0.01)],
///     ..CustomDefinition::default()
/// }).unwrap();
/// assert_eq!(drag.id(), "square_root_drag");
/// ```
#[derive(Clone, Debug)]
pub struct Custom {
    id: String,
    definition: CustomDefinition,
    torque1: Bound,
    torque2: Option<Bound>,
}

impl Custom {
    /// Parses and checks a definition.
    ///
    /// # Errors
    /// An id or symbol that is already used or not a name, more than four parameters, a range without width,
    /// an invalid formula, or a linear parameter in which the formula is not linear.
    pub fn new(id: &str, definition: CustomDefinition) -> Result<Self, CustomError> {
        check_id(id)?;
        check_parameters(id, &definition.parameters)?;
        let names: Vec<&str> = QUANTITIES
            .into_iter()
            .chain(definition.parameters.iter().map(|spec| spec.symbol.as_str()))
            .collect();
        let read = |key: &'static str, text: &str| {
            parse(text).and_then(|formula| formula.bind(&names)).map_err(|source| {
                CustomError::Formula { id: id.into(), key, source: source.into() }
            })
        };
        let torque1 = read("torque1", &definition.torque1)?;
        let torque2 = definition.torque2.as_ref().map(|text| read("torque2", text)).transpose()?;
        let effect = Self { id: id.into(), definition, torque1, torque2 };
        effect.check_linear()?;
        Ok(effect)
    }

    /// Checks linearity: doubles each linear parameter in turn, with the other linear ones zero, at several
    /// states.
    fn check_linear(&self) -> Result<(), CustomError> {
        let robot = Robot::amigobot();
        let specs = &self.definition.parameters;
        let linear = |j: usize| specs[j].kind == ParameterKind::Linear;
        for k in 0..8 {
            let (a, b) = (1.3 + 0.7 * f64::from(k), 2.9 - 1.1 * f64::from(k));
            let (t, alpha, omega) = (a, [a, 0.4 * b], [b, 0.8 * a]);
            let x = Motion::at(t, alpha, omega, &robot);
            for j in (0..specs.len()).filter(|&j| linear(j)) {
                let at = |size: f64| {
                    let value = |i: usize| match (i == j, linear(i)) {
                        (true, _) => size * specs[j].typical,
                        (false, true) => 0.0,
                        (false, false) => specs[i].typical,
                    };
                    let p: Vec<f64> = (0..specs.len()).map(value).collect();
                    self.torque(&x, &p)
                };
                let (zero, one, two) = (at(0.0), at(1.0), at(2.0));
                let proportional = (0..2).all(|i| {
                    let tiny = 1e-9 * one[i].abs();
                    zero[i].abs() <= tiny && (two[i] - 2.0 * one[i]).abs() <= tiny
                });
                // values outside the domain of a formula (a root of a negative number) are not compared
                if !proportional && one.iter().chain(&two).all(|v| v.is_finite()) {
                    let symbol = specs[j].symbol.clone();
                    return Err(CustomError::NotLinear { id: self.id.clone(), symbol });
                }
            }
        }
        Ok(())
    }

    fn torque<T: Real>(&self, x: &Motion<T>, p: &[T]) -> [T; 2] {
        let second = match &self.torque2 {
            Some(formula) => evaluate(formula, x, 1, p),
            None => {
                let swap = |v: [T; 2]| [v[1], v[0]];
                let image = Motion { alpha: swap(x.alpha), omega: swap(x.omega), ..*x };
                evaluate(&self.torque1, &image, 0, p)
            }
        };
        [evaluate(&self.torque1, x, 0, p), second]
    }
}

/// A formula on one wheel: 0 for wheel 1, 1 for wheel 2.
fn evaluate<T: Real>(formula: &Bound, x: &Motion<T>, wheel: usize, p: &[T]) -> T {
    let ([w1, w2], [alpha1, alpha2]) = (x.omega, x.alpha);
    let quantities = [
        x.t,
        w1,
        w2,
        x.omega[wheel],
        alpha1,
        alpha2,
        x.alpha[wheel],
        x.forward_speed(),
        x.turn_rate(),
        x.heading(),
    ];
    let mut values = [T::from(0.0); MOST_NAMES];
    values[..quantities.len()].copy_from_slice(&quantities);
    values[quantities.len()..quantities.len() + p.len()].copy_from_slice(p);
    formula.evaluate(&values[..quantities.len() + p.len()])
}

/// Whether a word is a name: a letter, then letters, digits and underscores.
fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn check_id(id: &str) -> Result<(), CustomError> {
    let reason = if !is_name(id) {
        "it is not a name of letters, digits and underscores"
    } else if find(id).is_some() {
        "the catalogue has an effect of that name"
    } else {
        return Ok(());
    };
    Err(CustomError::Id { id: id.into(), reason })
}

fn check_parameters(id: &str, specs: &[ParameterSpec]) -> Result<(), CustomError> {
    if specs.len() > DIFFERENTIATED {
        return Err(CustomError::Parameters { id: id.into(), found: specs.len() });
    }
    let base = BASE.iter().filter_map(|id| find(id)).flat_map(|effect| effect.parameters());
    let base: Vec<String> = base.map(|spec| spec.symbol).collect();
    for (j, spec) in specs.iter().enumerate() {
        let symbol = &spec.symbol;
        let reason = if !is_name(symbol) {
            "it is not a name of letters, digits and underscores"
        } else if QUANTITIES.contains(&symbol.as_str()) {
            "it names a quantity of the motion"
        } else if parse(symbol).is_ok_and(|formula| formula.variables() != [symbol]) {
            "formulas have a constant of that name"
        } else if base.contains(symbol) {
            "it names a parameter of the base model"
        } else if specs[..j].iter().any(|other| other.symbol == *symbol) {
            "it is listed twice"
        } else {
            check_range(id, spec)?;
            continue;
        };
        return Err(CustomError::Symbol { id: id.into(), symbol: symbol.clone(), reason });
    }
    Ok(())
}

fn check_range(id: &str, spec: &ParameterSpec) -> Result<(), CustomError> {
    let ((low, high), typical) = (spec.range, spec.typical);
    if low < high && low <= typical && typical <= high && typical.is_finite() {
        return Ok(());
    }
    Err(CustomError::Range { id: id.into(), symbol: spec.symbol.clone(), low, high, typical })
}

impl Physics for Custom {
    fn description(&self) -> Description {
        let given = &self.definition;
        let second = given.torque2.as_deref().unwrap_or("the mirror image");
        Description {
            id: self.id.clone(),
            title: self.id.replace('_', " "),
            equation: format!("{} on wheel 1, {second} on wheel 2", given.torque1),
            cause: given.description.clone(),
            signature: "as given by the formula".into(),
            excitation: "motion over which the value of the formula varies".into(),
            equivalent: vec![],
        }
    }

    fn needs_track(&self) -> bool {
        let formulas = [Some(&self.definition.torque1), self.definition.torque2.as_ref()];
        let names_heading =
            |text: &String| parse(text).is_ok_and(|formula| formula.variables().contains(&"beta"));
        formulas.into_iter().flatten().any(names_heading)
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        self.definition.parameters.clone()
    }

    /// Nothing can be guaranteed for a formula.
    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: self.torque(x, p), ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Effect, Jet};
    use crate::math::Dual;

    fn custom(
        torque1: &str,
        torque2: Option<&str>,
        symbols: &[&str],
    ) -> Result<Custom, CustomError> {
        let spec = |symbol: &&str| ParameterSpec::linear(symbol, "", "N m", (-1.0, 1.0), 0.01);
        Custom::new(
            "mine",
            CustomDefinition {
                torque1: torque1.into(),
                torque2: torque2.map(Into::into),
                parameters: symbols.iter().map(spec).collect(),
                description: String::new(),
            },
        )
    }

    fn state<T: Real>(robot: &Robot, v: [T; 4]) -> Motion<'_, T> {
        let [a1, a2, w1, w2] = v;
        Motion::at(1.5.into(), [a1, a2], [w1, w2], robot)
    }

    #[test]
    fn the_formula_of_a_registered_effect_gives_the_same_torque_and_partials() {
        let robot = Robot::amigobot();
        let x = state(&robot, [0, 1, 2, 3].map(|k| Jet::variable([2.0, -1.0, 7.0, -3.0][k], k)));
        for (id, formula, symbol) in [
            ("quadratic_drag", "c * w * abs(w)", "c"),
            ("yaw_viscous", "d_y * (w1 - w2)", "d_y"),
            // beta_dot = r/(2 l1) (w1 - w2) = (w1 - w2) * 0.05/0.24
            ("yaw_viscous", "d_y * beta_dot * 0.24 / 0.05", "d_y"),
        ] {
            let mine = custom(formula, None, &[symbol]).unwrap();
            let p = [Dual::variable(0.02, 4)];
            let (found, expected) = (mine.terms_jet(&x, &p), find(id).unwrap().terms_jet(&x, &p));
            for i in 0..2 {
                let (f, e) = (found.torque[i], expected.torque[i]);
                assert!((f.value - e.value).abs() < 1e-15, "{formula}: {f:?} {e:?}");
                for k in 0..8 {
                    assert!((f.partial[k] - e.partial[k]).abs() < 1e-14, "{formula} {k}");
                }
            }
        }
    }

    #[test]
    fn two_formulas_act_each_on_its_wheel_with_its_own_speed() {
        let robot = Robot::amigobot();
        let mine = custom("q1 * w + t", Some("q1 * alpha * v"), &[]);
        assert!(matches!(mine, Err(CustomError::Formula { key: "torque1", .. })));
        let mine = custom("q1 * w * t", Some("q1 * alpha * v"), &["q1"]).unwrap();
        let x = state(&robot, [2.0, -1.0, 7.0, -3.0]);
        let torque = Effect::terms(&mine, &x, &[0.1]).torque;
        // v = r/2 (w1 + w2) = 0.025 * 4
        assert!((torque[0] - 0.1 * 7.0 * 1.5).abs() < 1e-15);
        assert!((torque[1] + 0.1 * 0.1).abs() < 1e-15);
    }

    #[test]
    fn definitions_that_cannot_work_are_refused_with_the_reason() {
        let symbol = |symbols: &[&str]| custom("w", None, symbols).unwrap_err();
        assert!(matches!(symbol(&["w1"]), CustomError::Symbol { .. }));
        assert!(matches!(symbol(&["a3"]), CustomError::Symbol { .. }));
        assert!(matches!(symbol(&["pi"]), CustomError::Symbol { .. }));
        assert!(matches!(symbol(&["q", "q"]), CustomError::Symbol { .. }));
        assert!(matches!(
            symbol(&["q", "r", "s", "u", "x"]),
            CustomError::Parameters { found: 5, .. }
        ));
        let bent = custom("w * exp(q)", None, &["q"]);
        assert!(matches!(bent, Err(CustomError::NotLinear { symbol, .. }) if symbol == "q"));
        let offset = custom("q * w + 0.1", None, &["q"]);
        assert!(matches!(offset, Err(CustomError::NotLinear { .. })));
        let taken = Custom::new("stribeck", CustomDefinition::default()).unwrap_err();
        assert!(taken.to_string().contains("the catalogue has an effect of that name"));
    }
}
