//! What is hidden, at which size, and what the picture then shows.

use amigo_ident::compare::Variable;
use amigo_ident::model::{Model, ModelError};
use amigo_ident::robot::Robot;

/// One effect, hidden.
pub(crate) struct Case {
    /// Id of the effect.
    pub(crate) id: &'static str,
    /// Its parameters where they are not the typical ones.
    pub(crate) hidden: &'static [(&'static str, f64)],
    /// Base parameters that the fit holds, at this share of the construction's value.
    pub(crate) held: &'static [(&'static str, f64)],
    /// Whether the movement starts and brakes hard.
    pub(crate) hard: bool,
    /// What the residual torque depends on most, where that shows the effect; else the picture is
    /// of the simulated motion.
    pub(crate) against: Option<Variable>,
    /// How to read the picture: a sentence about the residual torque against that variable.
    pub(crate) reading: &'static str,
}

impl Case {
    /// The model without the effect.
    pub(crate) fn model_without(&self) -> Result<Model, ModelError> {
        let base = Model::base(Robot::amigobot());
        let construction = base.initial();
        self.held.iter().try_fold(base, |model, (symbol, share)| {
            let value = share * construction[model.index_of(symbol)?];
            model.fix(symbol, value)
        })
    }
}

/// The case of an effect.
pub(crate) fn find(id: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.id == id)
}

const PLAIN: Case =
    Case { id: "", hidden: &[], held: &[], hard: false, against: None, reading: "" };

