//! Effects: the trait that an author implements, and the object-safe trait that the program uses.

use super::{
    Coupling, Description, Energy, Motion, ParameterKind, ParameterSpec, Scale, Terms, Wave,
};
use crate::math::distribution::NORMAL_95;
use crate::math::{Dual, Real, Symbol};
use crate::recording::DriveUnit;
use crate::robot::Robot;

/// A dual number with eight partial derivatives, with respect to (alpha1, alpha2, omega1, omega2, own
/// parameters 0..4).
pub type Jet = Dual<8>;

/// Number of parameters of an effect that a [`Jet`] can differentiate.
pub const DIFFERENTIATED: usize = 4;

/// A dual number with the partial derivatives with respect to the parameters of an effect only.
pub type Own = Dual<DIFFERENTIATED>;

/// A dual number with the derivative with respect to one parameter.
pub type Tangent = Dual<1>;

/// Largest number of parameters of an effect: those that are differentiated, and one integer (an order),
/// which has no derivative.
pub const MOST_PARAMETERS: usize = DIFFERENTIATED + 1;

/// Which part of the equation of motion an effect changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// It adds mass, torque or friction.
    Torque,
    /// It changes the magnitude of the input torque.
    Input,
    /// It shifts the input torque in time.
    TimeShift,
    /// It adds a second body behind the measured wheels.
    TwoMass,
}

impl Change {
    /// Whether it can compensate for the unknown input between the rows of a log: a second body moves between
    /// the rows, and an effect on the magnitude of the input can compensate for interpolated peaks.
    #[must_use]
    pub const fn acts_between_rows(self) -> bool {
        matches!(self, Self::TwoMass | Self::Input)
    }
}

/// Number of standard errors by which a parameter differs significantly from a value (95 %).
pub const SURELY: f64 = NORMAL_95;

