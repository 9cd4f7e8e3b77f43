//! Names within sentences: of variables, grades, and of the recordings on which errors are judged.

use crate::compare::{Acting, Variable};
use crate::study::{Grade, Judged, Study};

impl Variable {
    /// In words, for sentences.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Omega1 => "speed of wheel 1",
            Self::Omega2 => "speed of wheel 2",
            Self::Acceleration1 => "acceleration of wheel 1",
            Self::Acceleration2 => "acceleration of wheel 2",
            Self::ForwardSpeed => "forward speed",
            Self::TurnRate => "turn rate",
            Self::Heading => "heading",
            Self::Alpha1 => "angle of wheel 1",
            Self::Alpha2 => "angle of wheel 2",
            Self::Time => "time",
            Self::Input1 => "input of wheel 1",
            Self::Input2 => "input of wheel 2",
        }
    }
}

impl Acting {
    /// In words, behind the variable that it depends on.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Torque => "",
            Self::Resistance => ", as a resistance to the motion",
            Self::Gain => ", in proportion to the input",
        }
    }
}

impl Grade {
    /// The end of a sentence that begins with "The model is".
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::AtFloor => "at the noise floor",
            Self::Near => "near the noise floor",
            Self::Useful => "useful",
            Self::Poor => "poor",
            Self::NotUsable => "not usable",
        }
    }
}

impl Study {
    /// The role of the judged recordings in words.
    #[must_use]
    pub fn judged_words(&self) -> &'static str {
        if Judged::of(&self.recordings).are_held_out() { "validation" } else { "training" }
    }
}