/// Sizes as in the benchmark of hidden effects, with some exceptions: an order of ripple that 12 bins a
/// turn can show, a limit that is not reached all the time, and softer contacts and shafts.
static CASES: [Case; 31] = [
    Case {
        id: "inertia",
        held: &[("a2", 0.0)],
        against: Some(Variable::Acceleration1),
        reading: "The residual of wheel 2 rises linearly with the acceleration of wheel 1: the coupling \
                  torque a2 is missing. The inertia a1 cannot be left out, \
                  because the model could not be simulated without it; a missing part of it would appear \
                  as a line of negative slope on the wheel itself.",
        ..PLAIN
    },
    Case {
        id: "centrifugal",
        held: &[("a3", 0.0)],
        against: Some(Variable::TurnRate),
        reading: "Both residuals are negative for turns to either side and grow with the turn rate: in \
                  pivots the centrifugal torque opposes the motion of both wheels.",
        ..PLAIN
    },
    Case {
        id: "coulomb_friction",
        held: &[("a4", 0.0), ("a5", 0.0)],
        against: Some(Variable::Omega1),
        reading: "A step at zero speed on wheel 1, from +a4 (rolling backward) to -a4 (rolling \
                  forward). Wheel 2 has the same step over its own speed; the curve here only reflects the \
                  correlation of the two wheel speeds.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction",
        hidden: &[("b", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth on wheel 1: the residual falls with speed on either side and jumps up at \
                  zero speed. It is not a straight line through zero because the fitted Coulomb friction has \
                  absorbed the mean resistance in each direction. \
                  Wheel 2 has the same sawtooth over its own speed.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction_1",
        hidden: &[("b1", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth on wheel 1, and no dependence on wheel 2. The fitted Coulomb friction has \
                  absorbed the mean resistance of wheel 1 in each direction; the slope \
                  remains.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction_2",
        hidden: &[("b2", 2e-3)],
        against: Some(Variable::Omega2),
        reading: "A sawtooth on wheel 2, and no dependence on wheel 1. The fitted Coulomb friction has \
                  absorbed the mean resistance of wheel 2 in each direction; the slope \
                  remains.",
        ..PLAIN
    },
    Case {
        id: "back_emf",
        hidden: &[("k_e", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "The same sawtooth as with viscous friction: the residual of wheel 1 falls with speed \
                  on either side and jumps up at zero speed, because the fitted Coulomb friction has \
                  absorbed the mean in each direction.",
        ..PLAIN
    },
    Case {
        id: "torque_offset",
        hidden: &[("o1", 0.012), ("o2", 0.008)],
        against: Some(Variable::Acceleration2),
        reading: "Two constant residuals, at -o1 and -o2. They are constant over every variable; the choice \
                  of this one has no meaning. The bands are wide near zero acceleration, where the robot mostly stands \
                  or moves at constant speed.",
        ..PLAIN
    },
    Case {
        id: "stribeck",
        hidden: &[("fs", 0.03), ("ws", 0.8)],
        against: Some(Variable::Omega2),
        reading: "A notch on wheel 2 in the bin next to zero speed, where the friction is higher than \
                  the fitted Coulomb level. At higher speeds the fitted level is slightly too high, which \
                  leaves a small step of the opposite sign.",
        ..PLAIN
    },
    Case {
        id: "quadratic_drag",
        hidden: &[("c", 2e-4)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth with curved flanks on wheel 1: steep at high speed, flat near rest. With \
                  viscous friction the flanks are straight. The jump at zero speed is the part that the fitted \
                  Coulomb friction has absorbed.",
        ..PLAIN
    },
    Case {
        id: "coulomb_asymmetry",
        hidden: &[("c1", 0.012), ("c2", 0.008)],
        against: Some(Variable::Acceleration2),
        reading: "Two constant residuals, at -c1 and -c2, as with a torque offset. They are constant over \
                  every variable; the choice of this one has no meaning. The bands are wide near zero acceleration, where \
                  the robot mostly stands or moves at constant speed.",
        ..PLAIN
    },
    Case {
        id: "viscous_asymmetry",
        hidden: &[("ba1", 1.2e-3), ("ba2", 8e-4)],
        against: Some(Variable::Omega1),
        reading: "An inverted V on wheel 1: -ba1 |w1|, of the same sign in both directions, which neither \
                  Coulomb nor viscous friction can absorb.",
        ..PLAIN
    },
    Case {
        id: "slope",
        hidden: &[("g_c", 0.015), ("g_s", 0.01), ("k_g", 0.317)],
        against: Some(Variable::Heading),
        reading: "Both residuals vary sinusoidally with heading. They differ in phase \
                  because the weight acts at the centre of mass, which is behind the axle.",
        ..PLAIN
    },
    Case {
        id: "turning_scrub",
        hidden: &[("f_t", 0.012)],
        against: Some(Variable::TurnRate),
        reading: "A step at zero turn rate, of opposite sign on the two \
                  wheels, from +f_t to -f_t on wheel 1.",
        ..PLAIN
    },
    Case {
        id: "yaw_viscous",
        hidden: &[("d_y", 1.2e-3)],
        against: Some(Variable::TurnRate),
        reading: "Two lines of opposite slope through zero. The jumps in the middle belong to the change \
                  between left and right turns at low speed, where the bins are narrow.",
        ..PLAIN
    },
    Case {
        id: "caster_drag",
        hidden: &[("f_c", 0.012)],
        against: Some(Variable::ForwardSpeed),
        reading: "A step at zero forward speed, equal on both wheels, from +f_c \
                  (backward) to -f_c (forward).",
        ..PLAIN
    },
    Case {
        id: "sliding_caster",
        hidden: &[("f_k", 0.015), ("d_k", 1.2)],
        against: Some(Variable::TurnRate),
        reading: "A step at zero turn rate, of opposite sign on the two wheels. Over the forward speed there is a step of the \
                  same sign on both wheels. Each step has its full height where the other speed is small; in curves both \
                  are lower, because they are components of one force.",
        ..PLAIN
    },
    Case {
        id: "payload",
        hidden: &[("mp", 2.0), ("ip", 0.02), ("sp", 0.0)],
        held: &[("a1", 1.0), ("a2", 1.0)],
        against: Some(Variable::Acceleration1),
        reading: "The residual of wheel 1 falls with its acceleration: inertia is missing. The slope of wheel 2 \
                  is smaller, because the accelerations of the two wheels are only partly correlated.",
        ..PLAIN
    },
    Case {
        id: "lateral_com",
        hidden: &[("m", 4e-4)],
        against: Some(Variable::Acceleration1),
        reading: "The residual of wheel 1 falls with its acceleration, because its inertia is larger \
                  than the common a1. The residual of wheel 2, whose inertia is smaller, rises with \
                  its own acceleration.",
        ..PLAIN
    },
    Case {
        id: "wheel_radius_mismatch",
        hidden: &[("eps", 0.03), ("epd", 0.0)],
        against: Some(Variable::Acceleration1),
        reading: "The residual of wheel 1 falls with its acceleration, as with a lateral centre of mass. \
                  The two differ by a small torque that appears when driving straight at high \
                  speed.",
        ..PLAIN
    },
    Case { id: "actuator_lag", hidden: &[("tau", 0.02)], reading: "", ..PLAIN },
    Case { id: "actuator_delay", hidden: &[("delay", 0.02)], reading: "", ..PLAIN },
    Case {
        id: "torque_gain",
        hidden: &[("g", 0.05)],
        against: Some(Variable::Input2),
        reading: "The residual of wheel 2 falls with its input, although the gain of wheel 1 is wrong: \
                  the common inertia absorbs half of the error, and the other half remains with opposite \
                  signs on the two wheels. The residual of wheel 1 rises with its own \
                  input.",
        ..PLAIN
    },
    Case {
        id: "torque_saturation",
        hidden: &[("limit", 0.4)],
        against: Some(Variable::Input1),
        reading: "The residual of wheel 1 rises with small inputs and falls where the input exceeds the limit. The fitted \
                  inertia and friction are too large, because they have absorbed part of the torque that is missing \
                  above the limit; below it the model therefore requires more torque than was recorded.",
        ..PLAIN
    },
    Case {
        id: "backlash_deadzone",
        hidden: &[("d", 0.01)],
        against: Some(Variable::Input1),
        reading: "A step on wheel 1 where its input changes sign, from +d to -d. It decreases \
                  towards large torques, where the fitted inertia and friction have absorbed it.",
        ..PLAIN
    },
    Case {
        id: "torque_ripple",
        hidden: &[("n", 3.0)],
        against: Some(Variable::Alpha2),
        reading: "Three periods per turn of wheel 2. The figure has 12 bins per turn and cannot resolve \
                  orders above 6; the diagnosis tests orders up to 16 without \
                  bins.",
        ..PLAIN
    },
    Case {
        id: "wheel_eccentricity",
        against: Some(Variable::Alpha1),
        reading: "One period per turn of wheel 1. Wheel 2 has one period per turn of its own angle.",
        ..PLAIN
    },
    Case {
        id: "friction_warmup",
        hidden: &[("fw", 0.03), ("tw", 8.0), ("fwd", 0.0)],
        reading: "",
        ..PLAIN
    },
    Case {
        id: "load_transfer_friction",
        hidden: &[("cl", 1.5e-4)],
        against: Some(Variable::TurnRate),
        reading: "Residuals of opposite sign on the two wheels that change sign with the turn rate: the outer \
                  wheel has more friction. They return to zero at the ends because the fastest turns \
                  are pivots, in which neither wheel is the outer one.",
        ..PLAIN
    },
    Case { id: "wheel_slip", hidden: &[("cs", 0.1)], hard: true, reading: "", ..PLAIN },
    Case {
        id: "compliance",
        hidden: &[("kt", 2.0), ("dt", 0.03)],
        hard: true,
        reading: "The error of the rigid model rises where the acceleration starts (4.2 s) and where it \
                  ends (4.9 s); with the effect it stays below 0.06 rad/s.",
        ..PLAIN
    },
];