/// Factors on the typical value of a shape parameter, if no scale is known.
const FACTORS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Definition of an effect, generic over the scalar, with at most [`MOST_PARAMETERS`] parameters.
///
/// Every method has a default without effect, so an implementation contains only what applies.
pub trait Physics: Send + Sync + 'static {
    /// Names, equation and appearance for the catalogue.
    fn description(&self) -> Description;

    /// Its parameters, in the order of `p`.
    fn parameters(&self) -> Vec<ParameterSpec>;

    /// How it treats mechanical energy.
    fn energy(&self) -> Energy;

    /// Contribution to mass, torque and dry friction at one instant.
    fn terms<T: Real>(&self, _x: &Motion<T>, _p: &[T]) -> Terms<T> {
        Terms::zero()
    }

    /// Computes the acting input from the recorded one for the whole run: `t` \[s\] and `m` [N m] have one
    /// row per sample. `None`: unchanged.
    fn input<T: Real>(&self, _t: &[f64], _m: &[[T; 2]], _p: &[T]) -> Option<Vec<[T; 2]>> {
        None
    }

    /// The second mass behind the measured wheel, if the effect has one.
    fn coupling<T: Real>(&self, _x: &Motion<T>, _p: &[T]) -> Option<Coupling<T>> {
        None
    }

    /// Whether it changes recorded torques `m` with this standard deviation of their noise by more than the noise: a
    /// change that only removes noise is none of the robot.
    fn exceeds_noise(&self, _m: &[[f64; 2]], _noise: [f64; 2], _p: &[f64]) -> bool {
        true
    }

    /// Whether [`Physics::input`] changes anything.
    fn acts_on_input(&self) -> bool {
        false
    }

    /// Whether the input is only delayed, so that the effect is indistinguishable from a shift of the rows.
    fn is_delay(&self) -> bool {
        false
    }

    /// Place of the time \[s\] in `p`, of an effect that shifts the input in time ([`Change::TimeShift`]).
    fn time(&self) -> usize {
        0
    }

    /// Whether it occurs on most robots.
    fn is_common(&self) -> bool {
        false
    }

    /// Whether it depends on the track of the robot: by the heading, or by a load away from the middle of the axle.
    fn needs_track(&self) -> bool {
        false
    }

    /// The harmonic components of its torque at shapes `p`; empty if the torque is not periodic in an angle.
    /// They are shifted if an angle starts at another value in each recording.
    fn waves(&self, _p: &[f64]) -> Vec<Wave> {
        vec![]
    }

    /// Which part of the equation it changes, if not the input ([`Physics::acts_on_input`]) or the torque.
    fn change(&self) -> Change {
        if self.acts_on_input() { Change::Input } else { Change::Torque }
    }

    /// Whether recordings of this scale can contain information on it; a second body requires
    /// [`Scale::two_bodies`].
    fn admissible(&self, scale: &Scale) -> bool {
        self.change() != Change::TwoMass || scale.two_bodies
    }

    /// Values of its shape parameters to be tried on recordings of this scale, each entry one value per shape
    /// parameter; a single empty entry if there are none.
    fn shapes(&self, _scale: &Scale) -> Vec<Vec<f64>> {
        let parameters = self.parameters();
        let typical: Vec<f64> = parameters
            .iter()
            .filter(|s| s.kind == ParameterKind::Shape)
            .map(|s| s.typical)
            .collect();
        let Some(first) = typical.first().copied() else { return vec![vec![]] };
        let with = |factor: f64| {
            let mut values = typical.clone();
            values[0] = factor * first;
            values
        };
        FACTORS.map(with).to_vec()
    }

    /// Whether a fit must be started from each of its shapes, because the cost has several minima, as for a
    /// second body.
    fn several_starts(&self) -> bool {
        self.change() == Change::TwoMass
    }

    /// Smallest and largest value of each parameter on recordings of that scale.
    fn limits(&self, _scale: &Scale) -> Vec<(f64, f64)> {
        self.parameters().iter().map(|s| s.range).collect()
    }

    /// Moves parameter values to where a fit can start: shapes into their ranges. Linear parameters may have
    /// either sign, so that the estimates of an absent effect are distributed around zero. Values that are
    /// not `free` stay unchanged.
    fn start(&self, p: &mut [f64], _free: &[bool]) {
        for (value, spec) in p.iter_mut().zip(self.parameters()) {
            if spec.kind == ParameterKind::Shape {
                *value = value.clamp(spec.range.0, spec.range.1);
            }
        }
    }

    /// Whether it is part of every model whose input was recorded in this unit.
    fn belongs_to(&self, _input: DriveUnit) -> bool {
        false
    }

    /// Whether parameters within their limits together describe this effect; otherwise the estimate has
    /// absorbed something else. `robot` is that of the model.
    fn is_itself(&self, _p: &[f64], _errors: &[f64], _robot: &Robot) -> bool {
        true
    }
}

