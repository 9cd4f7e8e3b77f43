//! A rigid body with the identified mechanics: masses and inertias of chassis and wheels.

use super::mechanics::{LeftOut, Mechanics};
use crate::recording::DriveUnit;
use crate::robot::Robot;

/// A chassis on two wheels with the identified equations of motion.
///
/// ```text
/// m_ij    J_A = 4 l1²/r² (r² M/4 - m12),   wheel i: inertia m_ii + m12 - r² M/2 about its axle
/// a3      M d = 4 l1² a3/r³,               d: centre of mass behind the axle
/// ```
/// Source: eq. (15) of the paper, solved for the body. The mass M is not identifiable from wheel recordings: it is that
/// of the construction data, limited by the identified inertias.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Body {
    /// Newton metres per unit of the input: 1 for torques.
    pub(super) scale: f64,
    /// Mass including the wheels \[kg\].
    pub(super) mass: f64,
    /// Mass of a wheel \[kg\].
    pub(super) wheel_mass: f64,
    /// Yaw inertia of the chassis about its centre of mass [kg m^2].
    pub(super) yaw: f64,
    /// Inertia of each wheel about its axle, rotors included [kg m^2].
    pub(super) wheel: [f64; 2],
    /// Distance of the chassis' centre of mass behind the axle \[m\].
    pub(super) behind: f64,
    /// Radius of the wheels and half track \[m\].
    pub(super) r: f64,
    pub(super) l1: f64,
    /// The identified mechanics, scaled to N m if the input has another unit.
    pub(super) mechanics: Mechanics,
    /// Remarks for the user, as sentences.
    pub(super) notes: Vec<String>,
}

/// Share of the straight-line inertia in wheels and rotors if it is not identifiable: an input in volts or
/// amperes determines inertias only up to a factor.
const WHEELS: f64 = 0.1;
/// Smallest value of this share if the mass of the construction data leaves less.
const LEAST: f64 = 0.02;

impl Body {
    /// The body with the identified mechanics per unit of the input.
    pub(super) fn new(mechanics: &Mechanics, robot: &Robot, drive_unit: DriveUnit) -> Self {
        let (c, r, l1) = (&robot.construction, robot.r(), robot.l1());
        let mut notes = Vec::new();
        let [m11, m12, m22] = mechanics.mass;
        let straight = m11.min(m22) + m12;
        let mut mass = c.m4_kg + c.m1_kg + c.m2_kg;
        let scale = if drive_unit == DriveUnit::NewtonMetre {
            1.0
        } else {
            let unit = drive_unit.symbol();
            let scale = 0.5 * r * r * mass / ((1.0 - WHEELS) * straight);
            notes.push(format!(
                "the input is in {unit}, so torques are known only up to a factor: {scale:.6} N m/{unit} follows from \
                 the mass of {mass:.3} kg of the construction data and {:.0} % of the inertia in wheels and rotors",
                100.0 * WHEELS
            ));
            scale
        };
        let mechanics = scaled(mechanics, scale);
        let [m11, m12, m22] = mechanics.mass;
        let straight = m11.min(m22) + m12;
        if straight - 0.5 * r * r * mass < LEAST * straight {
            mass = 2.0 * (1.0 - LEAST) * straight / (r * r);
            notes.push(format!(
                "the mass of the construction data exceeds the identified inertia; {mass:.4} kg is written"
            ));
        }
        let yaw_at_axle = 4.0 * l1 * l1 / (r * r) * (0.25 * r * r * mass - m12);
        let wheel_mass =
            c.m1_kg.min(0.25 * mass).min(0.25 * yaw_at_axle / (l1 * l1)).max(1e-6 * mass);
        let chassis = mass - 2.0 * wheel_mass;
        let behind = 4.0 * l1 * l1 * mechanics.centrifugal / (r * r * r * chassis);
        let mut yaw = yaw_at_axle - 2.0 * wheel_mass * l1 * l1 - chassis * behind * behind;
        if yaw <= 0.0 {
            yaw = 1e-3 * yaw_at_axle.abs().max(1e-9);
            notes.push(
                "the identified inertias are those of no rigid body; the yaw inertia is set to a small value"
                    .to_owned(),
            );
        }
        let wheel = [m11, m22].map(|m| m + m12 - 0.5 * r * r * mass);
        Self { scale, mass, wheel_mass, yaw, wheel, behind, r, l1, mechanics, notes }
    }

    /// Mass of the chassis without wheels \[kg\].
    pub(super) fn chassis(&self) -> f64 {
        self.mass - 2.0 * self.wheel_mass
    }

    /// Distance of the robot's centre of mass behind the axle, in half tracks.
    pub(super) fn lever(&self) -> f64 {
        self.behind * self.chassis() / (self.mass * self.l1)
    }

    /// Effects that neither the mechanics nor the format can express.
    pub(super) fn left_out(&self, by_format: Vec<LeftOut>) -> Vec<LeftOut> {
        self.mechanics.left_out.iter().cloned().chain(by_format).collect()
    }
}

fn scaled(m: &Mechanics, scale: f64) -> Mechanics {
    Mechanics {
        mass: m.mass.map(|x| scale * x),
        centrifugal: scale * m.centrifugal,
        damping: m.damping.map(|x| scale * x),
        friction: m.friction.map(|x| scale * x),
        offset: m.offset.map(|x| scale * x),
        weight: m.weight.map(|x| scale * x),
        ..m.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    #[test]
    fn the_body_of_the_construction_parameters_is_the_construction() {
        let robot = Robot::amigobot();
        let model = Model::base(robot.clone());
        let found = Mechanics::of(&model, &model.initial(), 0.0);
        let body = Body::new(&found, &robot, DriveUnit::NewtonMetre);
        let c = &robot.construction;
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        near(body.mass, c.m4_kg + 2.0 * c.m1_kg);
        near(body.wheel[0], c.iz1_kg_m2);
        near(body.behind, c.l2_m);
        // the diametral inertia of the wheels is part of the yaw inertia of the chassis
        near(body.yaw, c.iz4_kg_m2 + 2.0 * c.ix1_kg_m2);
        assert!(body.notes.is_empty());
    }

    #[test]
    fn volts_are_scaled_so_that_the_mass_is_that_of_the_construction() {
        let robot = Robot::amigobot();
        let model = Model::base(robot.clone());
        let found = Mechanics::of(&model, &model.initial(), 0.0);
        let body = Body::new(&found, &robot, DriveUnit::Volt);
        assert!((body.mass - 3.55).abs() < 1e-9 && body.notes.len() == 1);
        let straight = body.mechanics.mass[0] + body.mechanics.mass[1];
        assert!((body.wheel[0] / straight - WHEELS).abs() < 1e-9);
    }
}
