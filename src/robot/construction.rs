//! Construction data: lengths, masses, inertias, loads; the parameters a1..a5 from them.

use serde::{Deserialize, Serialize};

use super::{BaseParameters, RobotError};

/// Construction data of a two-wheel robot; the field names are the keys of the experiment file.
///
/// The two wheels are alike, so one wheel radius and one set of wheel inertias are used for both.
/// The caster (index 3) is not in the equations of motion; its values may be omitted in a file
/// and are then 0. `l5_m` is needed only by effects of the caster.
///
/// Source: the paper, Tables 1 and 2.
///
/// Deviation: the tables list r1 = r2, Ix1 = Ix2 and Iz1 = Iz2 twice; here each is given once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Construction {
    /// Half track: distance from A, the middle of the axle, to each wheel \[m\].
    pub l1_m: f64,
    /// Distance of the centre of mass S of the frame behind the axle \[m\]; negative if it lies
    /// ahead of the axle.
    pub l2_m: f64,
    /// Distance from A to the point H of the frame, along the frame \[m\]; not in the equations.
    #[serde(default)]
    pub l3_m: f64,
    /// Distance from A to the point H of the frame, vertically \[m\]; not in the equations.
    #[serde(default)]
    pub l4_m: f64,
    /// Distance of the caster behind the axle \[m\]; negative if it lies ahead.
    #[serde(default)]
    pub l5_m: f64,
    /// Radius of the driven wheels \[m\].
    pub r_m: f64,
    /// Radius of the caster's wheel \[m\]; not in the equations.
    #[serde(default)]
    pub r3_m: f64,
    /// Mass of wheel 1, the right wheel \[kg\].
    pub m1_kg: f64,
    /// Mass of wheel 2, the left wheel \[kg\]; equal to that of wheel 1.
    pub m2_kg: f64,
    /// Mass of the caster \[kg\]; not in the equations.
    #[serde(default)]
    pub m3_kg: f64,
    /// Mass of the frame \[kg\].
    pub m4_kg: f64,
    /// Moment of inertia of a driven wheel about its vertical diameter [kg m²].
    pub ix1_kg_m2: f64,
    /// Moment of inertia of the caster about its vertical diameter [kg m²]; not in the equations.
    #[serde(default)]
    pub ix3_kg_m2: f64,
    /// Moment of inertia of a driven wheel about its axle, with everything that turns with it
    /// (a rotor behind a gear of ratio n counts n² times) [kg m²].
    pub iz1_kg_m2: f64,
    /// Moment of inertia of the caster about its axle [kg m²]; not in the equations.
    #[serde(default)]
    pub iz3_kg_m2: f64,
    /// Moment of inertia of the frame about the vertical through its centre of mass S [kg m²].
    pub iz4_kg_m2: f64,
    /// Load on wheel 1 \[N\].
    pub n1_n: f64,
    /// Load on wheel 2 \[N\].
    pub n2_n: f64,
    /// Load on the caster \[N\]; not in the equations.
    #[serde(default)]
    pub n3_n: f64,
    /// Arm of the rolling friction of wheel 1 \[m\].
    pub f1_m: f64,
    /// Arm of the rolling friction of wheel 2 \[m\].
    pub f2_m: f64,
    /// Arm of the rolling friction of the caster \[m\]; not in the equations.
    #[serde(default)]
    pub f3_m: f64,
}

/// Upper limit of the absolute value of a construction datum; the reciprocal is the lower limit of positive
/// values.
const LARGEST: f64 = 1e12;

/// Allowed range of a construction datum.
#[derive(Clone, Copy)]
enum Range {
    Positive,
    NotNegative,
    Any,
}

impl Range {
    fn holds(self, x: f64) -> bool {
        x.abs() <= LARGEST
            && match self {
                Self::Positive => x >= 1.0 / LARGEST,
                Self::NotNegative => x >= 0.0,
                Self::Any => true,
            }
    }

    const fn in_words(self) -> &'static str {
        match self {
            Self::Positive => "a finite number above zero",
            Self::NotNegative => "a finite number, zero or above",
            Self::Any => "a finite number",
        }
    }
}

impl Construction {
    /// The AmigoBot of the paper.
    ///
    /// Source: the paper, Tables 1 and 2.
    ///
    /// The inertias of the wheels are large for their mass: 0.025 kg m² is thirty times the
    /// m1 r²/2 of a disc, so they must contain what turns behind the gears. They are kept as
    /// printed; the columns around Iz3 are ambiguous in the copy at hand and are read as
    /// Iz1 = Iz2 = 0.025, Iz3 = 0.0018, Iz4 = 0.06.
    #[must_use]
    pub const fn amigobot() -> Self {
        Self {
            l1_m: 0.12,
            l2_m: 0.06,
            l3_m: 0.08,
            l4_m: 0.03,
            l5_m: 0.12,
            r_m: 0.05,
            r3_m: 0.03,
            m1_kg: 0.65,
            m2_kg: 0.65,
            m3_kg: 0.4,
            m4_kg: 2.25,
            ix1_kg_m2: 0.01,
            ix3_kg_m2: 0.004,
            iz1_kg_m2: 0.025,
            iz3_kg_m2: 0.0018,
            iz4_kg_m2: 0.06,
            n1_n: 12.5,
            n2_n: 12.5,
            n3_n: 11.7,
            f1_m: 0.01,
            f2_m: 0.01,
            f3_m: 0.001,
        }
    }