/// Object-safe interface of an effect: [`Physics`] without its type parameters.
pub trait Effect: Send + Sync {
    /// Names, equation and appearance.
    fn description(&self) -> Description;
    /// The id used in experiment files.
    fn id(&self) -> String {
        self.description().id
    }
    /// Specification of its parameters, in their order.
    fn parameters(&self) -> Vec<ParameterSpec>;
    /// How it treats mechanical energy.
    fn energy(&self) -> Energy;
    /// [`Physics::terms`] with `f64`.
    fn terms(&self, x: &Motion<f64>, p: &[f64]) -> Terms<f64>;
    /// The torque of [`Physics::terms`] only, for the inner loop of simulations.
    fn torque(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 2];
    /// The mass matrix of [`Physics::terms`] alone.
    fn mass(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 3];
    /// The levels of dry friction of [`Physics::terms`] alone.
    fn level(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 4];
    /// [`Physics::terms`] with derivatives.
    fn terms_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> Terms<Jet>;
    /// [`Physics::terms`] with derivatives with respect to its own parameters only.
    fn terms_own(&self, x: &Motion<Own>, p: &[Own]) -> Terms<Own>;
    /// The torque of [`Effect::terms_own`] alone.
    fn torque_own(&self, x: &Motion<Own>, p: &[Own]) -> [Own; 2];
    /// The torque of [`Effect::terms_jet`] alone.
    fn torque_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> [Jet; 2];
    /// [`Physics::terms`] with symbols, which record the formula.
    fn terms_symbolic(&self, x: &Motion<Symbol>, p: &[Symbol]) -> Terms<Symbol>;
    /// [`Physics::input`] with `f64`.
    fn input(&self, t: &[f64], m: &[[f64; 2]], p: &[f64]) -> Option<Vec<[f64; 2]>>;
    /// [`Physics::input`] with derivatives.
    fn input_own(&self, t: &[f64], m: &[[Own; 2]], p: &[Own]) -> Option<Vec<[Own; 2]>>;
    /// [`Physics::input`] with the derivative with respect to one parameter.
    fn input_tangent(
        &self,
        t: &[f64],
        m: &[[Tangent; 2]],
        p: &[Tangent],
    ) -> Option<Vec<[Tangent; 2]>>;
    /// [`Physics::input`] with symbols.
    fn input_symbolic(
        &self,
        t: &[f64],
        m: &[[Symbol; 2]],
        p: &[Symbol],
    ) -> Option<Vec<[Symbol; 2]>>;
    /// [`Physics::coupling`] with `f64`.
    fn coupling(&self, x: &Motion<f64>, p: &[f64]) -> Option<Coupling<f64>>;
    /// [`Physics::coupling`] with derivatives.
    fn coupling_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> Option<Coupling<Jet>>;
    /// [`Physics::coupling`] with symbols.
    fn coupling_symbolic(&self, x: &Motion<Symbol>, p: &[Symbol]) -> Option<Coupling<Symbol>>;
    /// [`Physics::exceeds_noise`].
    fn exceeds_noise(&self, m: &[[f64; 2]], noise: [f64; 2], p: &[f64]) -> bool;
    /// Whether it changes the input.
    fn acts_on_input(&self) -> bool;
    /// [`Physics::is_delay`].
    fn is_delay(&self) -> bool;
    /// [`Physics::time`].
    fn time(&self) -> usize;
    /// [`Physics::is_common`].
    fn is_common(&self) -> bool;
    /// [`Physics::needs_track`].
    fn needs_track(&self) -> bool;
    /// [`Physics::waves`].
    fn waves(&self, p: &[f64]) -> Vec<Wave>;
    /// Whether its torque has components that are periodic in an angle.
    fn has_waves(&self) -> bool {
        let typical: Vec<f64> = self.parameters().iter().map(|spec| spec.typical).collect();
        !self.waves(&typical).is_empty()
    }
    /// [`Physics::change`].
    fn change(&self) -> Change;
    /// [`Physics::admissible`].
    fn admissible(&self, scale: &Scale) -> bool;
    /// [`Physics::shapes`].
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>>;
    /// [`Physics::several_starts`].
    fn several_starts(&self) -> bool;
    /// [`Physics::limits`].
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)>;
    /// [`Physics::start`].
    fn start(&self, p: &mut [f64], free: &[bool]);
    /// [`Physics::belongs_to`].
    fn belongs_to(&self, input: DriveUnit) -> bool;
    /// [`Physics::is_itself`].
    fn is_itself(&self, p: &[f64], errors: &[f64], robot: &Robot) -> bool;
}

