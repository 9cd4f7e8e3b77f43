//! A geared DC motor: voltage and current to the moment at the wheel, and back.

use serde::{Deserialize, Serialize};

use super::RobotError;

/// Constants of a brushed DC motor with a gear; inductance is neglected.
///
/// ```text
/// M = n k_t i,  V = R i + n k_t w        (w at the wheel; back-EMF constant = k_t in SI)
/// ```
///
/// The moment is what the motor produces: friction of gear and bearings belongs to the model of
/// the robot.
///
/// # Examples
/// ```
/// use amigo_ident::robot::Motor;
/// let motor = Motor::regbot();
/// assert!((motor.moment_per_ampere() - 0.1017).abs() < 1e-4); // N m/A at the wheel
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motor {
    /// Torque constant k_t at the motor's shaft [N m/A]; equals the back-EMF constant [V s/rad].
    pub torque_constant_n_m_per_a: f64,
    /// Resistance R of the armature, with driver and leads [ohm].
    pub resistance_ohm: f64,
    /// Gear ratio n: turns of the motor for one turn of the wheel [1].
    pub gear_ratio: f64,
    /// Moment of inertia of the rotor [kg m²].
    pub rotor_inertia_kg_m2: f64,
}

impl Motor {
    /// The motor of the DTU REGBOT.
    ///
    /// Source: the model script `regbot_1mg.m` of the course that uses the robot: Km = Kemf =
    /// 0.0105, RA = 3.3 ohm, NG = 9.69, JA = 1.3e-6 kg m² for one motor.
    #[must_use]
    pub const fn regbot() -> Self {
        Self {
            torque_constant_n_m_per_a: 0.0105,
            resistance_ohm: 3.3,
            gear_ratio: 9.69,
            rotor_inertia_kg_m2: 1.3e-6,
        }
    }

    /// Checks that every constant is finite and above zero.
    ///
    /// # Errors
    /// [`RobotError::Motor`] names the first that is not.
    pub fn check(&self) -> Result<(), RobotError> {
        let rows = [
            ("torque_constant_n_m_per_a", self.torque_constant_n_m_per_a),
            ("resistance_ohm", self.resistance_ohm),
            ("gear_ratio", self.gear_ratio),
            ("rotor_inertia_kg_m2", self.rotor_inertia_kg_m2),
        ];
        match rows.into_iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
            Some((key, found)) => Err(RobotError::Motor { key, found }),
            None => Ok(()),
        }
    }

    /// Moment at the wheel for one ampere, n k_t [N m/A].
    #[must_use]
    pub fn moment_per_ampere(&self) -> f64 {
        self.gear_ratio * self.torque_constant_n_m_per_a
    }

    /// Moment at the wheel [N m] for a current [A].
    #[must_use]
    pub fn moment_from_current(&self, current: f64) -> f64 {
        self.moment_per_ampere() * current
    }

    /// Moment at the wheel [N m] for a voltage [V] at a wheel speed [rad/s].
    #[must_use]
    pub fn moment_from_voltage(&self, voltage: f64, omega: f64) -> f64 {
        let k = self.moment_per_ampere();
        k * (voltage - k * omega) / self.resistance_ohm
    }

    /// Voltage [V] that gives a moment at the wheel [N m] at a wheel speed [rad/s].
    #[must_use]
    pub fn voltage_for_moment(&self, moment: f64, omega: f64) -> f64 {
        let k = self.moment_per_ampere();
        moment / k * self.resistance_ohm + k * omega
    }

    /// Inertia of the rotor seen at the wheel, n² J [kg m²]; part of a wheel's `iz1_kg_m2`.
    #[must_use]
    pub fn reflected_inertia(&self) -> f64 {
        self.gear_ratio.powi(2) * self.rotor_inertia_kg_m2
    }

    /// Viscous friction that back-EMF imitates under voltage drive, (n k_t)² / R [N m s/rad].
    #[must_use]
    pub fn back_emf_damping(&self) -> f64 {
        self.moment_per_ampere().powi(2) / self.resistance_ohm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn electrical_power_is_heat_plus_mechanical_power() {
        let motor = Motor::regbot();
        let (voltage, omega) = (6.0, 20.0);
        let moment = motor.moment_from_voltage(voltage, omega);
        let current = moment / motor.moment_per_ampere();
        let heat = motor.resistance_ohm * current * current;
        // watts of size 10, rounding only
        assert!((voltage * current - heat - moment * omega).abs() < 1e-13);
        assert!((motor.voltage_for_moment(moment, omega) - voltage).abs() < 1e-13);
        assert!((motor.moment_from_current(current) - moment).abs() < 1e-15);
    }

    #[test]
    fn back_emf_takes_moment_in_proportion_to_speed() {
        let motor = Motor::regbot();
        let lost = motor.moment_from_voltage(3.0, 0.0) - motor.moment_from_voltage(3.0, 10.0);
        assert!((lost - 10.0 * motor.back_emf_damping()).abs() < 1e-15);
    }

    #[test]
    fn the_rotor_is_most_of_the_wheel_inertia_measured_with_the_wheels_off_the_floor() {
        // measured a1 with free wheels 1.07e-4 kg m²; data sheet n² J = 1.22e-4. The data sheet
        // is an upper value, 15 % apart: agreement of the order is what is claimed
        let ratio = Motor::regbot().reflected_inertia() / 1.07e-4;
        assert!((0.85..1.15).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_motor_without_resistance_is_refused_by_name() {
        let bad = Motor { resistance_ohm: 0.0, ..Motor::regbot() };
        assert!(bad.check().unwrap_err().to_string().contains("resistance_ohm = 0"));
        assert_eq!(Motor::regbot().check(), Ok(()));
    }
}