    /// The parameters a1..a5 of the equations of motion that the construction implies.
    ///
    /// ```text
    /// a1 = (r² m4 l1² + 4 r² m1 l1² + 2 r² Ix1 + 4 Iz1 l1² + r² Iz4 + r² m4 l2²) / (4 l1²)
    /// a2 = (r² m4 l1² - r² m4 l2² - 2 r² Ix1 - r² Iz4) / (4 l1²)
    /// a3 = r³ m4 l2 / (4 l1²)
    /// a4 = N1 f1,  a5 = N2 f2
    /// ```
    ///
    /// Source: the paper, eq. (15).
    ///
    /// Deviation: the transcription lost the minus signs of a2; they follow from the kinetic
    /// energy, see `maggi.rs`.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::robot::Construction;
    /// let a = Construction::amigobot().parameters();
    /// assert!((a.a4 - 0.125).abs() < 1e-15); // 12.5 N times 0.01 m
    /// ```
    #[must_use]
    pub fn parameters(&self) -> BaseParameters {
        let (l1, l2, r) = (self.l1_m, self.l2_m, self.r_m);
        let (m1, m4) = (self.m1_kg, self.m4_kg);
        let (ix1, iz1, iz4) = (self.ix1_kg_m2, self.iz1_kg_m2, self.iz4_kg_m2);
        let (l1_2, l2_2, r_2) = (l1 * l1, l2 * l2, r * r);
        // eq. (15)
        BaseParameters {
            a1: (r_2 * m4 * l1_2
                + 4.0 * r_2 * m1 * l1_2
                + 2.0 * r_2 * ix1
                + 4.0 * iz1 * l1_2
                + r_2 * iz4
                + r_2 * m4 * l2_2)
                / (4.0 * l1_2),
            a2: (r_2 * m4 * l1_2 - r_2 * m4 * l2_2 - 2.0 * r_2 * ix1 - r_2 * iz4) / (4.0 * l1_2),
            a3: r_2 * r * m4 * l2 / (4.0 * l1_2),
            a4: self.n1_n * self.f1_m,
            a5: self.n2_n * self.f2_m,
        }
    }

    /// Checks that every value is finite and in its range, and that the wheels are alike.
    ///
    /// # Errors
    /// [`RobotError::Value`] names the first key that is not; [`RobotError::UnequalWheels`] if
    /// `m1_kg` and `m2_kg` differ by more than 1e-9 of their size.
    pub fn check(&self) -> Result<(), RobotError> {
        for (key, found, range, meaning) in self.rows() {
            if !range.holds(found) {
                return Err(RobotError::Value { key, meaning, found, expected: range.in_words() });
            }
        }
        if (self.m1_kg - self.m2_kg).abs() > 1e-9 * self.m1_kg {
            return Err(RobotError::UnequalWheels { m1: self.m1_kg, m2: self.m2_kg });
        }
        Ok(())
    }