impl<P: Physics> Effect for P {
    fn description(&self) -> Description {
        Physics::description(self)
    }
    fn parameters(&self) -> Vec<ParameterSpec> {
        Physics::parameters(self)
    }
    fn energy(&self) -> Energy {
        Physics::energy(self)
    }
    fn terms(&self, x: &Motion<f64>, p: &[f64]) -> Terms<f64> {
        Physics::terms(self, x, p)
    }
    fn torque(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 2] {
        Physics::terms(self, x, p).torque
    }
    fn mass(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 3] {
        Physics::terms(self, x, p).mass
    }
    fn level(&self, x: &Motion<f64>, p: &[f64]) -> [f64; 4] {
        Physics::terms(self, x, p).level
    }
    fn terms_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> Terms<Jet> {
        Physics::terms(self, x, p)
    }
    fn terms_own(&self, x: &Motion<Own>, p: &[Own]) -> Terms<Own> {
        Physics::terms(self, x, p)
    }
    fn torque_own(&self, x: &Motion<Own>, p: &[Own]) -> [Own; 2] {
        Physics::terms(self, x, p).torque
    }
    fn torque_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> [Jet; 2] {
        Physics::terms(self, x, p).torque
    }
    fn terms_symbolic(&self, x: &Motion<Symbol>, p: &[Symbol]) -> Terms<Symbol> {
        Physics::terms(self, x, p)
    }
    fn input(&self, t: &[f64], m: &[[f64; 2]], p: &[f64]) -> Option<Vec<[f64; 2]>> {
        Physics::input(self, t, m, p)
    }
    fn input_own(&self, t: &[f64], m: &[[Own; 2]], p: &[Own]) -> Option<Vec<[Own; 2]>> {
        Physics::input(self, t, m, p)
    }
    fn input_tangent(
        &self,
        t: &[f64],
        m: &[[Tangent; 2]],
        p: &[Tangent],
    ) -> Option<Vec<[Tangent; 2]>> {
        Physics::input(self, t, m, p)
    }
    fn input_symbolic(
        &self,
        t: &[f64],
        m: &[[Symbol; 2]],
        p: &[Symbol],
    ) -> Option<Vec<[Symbol; 2]>> {
        Physics::input(self, t, m, p)
    }
    fn coupling(&self, x: &Motion<f64>, p: &[f64]) -> Option<Coupling<f64>> {
        Physics::coupling(self, x, p)
    }
    fn coupling_jet(&self, x: &Motion<Jet>, p: &[Jet]) -> Option<Coupling<Jet>> {
        Physics::coupling(self, x, p)
    }
    fn coupling_symbolic(&self, x: &Motion<Symbol>, p: &[Symbol]) -> Option<Coupling<Symbol>> {
        Physics::coupling(self, x, p)
    }
    fn exceeds_noise(&self, m: &[[f64; 2]], noise: [f64; 2], p: &[f64]) -> bool {
        Physics::exceeds_noise(self, m, noise, p)
    }
    fn acts_on_input(&self) -> bool {
        Physics::acts_on_input(self)
    }
    fn is_delay(&self) -> bool {
        Physics::is_delay(self)
    }
    fn time(&self) -> usize {
        Physics::time(self)
    }
    fn is_common(&self) -> bool {
        Physics::is_common(self)
    }
    fn needs_track(&self) -> bool {
        Physics::needs_track(self)
    }
    fn waves(&self, p: &[f64]) -> Vec<Wave> {
        Physics::waves(self, p)
    }
    fn change(&self) -> Change {
        Physics::change(self)
    }
    fn admissible(&self, scale: &Scale) -> bool {
        Physics::admissible(self, scale)
    }
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        Physics::shapes(self, scale)
    }
    fn several_starts(&self) -> bool {
        Physics::several_starts(self)
    }
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        Physics::limits(self, scale)
    }
    fn start(&self, p: &mut [f64], free: &[bool]) {
        Physics::start(self, p, free);
    }
    fn belongs_to(&self, input: DriveUnit) -> bool {
        Physics::belongs_to(self, input)
    }
    fn is_itself(&self, p: &[f64], errors: &[f64], robot: &Robot) -> bool {
        Physics::is_itself(self, p, errors, robot)
    }
}
