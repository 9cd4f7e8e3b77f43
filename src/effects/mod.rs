//! One physical effect per file, and the catalogue.
//!
//! A model is a sum of effects: `mass(x; p) dω + torque(x; p) + dry friction = input(M; p)`.
//! An author implements [`Physics`], generic over [`Real`](crate::math::Real); the program uses the object-safe
//! [`Effect`], which evaluates it with `f64` or with exact derivatives.

mod coupling;
mod custom;
mod effect;
mod motion;
mod scale;
mod text;
mod wave;

pub use coupling::{BodyState, Coupling, MOST_OF_INERTIA, smallest_inertia};
pub use custom::{Custom, CustomDefinition, CustomError, QUANTITIES};
pub use effect::{
    Change, DIFFERENTIATED, Effect, Jet, MOST_PARAMETERS, Own, Physics, SURELY, Tangent,
};
pub use motion::{DIRECTIONS, Motion, Terms, along, with_friction};
pub use scale::{FAST, Scale, geometric};
pub use text::{details, overview};
pub use wave::{Cycle, Wave};

use crate::catalogue;
use crate::recording::DriveUnit;

/// How an effect treats mechanical energy; every registered effect is tested for this.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Energy {
    /// Stores and returns it (inertia, gravity, springs).
    Stores,
    /// The torque is perpendicular to the motion.
    DoesNoWork,
    /// Dissipates energy for parameters within their ranges.
    Dissipates,
    /// May supply energy, or changes the power of the input (offset, gain, ripple).
    Supplies,
}

impl Energy {
    /// Whether such an effect acts on the body if a [`Coupling`] separates it from the wheels.
    #[must_use]
    pub fn of_the_body(self) -> bool {
        matches!(self, Self::Stores | Self::DoesNoWork)
    }
}

/// How a parameter enters the torque equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum ParameterKind {
    /// The torque is proportional to it, so least squares applies.
    Linear,
    /// It enters nonlinearly (a width, a time constant, a threshold).
    Shape,
}

/// Specification of a parameter of an effect.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ParameterSpec {
    /// Symbol, unique over the catalogue.
    pub symbol: String,
    /// Its meaning in a few words.
    pub meaning: String,
    /// SI unit for torques in N m; `N m` is replaced if the input is in V or A.
    pub unit: String,
    /// Smallest and largest physically reasonable value.
    pub range: (f64, f64),
    /// Typical value for a robot like the AmigoBot, used as initial value.
    pub typical: f64,
    /// Linear or shape.
    pub kind: ParameterKind,
    /// Whether it is an integer, which is not changed by descent.
    pub whole: bool,
}

impl ParameterSpec {
    /// A parameter in which the torque is linear.
    #[must_use]
    pub fn linear(
        symbol: &str,
        meaning: &str,
        unit: &str,
        range: (f64, f64),
        typical: f64,
    ) -> Self {
        Self {
            symbol: symbol.into(),
            meaning: meaning.into(),
            unit: unit.into(),
            range,
            typical,
            kind: ParameterKind::Linear,
            whole: false,
        }
    }

    /// A shape parameter of the torque.
    #[must_use]
    pub fn shape(symbol: &str, meaning: &str, unit: &str, range: (f64, f64), typical: f64) -> Self {
        Self { kind: ParameterKind::Shape, ..Self::linear(symbol, meaning, unit, range, typical) }
    }

    /// An integer shape parameter: an order, an exponent.
    #[must_use]
    pub fn whole(symbol: &str, meaning: &str, range: (f64, f64), typical: f64) -> Self {
        Self { whole: true, ..Self::shape(symbol, meaning, "", range, typical) }
    }
}

/// Catalogue entry of an effect.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Description {
    /// The id used in experiment files.
    pub id: String,
    /// Its name in words.
    pub title: String,
    /// Its contribution to the equation of motion, as plain text.
    pub equation: String,
    /// The physical cause.
    pub cause: String,
    /// How it appears in measured data.
    pub signature: String,
    /// Motion that excites it.
    pub excitation: String,
    /// Ids of effects that no wheel recording can distinguish from this one.
    pub equivalent: Vec<String>,
}

catalogue! {
    dyn Effect;
    inertia::Inertia,
    centrifugal::Centrifugal,
    coulomb_friction::CoulombFriction,
    viscous_friction::ViscousFriction,
    viscous_friction_1::ViscousFriction1,
    viscous_friction_2::ViscousFriction2,
    viscous_asymmetry::ViscousAsymmetry,
    back_emf::BackEmf,
    torque_offset::TorqueOffset,
    stribeck::Stribeck,
    quadratic_drag::QuadraticDrag,
    coulomb_asymmetry::CoulombAsymmetry,
    slope::Slope,
    turning_scrub::TurningScrub,
    yaw_viscous::YawViscous,
    caster_drag::CasterDrag,
    sliding_caster::SlidingCaster,
    payload::Payload,
    lateral_com::LateralCom,
    wheel_radius_mismatch::WheelRadiusMismatch,
    actuator_lag::ActuatorLag,
    actuator_delay::ActuatorDelay,
    torque_gain::TorqueGain,
    torque_saturation::TorqueSaturation,
    backlash_deadzone::BacklashDeadzone,
    torque_ripple::TorqueRipple,
    wheel_eccentricity::WheelEccentricity,
    friction_warmup::FrictionWarmup,
    load_transfer_friction::LoadTransferFriction,
    wheel_slip::WheelSlip,
    compliance::Compliance,
}

/// The ids of the base model, in the order of its parameters a1..a5.
pub const BASE: [&str; 3] = ["inertia", "centrifugal", "coulomb_friction"];

/// Ids of the effects that belong to every model whose input was recorded in this unit.
#[must_use]
pub fn belonging_to(input: DriveUnit) -> Vec<String> {
    all().iter().filter(|effect| effect.belongs_to(input)).map(|effect| effect.id()).collect()
}

/// Id of the most common effect beyond the base model, suggested if nothing is known.
#[must_use]
pub fn most_common() -> Option<String> {
    all().iter().find(|effect| effect.is_common()).map(|effect| effect.id())
}

/// The effect that delays the input.
#[must_use]
pub fn delay() -> Option<Box<dyn Effect>> {
    all().into_iter().find(|effect| effect.is_delay())
}

/// The registered effect of that id.
#[must_use]
pub fn find(id: &str) -> Option<Box<dyn Effect>> {
    all().into_iter().find(|effect| effect.id() == id)
}

#[cfg(test)]
mod contract;