    /// The keys of the experiment file with their values, in the order of the paper's tables.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.rows().into_iter().map(|(key, value, ..)| (key, value))
    }

    fn rows(&self) -> [(&'static str, f64, Range, &'static str); 22] {
        use Range::{Any, NotNegative, Positive};
        [
            ("l1_m", self.l1_m, Positive, "half track, from the middle of the axle to a wheel"),
            ("l2_m", self.l2_m, Any, "distance of the centre of mass behind the axle"),
            ("l3_m", self.l3_m, Any, "distance from the axle to the point H, along the frame"),
            ("l4_m", self.l4_m, Any, "distance from the axle to the point H, vertically"),
            ("l5_m", self.l5_m, Any, "distance of the caster behind the axle"),
            ("r_m", self.r_m, Positive, "radius of the driven wheels"),
            ("r3_m", self.r3_m, NotNegative, "radius of the caster's wheel"),
            ("m1_kg", self.m1_kg, Positive, "mass of the right wheel"),
            ("m2_kg", self.m2_kg, Positive, "mass of the left wheel"),
            ("m3_kg", self.m3_kg, NotNegative, "mass of the caster"),
            ("m4_kg", self.m4_kg, Positive, "mass of the frame"),
            ("ix1_kg_m2", self.ix1_kg_m2, Positive, "inertia of a wheel about its diameter"),
            ("ix3_kg_m2", self.ix3_kg_m2, NotNegative, "inertia of the caster about its diameter"),
            ("iz1_kg_m2", self.iz1_kg_m2, Positive, "inertia of a wheel about its axle"),
            ("iz3_kg_m2", self.iz3_kg_m2, NotNegative, "inertia of the caster about its axle"),
            ("iz4_kg_m2", self.iz4_kg_m2, Positive, "yaw inertia of the frame about its centre"),
            ("n1_n", self.n1_n, NotNegative, "load on the right wheel"),
            ("n2_n", self.n2_n, NotNegative, "load on the left wheel"),
            ("n3_n", self.n3_n, NotNegative, "load on the caster"),
            ("f1_m", self.f1_m, NotNegative, "rolling-friction arm of the right wheel"),
            ("f2_m", self.f2_m, NotNegative, "rolling-friction arm of the left wheel"),
            ("f3_m", self.f3_m, NotNegative, "rolling-friction arm of the caster"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_amigobot_has_the_parameters_worked_out_by_hand() {
        let a = Construction::amigobot().parameters();
        // 4 l1² = 0.0576; with r² = 0.0025:
        // a1 numerator 8.1e-5 + 9.36e-5 + 5e-5 + 1.44e-3 + 1.5e-4 + 2.025e-5 = 1.83485e-3
        // a2 numerator 8.1e-5 - 2.025e-5 - 5e-5 - 1.5e-4 = -1.3925e-4
        // a3 numerator 1.25e-4 · 2.25 · 0.06 = 1.6875e-5; rounding only, so 1e-15
        assert!((a.a1 - 1.83485e-3 / 0.0576).abs() < 1e-15, "{}", a.a1);
        assert!((a.a2 + 1.3925e-4 / 0.0576).abs() < 1e-15, "{}", a.a2);
        assert!((a.a3 - 1.6875e-5 / 0.0576).abs() < 1e-15, "{}", a.a3);
        assert!((a.a4 - 0.125).abs() < 1e-15 && (a.a5 - 0.125).abs() < 1e-15);
    }

    #[test]
    fn a1_plus_a2_is_the_inertia_of_driving_straight_and_a1_minus_a2_that_of_turning() {
        let c = Construction::amigobot();
        let a = c.parameters();
        // straight: half the mass of the robot at radius r, and the wheel's own inertia
        let straight = c.r_m.powi(2) * (c.m4_kg / 2.0 + c.m1_kg) + c.iz1_kg_m2;
        // turning: half the yaw inertia about A, reflected by (r / l1)²
        let yaw =
            c.iz4_kg_m2 + c.m4_kg * c.l2_m.powi(2) + 2.0 * (c.ix1_kg_m2 + c.m1_kg * c.l1_m.powi(2));
        let turning = (c.r_m / c.l1_m).powi(2) * yaw / 2.0 + c.iz1_kg_m2;
        assert!((a.a1 + a.a2 - straight).abs() < 1e-16);
        assert!((a.a1 - a.a2 - turning).abs() < 1e-16);
    }

    #[test]
    fn a_bad_value_is_named_with_what_was_expected() {
        let bad = Construction { l1_m: -0.12, ..Construction::amigobot() };
        let message = bad.check().unwrap_err().to_string();
        assert!(message.contains("l1_m = -0.12, expected a finite number above zero"), "{message}");
        for broken in [f64::NAN, f64::INFINITY] {
            let bad = Construction { l2_m: broken, ..Construction::amigobot() };
            assert!(matches!(bad.check(), Err(RobotError::Value { key: "l2_m", .. })));
        }
        assert_eq!(Construction::amigobot().check(), Ok(()));
    }

    #[test]
    fn unequal_wheels_are_refused_and_a_mass_centre_ahead_of_the_axle_is_allowed() {
        let unequal = Construction { m2_kg: 0.7, ..Construction::amigobot() };
        assert_eq!(unequal.check(), Err(RobotError::UnequalWheels { m1: 0.65, m2: 0.7 }));
        let ahead = Construction { l2_m: -0.02, ..Construction::amigobot() };
        assert_eq!(ahead.check(), Ok(()));
        assert!(ahead.parameters().a3 < 0.0);
    }

    #[test]
    fn the_keys_are_the_field_names_and_the_caster_may_be_left_out() {
        let amigobot = Construction::amigobot();
        let table = toml::Table::try_from(&amigobot).unwrap();
        assert_eq!(table.len(), amigobot.values().count());
        for (key, value) in amigobot.values() {
            assert_eq!(table[key].as_float(), Some(value), "{key}");
        }
        let without_caster: toml::Table =
            table.into_iter().filter(|(key, _)| !key.contains('3') && key != "l5_m").collect();
        let read: Construction = without_caster.try_into().unwrap();
        assert_eq!(read.parameters(), amigobot.parameters());
        assert_eq!(read.l5_m, 0.0);
    }
}
