//! A formula for the residual torque as a custom effect.

use std::fmt::Write;
use std::sync::Arc;

use crate::compare::{Acting, Curve, Variable};
use crate::diagnose::{WindowFit, Windows, fit, scale_of};
use crate::effects::{Custom, CustomDefinition, ParameterSpec};
use crate::math::round_significant;
use crate::recording::{DriveUnit, Recording};
use crate::simulate::Hold;

/// Largest coefficient relative to the amplitude of the curve: coefficients of a series over a range with
/// gaps may exceed the values of the curve (judgement: ten times).
const RANGE: f64 = 10.0;

/// A dependence of the residual torque on heading, wheel angle or time, as an effect of an experiment file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula {
    /// Name of the effect.
    pub(super) id: String,
    /// Its torques and parameters.
    pub(super) definition: CustomDefinition,
}

impl Formula {
    /// The series that approximates a curve: two harmonics of the heading, one of the angle of each wheel, a
    /// parabola in time. `None` for other variables, which the catalogue covers, and for a torque
    /// proportional to the input, which formulas cannot express.
    pub(super) fn of(curve: &Curve, unit: DriveUnit) -> Option<Self> {
        let (name, series) = match curve.variable {
            Variable::Heading => {
                let both = "k1*cos(beta) + k2*sin(beta) + k3*cos(2*beta) + k4*sin(2*beta)";
                ("heading", [both, both].map(str::to_owned))
            }
            Variable::Alpha1 | Variable::Alpha2 => (
                "wheel_angle",
                ["k1*cos(alpha1) + k2*sin(alpha1)", "k3*cos(alpha2) + k4*sin(alpha2)"]
                    .map(str::to_owned),
            ),
            Variable::Time => {
                // relative to the range, so that coefficients are torques
                let whole = round_significant(curve.bins.last()?.at, 2);
                let parabola =
                    |a: &str, b: &str| format!("{a}*(t/{whole:?}) + {b}*(t/{whole:?})^2");
                ("time", [parabola("k1", "k2"), parabola("k3", "k4")])
            }
            _ => return None,
        };
        let (kind, what, [torque1, torque2]) = match curve.acting {
            Acting::Torque => ("torque", "torque", series),
            Acting::Resistance => {
                let against = series.map(|series| format!("({series}) * sgn(w)"));
                ("resistance", "resistance to the motion", against)
            }
            Acting::Gain => return None,
        };
        let size = round_significant(curve.largest_left(), 2);
        let parameters = ["k1", "k2", "k3", "k4"].map(|symbol| {
            let (reach, unit) = (RANGE * size, unit.symbol());
            ParameterSpec::linear(symbol, "coefficient of the series", unit, (-reach, reach), size)
        });
        let definition = CustomDefinition {
            torque1,
            torque2: Some(torque2),
            parameters: parameters.into(),
            description: format!("a {what} that depends on the {}", name.replace('_', " ")),
        };
        (size > 0.0).then_some(Self { id: format!("{name}_{kind}"), definition })
    }

    /// The block of the experiment file.
    pub(super) fn toml(&self) -> String {
        let Self { id, definition } = self;
        let mut out = format!("[[model.custom]]\nid = \"{id}\"\n");
        let torque2 = definition.torque2.as_deref().unwrap_or_default();
        let CustomDefinition { torque1, description, .. } = definition;
        // writing to a string does not fail
        let _ = writeln!(out, "description = \"{description}\"");
        let _ = writeln!(
            out,
            "torque1 = \"{torque1}\"\ntorque2 = \"{torque2}\"\n\n[model.custom.parameters]"
        );
        for ParameterSpec { symbol, unit, range: (low, high), typical, .. } in
            &definition.parameters
        {
            let _ = writeln!(
                out,
                "{symbol} = {{ unit = \"{unit}\", range = [{low:?}, {high:?}], typical = {typical:?} }}"
            );
        }
        out
    }

    /// The model of `base` with this effect, fitted to the training recordings like any effect of the
    /// catalogue. `None` if the model has an effect with this name, or if it cannot be simulated.
    pub(super) fn fitted(
        &self,
        base: &WindowFit,
        train: &[Recording],
        hold: Hold,
    ) -> Option<WindowFit> {
        let WindowFit { model, p, .. } = base;
        let effect = Custom::new(&self.id, self.definition.clone()).ok()?;
        let train: Vec<&Recording> = train.iter().collect();
        let scale = scale_of(model, p, &train);
        let windows = Windows::weighted(train, hold, model, p);
        let with = model.add_effect(Arc::new(effect)).ok()?;
        let start: Vec<f64> =
            p.iter().copied().chain(self.definition.parameters.iter().map(|_| 0.0)).collect();
        fit(&windows, &with, &start, &scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{CurveBin, Mean};

    fn curve(variable: Variable, acting: Acting) -> Curve {
        let before = [1.06, -0.4].map(|value| Mean { value, std_error: 0.1, blocks: 9 });
        let bins = vec![CurveBin { at: 20.0, joined: false, before, after: None }];
        let (share_before, share_after) = (0.7, None);
        Curve { variable, acting, bins, share_before, share_after, log_significance: 50.0 }
    }

    #[test]
    fn a_formula_is_an_effect_and_reads_as_one_of_a_file() {
        for (variable, acting) in [
            (Variable::Heading, Acting::Resistance),
            (Variable::Heading, Acting::Torque),
            (Variable::Alpha1, Acting::Resistance),
            (Variable::Time, Acting::Torque),
        ] {
            let formula = Formula::of(&curve(variable, acting), DriveUnit::Volt).unwrap();
            Custom::new(&formula.id, formula.definition.clone()).unwrap();
            let file: toml::Table = formula.toml().parse().unwrap();
            let written = &file["model"]["custom"][0];
            assert_eq!(written["torque1"].as_str(), Some(formula.definition.torque1.as_str()));
            assert_eq!(written["parameters"]["k4"]["typical"].as_float(), Some(1.1));
            assert_eq!(written["parameters"]["k1"]["unit"].as_str(), Some("V"));
        }
    }

    #[test]
    fn coefficients_over_the_time_are_torques() {
        let formula = Formula::of(&curve(Variable::Time, Acting::Torque), DriveUnit::Volt).unwrap();
        assert_eq!(formula.definition.torque1, "k1*(t/20.0) + k2*(t/20.0)^2");
    }

    #[test]
    fn the_catalogue_stands_for_speeds_and_no_formula_has_the_input() {
        let none =
            |variable, acting| Formula::of(&curve(variable, acting), DriveUnit::Volt).is_none();
        assert!(none(Variable::Omega1, Acting::Torque));
        assert!(none(Variable::Time, Acting::Gain));
    }
}
