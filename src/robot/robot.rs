//! The robot: a name and its construction.

use serde::{Deserialize, Serialize};

use super::{BaseParameters, Construction, Preset, RobotError, preset};

/// A two-wheel robot: its name and its construction data.
///
/// # Examples
/// ```
/// use amigo_ident::robot::Robot;
/// let robot = Robot::default();
/// assert_eq!(robot.name, "amigobot");
/// assert_eq!((robot.r(), robot.l1()), (0.05, 0.12)); // [m]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Name, as reports print it.
    pub name: String,
    /// Construction data.
    pub construction: Construction,
    /// Estimated a1..a3, for effects whose equations contain them, if the construction is unknown or the
    /// input is not a torque; in the unit of the input times s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated: Option<BaseParameters>,
    /// Name of the robot whose masses and inertias stand in for unknown ones. Whatever the recordings do not determine
    /// has its proportions, which is an assumption.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub assumed: Option<String>,
}

impl Robot {
    /// A robot from its construction data.
    ///
    /// # Errors
    /// The construction data do not pass [`Construction::check`].
    pub fn new(name: impl Into<String>, construction: Construction) -> Result<Self, RobotError> {
        construction.check()?;
        Ok(Self { name: name.into(), construction, estimated: None, assumed: None })
    }

    /// The AmigoBot of the paper.
    #[must_use]
    pub fn amigobot() -> Self {
        let construction = Construction::amigobot();
        Self { name: "amigobot".into(), construction, estimated: None, assumed: None }
    }

    /// A robot by the name of its preset; `None` if there is no such preset.
    #[must_use]
    pub fn from_preset(name: &str) -> Option<Self> {
        let of = |p: Preset| Self {
            name: p.name.into(),
            construction: p.construction,
            estimated: None,
            assumed: None,
        };
        preset(name).map(of)
    }

    /// Half track l1 \[m\].
    #[inline]
    #[must_use]
    pub const fn l1(&self) -> f64 {
        self.construction.l1_m
    }

    /// Radius r of the driven wheels \[m\].
    #[inline]
    #[must_use]
    pub const fn r(&self) -> f64 {
        self.construction.r_m
    }

    /// The parameters a1..a5 that the construction implies, eq. (15).
    #[must_use]
    pub fn parameters(&self) -> BaseParameters {
        self.construction.parameters()
    }

    /// Inertia of the body at a wheel, I = a1 - Iz1, and a3, in the unit of the input times s²: from the
    /// construction data, or a1 and a3 as estimated, because Iz1 alone cannot be estimated.
    #[must_use]
    pub fn inertia_at_wheel(&self) -> (f64, f64) {
        let built = || (self.parameters().a1 - self.construction.iz1_kg_m2, self.parameters().a3);
        self.estimated.map_or_else(built, |a| (a.a1, a.a3))
    }
}

impl Default for Robot {
    fn default() -> Self {
        Self::amigobot()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_robot_is_the_amigobot_of_the_presets() {
        assert_eq!(Robot::default(), Robot::from_preset("amigobot").unwrap());
        assert_eq!(Robot::from_preset("no such robot"), None);
    }

    #[test]
    fn a_robot_of_bad_data_is_refused() {
        let bad = Construction { r_m: 0.0, ..Construction::amigobot() };
        assert!(matches!(Robot::new("x", bad), Err(RobotError::Value { key: "r_m", .. })));
        let robot = Robot::new("x", Construction::amigobot()).unwrap();
        assert_eq!((robot.l1(), robot.r()), (0.12, 0.05));
    }
}
