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
        reading: "The line of wheel 2 rises with the acceleration of wheel 1: the torque by which \
                  the body couples the wheels is missing. The own inertia a1 cannot be left out, \
                  since without it nothing could be simulated; it would show the same way on the \
                  wheel itself, as a falling line.",
        ..PLAIN
    },
    Case {
        id: "centrifugal",
        held: &[("a3", 0.0)],
        against: Some(Variable::TurnRate),
        reading: "Both lines fall to either side of zero, the faster the robot turns the more: in \
                  pivots the centrifugal torque holds back both wheels.",
        ..PLAIN
    },
    Case {
        id: "coulomb_friction",
        held: &[("a4", 0.0), ("a5", 0.0)],
        against: Some(Variable::Omega1),
        reading: "A step at rest on wheel 1, from +a4 when it rolls backward to -a4 when it rolls \
                  forward. Wheel 2 has its step over its own speed; here it only follows how often \
                  the two wheels turn together.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction",
        hidden: &[("b", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth on wheel 1: the line falls with speed on either side and jumps up at \
                  rest. The fitted Coulomb friction has absorbed the mean resistance in each \
                  direction, so that only the slope is left, not a straight line through zero. \
                  Wheel 2 has its sawtooth over its own speed.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction_1",
        hidden: &[("b1", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth on wheel 1, and nothing on wheel 2: the fitted Coulomb friction has \
                  absorbed the mean resistance of wheel 1 in each direction, and the slope is \
                  left.",
        ..PLAIN
    },
    Case {
        id: "viscous_friction_2",
        hidden: &[("b2", 2e-3)],
        against: Some(Variable::Omega2),
        reading: "A sawtooth on wheel 2, and nothing on wheel 1: the fitted Coulomb friction has \
                  absorbed the mean resistance of wheel 2 in each direction, and the slope is \
                  left.",
        ..PLAIN
    },
    Case {
        id: "back_emf",
        hidden: &[("k_e", 2e-3)],
        against: Some(Variable::Omega1),
        reading: "The same sawtooth as of viscous friction: the line of wheel 1 falls with speed \
                  on either side and jumps up at rest, where the fitted Coulomb friction has \
                  absorbed the mean in each direction.",
        ..PLAIN
    },
    Case {
        id: "torque_offset",
        hidden: &[("o1", 0.012), ("o2", 0.008)],
        against: Some(Variable::Acceleration2),
        reading: "Two flat lines, at -o1 and -o2. They are flat against every variable; that this \
                  one comes first has no meaning. Near zero acceleration the robot mostly stands \
                  or rolls steadily, and the bands are wide.",
        ..PLAIN
    },
    Case {
        id: "stribeck",
        hidden: &[("fs", 0.03), ("ws", 0.8)],
        against: Some(Variable::Omega2),
        reading: "A notch on wheel 2 at the bin next to rest, where the friction is higher than \
                  the fitted level. Farther out the fitted level is a little too high, which \
                  leaves a small step the other way.",
        ..PLAIN
    },
    Case {
        id: "quadratic_drag",
        hidden: &[("c", 2e-4)],
        against: Some(Variable::Omega1),
        reading: "A sawtooth with bent teeth on wheel 1: steep at high speed, flat near rest. With \
                  viscous friction the teeth are straight. The jump at rest is what the fitted \
                  Coulomb friction has absorbed.",
        ..PLAIN
    },
    Case {
        id: "coulomb_asymmetry",
        hidden: &[("c1", 0.012), ("c2", 0.008)],
        against: Some(Variable::Acceleration2),
        reading: "Two flat lines, at -c1 and -c2, as of a torque offset. They are flat against \
                  every variable; that this one comes first has no meaning. Near zero acceleration \
                  the robot mostly stands or rolls steadily, and the bands are wide.",
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
        reading: "Both lines vary sinusoidally with heading; they are shifted against each other \
                  because the centre of mass lies off the axle and turns the robot downhill.",
        ..PLAIN
    },
    Case {
        id: "turning_scrub",
        hidden: &[("f_t", 0.012)],
        against: Some(Variable::TurnRate),
        reading: "A step where the turn rate changes sign, on the two wheels in opposite \
                  directions, from +f_t to -f_t on wheel 1.",
        ..PLAIN
    },
    Case {
        id: "yaw_viscous",
        hidden: &[("d_y", 1.2e-3)],
        against: Some(Variable::TurnRate),
        reading: "Two lines of opposite slope through zero. The jumps in the middle are the change \
                  between turning left and right at low speed, where bins are narrow.",
        ..PLAIN
    },
    Case {
        id: "caster_drag",
        hidden: &[("f_c", 0.012)],
        against: Some(Variable::ForwardSpeed),
        reading: "A step where the forward speed changes sign, the same on both wheels, from +f_c \
                  backward to -f_c forward.",
        ..PLAIN
    },
    Case {
        id: "sliding_caster",
        hidden: &[("f_k", 0.015), ("d_k", 1.2)],
        against: Some(Variable::TurnRate),
        reading: "A step where the turn changes sign, of opposite sign on the two wheels, and the same over the forward \
                  speed with one sign on both: each is as high as it is where the other speed is small, and lower in \
                  curves, where the one force has a part of either.",
        ..PLAIN
    },
    Case {
        id: "payload",
        hidden: &[("mp", 2.0), ("ip", 0.02), ("sp", 0.0)],
        held: &[("a1", 1.0), ("a2", 1.0)],
        against: Some(Variable::Acceleration1),
        reading: "The line of wheel 1 falls with its acceleration: inertia is missing. Wheel 2 \
                  falls less, because the wheels only sometimes speed up together.",
        ..PLAIN
    },
    Case {
        id: "lateral_com",
        hidden: &[("m", 4e-4)],
        against: Some(Variable::Acceleration1),
        reading: "The line of wheel 1 falls with its acceleration, as if its inertia were larger \
                  than the common a1; wheel 2, whose inertia is smaller, has a rising line over \
                  its own acceleration.",
        ..PLAIN
    },
    Case {
        id: "wheel_radius_mismatch",
        hidden: &[("eps", 0.03), ("epd", 0.0)],
        against: Some(Variable::Acceleration1),
        reading: "The line of wheel 1 falls with its acceleration, as of a lateral centre of mass; \
                  the part that distinguishes the two is small and shows at high speed straight \
                  ahead.",
        ..PLAIN
    },
    Case { id: "actuator_lag", hidden: &[("tau", 0.02)], reading: "", ..PLAIN },
    Case { id: "actuator_delay", hidden: &[("delay", 0.02)], reading: "", ..PLAIN },
    Case {
        id: "torque_gain",
        hidden: &[("g", 0.05)],
        against: Some(Variable::Input2),
        reading: "The line of wheel 2 falls with its input, although the gain of wheel 1 is wrong: \
                  the common inertia and friction have absorbed half of it and left the other \
                  half, with the opposite sign, to wheel 2. Over its own input wheel 1 has a \
                  rising line.",
        ..PLAIN
    },
    Case {
        id: "torque_saturation",
        hidden: &[("limit", 0.4)],
        against: Some(Variable::Input1),
        reading: "X",
        ..PLAIN
    },
    Case {
        id: "backlash_deadzone",
        hidden: &[("d", 0.01)],
        against: Some(Variable::Input1),
        reading: "A step on wheel 1 where its input changes sign, from +d to -d, that fades \
                  towards large torques, where the fitted inertia and friction have absorbed it.",
        ..PLAIN
    },
    Case {
        id: "torque_ripple",
        hidden: &[("n", 3.0)],
        against: Some(Variable::Alpha2),
        reading: "Three waves on wheel 2 in a turn of it. The picture has 12 bins a turn, so that \
                  orders above 6 do not show in it; the diagnosis tries orders up to 16 without \
                  bins.",
        ..PLAIN
    },
    Case {
        id: "wheel_eccentricity",
        against: Some(Variable::Alpha1),
        reading: "One wave on wheel 1 in a turn of it. Wheel 2 has its wave over its own angle.",
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
        reading: "Lines that run against each other and change sign with the turn rate: the outer \
                  wheel drags more. They come back to zero at the ends because the fastest turns \
                  are pivots, in which no wheel is the outer one.",
        ..PLAIN
    },
    Case { id: "wheel_slip", hidden: &[("cs", 0.1)], hard: true, reading: "", ..PLAIN },
    Case {
        id: "compliance",
        hidden: &[("kt", 2.0), ("dt", 0.03)],
        hard: true,
        reading: "",
        ..PLAIN
    },
];
