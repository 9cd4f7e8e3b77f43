//! The unit of the recorded input.

/// The unit of the input; inertias and friction are estimated per that unit.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
pub enum DriveUnit {
    /// Torques at the wheels [N m].
    #[default]
    #[serde(rename = "N m")]
    NewtonMetre,
    /// Motor voltages \[V\].
    #[serde(rename = "V")]
    Volt,
    /// Motor currents \[A\].
    #[serde(rename = "A")]
    Ampere,
}

impl DriveUnit {
    /// As written in files and on axes.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::NewtonMetre => "N m",
            Self::Volt => "V",
            Self::Ampere => "A",
        }
    }

    /// The unit of a parameter whose unit is `unit` when the input is in N m.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::recording::DriveUnit;
    /// assert_eq!(DriveUnit::Volt.of("N m s/rad"), "V s/rad");
    /// assert_eq!(DriveUnit::Volt.of("kg m^2"), "V s^2/rad");
    /// assert_eq!(DriveUnit::Volt.of("rad/s"), "rad/s");
    /// ```
    #[must_use]
    pub fn of(self, unit: &str) -> String {
        match self {
            Self::NewtonMetre => unit.to_string(),
            _ => unit
                .replace("kg m^2", &format!("{} s^2/rad", self.symbol()))
                .replace("N m", self.symbol()),
        }
    }
}
