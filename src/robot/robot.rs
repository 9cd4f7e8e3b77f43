//! A robot: a name and its construction data.

use super::Construction;

/// A robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// Construction data.
    pub construction: Construction,
}

impl Robot {
    /// The paper's robot.
    #[must_use]
    pub fn amigobot() -> Self {
        Self { name: "amigobot".into(), construction: Construction::amigobot() }
    }
    /// Half track [m].
    #[must_use]
    pub fn l1(&self) -> f64 {
        self.construction.l1_m
    }
    /// Wheel radius [m].
    #[must_use]
    pub fn r(&self) -> f64 {
        self.construction.r_m
    }
}
