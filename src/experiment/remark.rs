//! Remarks on settings of an experiment file with unexpected consequences.

use std::fmt;

use crate::recording::DriveUnit;
use crate::simulate::WINDOW;

/// A remark on a file or its recordings.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// Interpretation of the columns of recordings without an experiment file, as text of `experiment new`.
    Columns(String),
    /// Keys of `[simulation]` that the movement does not use.
    Unused {
        /// Without the name of the table.
        keys: Vec<&'static str>,
        /// The movement that has its own length and speed.
        movement: FixedMovement,
    },
    /// Fuzzy methods that are fitted with another gain than they are evaluated with.
    OtherGain {
        /// Their names.
        methods: Vec<String>,
    },
    /// The track of the robot is not known.
    NoTrack {
        /// Ids of the effects that depend on it.
        effects: Vec<String>,
    },
    /// The model lacks an effect that belongs to an input in its unit: back-EMF for a voltage.
    WithoutEffect {
        /// Unit of the input.
        input: DriveUnit,
        /// Id of the effect.
        effect: String,
    },
    /// A recording whose samples are those of another one of the same use.
    Twice {
        /// Name of the recording that repeats the samples.
        name: String,
        /// Name of the other.
        other: String,
    },
    /// The recordings do not determine inertias of a robot of unknown construction.
    Proportions {
        /// Whether the recordings lack turns; otherwise they lack travel other than turns on the spot.
        straight: bool,
    },
    /// The recordings on which errors are judged are shorter than the windows of the simulation error.
    ShortWindows {
        /// Length of the longest \[s\].
        longest_s: f64,
    },
    /// The wheels nearly always turn in opposite directions.
    Opposed {
        /// Share of these rows \[1\].
        share: f64,
        /// The wheel, from 0, whose angle conditioning inverted because speed and input have the other sign.
        inverted: Option<usize>,
    },
}

/// A movement with its own length and speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedMovement {
    /// The movement of the paper.
    Paper,
    /// A list of segments in the file.
    Segments,
}

impl fmt::Display for FixedMovement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Paper => "\"paper\", which is as long and as fast as the paper's",
            Self::Segments => "given as segments, which define its duration and speed",
        })
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Columns(words) => f.write_str(words),
            Self::Unused { keys, movement } => {
                let (verb, them) = if keys.len() == 1 { ("has", "it") } else { ("have", "them") };
                let keys: Vec<String> =
                    keys.iter().map(|key| format!("simulation.{key}")).collect();
                write!(
                    f,
                    "{} {verb} no effect, because the movement is {movement}; remove {them}, or use \
                     movement = \"rich\"",
                    keys.join(" and ")
                )
            }
            Self::OtherGain { methods } => write!(
                f,
                "emulator.gain = 0 applies to the evaluation only: {} is fitted with a gain of 1 1/s \
                 unless its [[method]] block sets `gain`; set gain = 0.0 there to fit the free simulation",
                methods.join(", ")
            ),
            Self::NoTrack { effects } => write!(
                f,
                "[robot] preset = \"unknown\": the path of the robot is left out, and effects that depend on the distance \
                 between its wheels ({}) are not tested; write l1_m and r_m, or a preset",
                effects.join(", ")
            ),
            Self::WithoutEffect { input, effect } => write!(
                f,
                "the input is in {} and the model has no {effect}, which belongs to it: what it causes becomes a part of \
                 the other parameters or is found as a missing effect. Write effects = [\"{effect}\"] under [model]",
                input.symbol()
            ),
            Self::Twice { name, other } => write!(
                f,
                "{name} has the same samples as {other}: they are counted twice, and the intervals are too narrow; \
                 remove one"
            ),
            Self::Proportions { straight } => {
                let (what, held, sum) = match straight {
                    true => ("turns", "a2 and a3 are", "a1 + a2"),
                    false => ("travel other than turns on the spot", "a2 is", "a1 - a2"),
                };
                write!(
                    f,
                    "the training recordings contain no {what}: unless they determine them nevertheless, only {sum} is \
                     identifiable, and {held} held at zero, because [robot] preset = \"unknown\": a1 is then that combination. \
                     Record {what}, or write the construction data"
                )
            }
            Self::ShortWindows { longest_s } => write!(
                f,
                "no recording on which errors are judged lasts {WINDOW} s: a simulation of the {WINDOW} s simulation error is as long as its \
                 recording, {longest_s:.2} s at most"
            ),
            Self::Opposed { share, inverted: Some(wheel) } => write!(
                f,
                "the wheels turn against each other in {:.0} % of the rows, because the sign of alpha{1} was inverted, which \
                 contradicts dalpha{1} and M{1}. If both angles have the right sign, write scale = -1 in dalpha{1} and \
                 M{1}, and not in alpha{1}",
                100.0 * share,
                wheel + 1
            ),
            Self::Opposed { share, inverted: None } => write!(
                f,
                "{} Then write scale = -1 in every column of that wheel",
                mirrored_question(*share)
            ),
        }
    }
}

/// The question whether one wheel has the opposite sign, for this share of rows in which the wheels turn in
/// opposite directions.
pub(super) fn mirrored_question(share: f64) -> String {
    format!(
        "the wheels turn against each other in {:.0} % of the rows: did the robot turn on the spot, or is a motor \
         mounted mirrored?",
        100.0 * share
    )
}
