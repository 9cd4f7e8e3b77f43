//! An effect of your own: physics written once, fitted with exact derivatives.
//!
//! ```sh
//! cargo run --release --example effect_of_your_own
//! ```

#![allow(clippy::print_stdout)]

use std::sync::Arc;

use amigo_ident::effects::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use amigo_ident::identify::{Identifier, PredictionError, Task};
use amigo_ident::math::Real;
use amigo_ident::model::Model;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

/// Drag of the air on the frame: c v |v|, the same torque on both wheels.
struct AirDrag;

impl Physics for AirDrag {
    fn description(&self) -> Description {
        Description {
            id: "air_drag".into(),
            title: "air drag".into(),
            equation: "c_a v_A |v_A| on both wheels".into(),
            cause: "air at the frame".into(),
            signature: "residual torque that grows with the square of the forward speed".into(),
            excitation: "fast straights".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("c_a", "air drag", "N m s^2/m^2", (0.0, 10.0), 0.1)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let drag = p[0] * x.forward_speed() * x.forward_speed().abs();
        Terms { torque: [drag, drag], ..Terms::zero() }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::base(Robot::amigobot()).add_effect(Arc::new(AirDrag))?;
    let mut parameters = model.initial();
    parameters[model.index_of("c_a")?] = 0.2;
    let noise = NoiseLevel { dalpha: 0.05, alpha: 0.001, torque: 0.005 };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 1 };
    let movement = Movement::rich(model.robot(), 1, 20.0, 12.0);
    let recording = record("synthetic", &model, &parameters, &movement, &recorder)?;

    let task = Task { model: &model, train: &[recording], hold: Hold::Linear, seed: 0 };
    let fit = PredictionError::default().identify(&task)?;
    for (estimate, value) in fit.estimates.iter().zip(&parameters) {
        let (symbol, found, error) = (&estimate.symbol, estimate.value, estimate.std_error);
        println!("{symbol:<4} true {value:>10.6}  found {found:>10.6} ± {error:.6}");
    }
    Ok(())
}
