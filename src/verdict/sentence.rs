//! The verdict of a diagnosis as a sentence.

use crate::diagnose::{Conclusion, Diagnosis, Errors, Ranked, THRESHOLDS};
use crate::effects::Change;
use crate::identify::Estimate;
use crate::recording::DriveUnit;
use crate::report::format;
use crate::study::{FAR_BELOW_FLOOR, parameters_of};

/// What the sentence is made of.
pub(super) struct Finding<'a> {
    pub(super) conclusion: Conclusion,
    pub(super) diagnosis: &'a Diagnosis,
    pub(super) errors: &'a Errors,
    pub(super) likely: Option<&'a Ranked>,
    /// What lowers the held-out error without being accepted.
    pub(super) withheld: Option<&'a Ranked>,
    pub(super) reason: Option<Withheld>,
    pub(super) false_alarm: f64,
    /// Unit of the input.
    pub(super) unit: DriveUnit,
    /// How much less late the input is if it is held through the rows, which the model draws a line between \[s\]: half a
    /// row; `None` where it is known to be held.
    pub(super) if_held: Option<f64>,
    /// Whether speeds were recorded without angles, whose sensor may then be late.
    pub(super) speeds_alone: bool,
}

/// Why an effect that lowers the held-out error is not accepted.
#[derive(Clone, Copy)]
pub(super) enum Withheld {
    /// The 2 s simulation error rises.
    Raises,
    /// The sampling of the input leaves as much open.
    BetweenRows,
    /// Its size is within its uncertainty.
    Small,
}

impl Withheld {
    fn words(self) -> &'static str {
        match self {
            Self::Raises => {
                "the 2 s simulation error rises with it, as that of a right model may where friction decides when a \
                 wheel stops"
            }
            Self::BetweenRows => {
                "what the input does between its rows could be the reason as well; a recording at a higher rate tells"
            }
            Self::Small => "its size does not differ from zero by more than its uncertainty",
        }
    }
}

impl Finding<'_> {
    /// The verdict, with the error that is left.
    pub(super) fn sentence(&self) -> String {
        match self.conclusion {
            Conclusion::Sufficient => self.sufficient(),
            Conclusion::Missing => {
                format!("Missing: {}. {}{}", self.names(), self.error(), self.more())
            }
            // so far above its floor something is missing, whatever it is
            Conclusion::Likely if self.errors.far_above_all() => {
                format!(
                    "Something is missing. Likely, not proven: {}. {}",
                    self.likely.map_or(String::new(), of),
                    self.error()
                )
            }
            Conclusion::Likely => format!(
                "Likely missing, not proven: {}. {}",
                self.likely.map_or(String::new(), of),
                self.error()
            ),
            Conclusion::Unknown if self.diagnosis.steps.is_empty() => {
                format!(
                    "Something is missing that the catalogue does not explain. {}",
                    self.error()
                )
            }
            Conclusion::Unknown => format!(
                "Something is missing that the catalogue does not explain. Found: {}. {}{}",
                self.names(),
                self.error(),
                self.in_place()
            ),
        }
    }

    fn sufficient(&self) -> String {
        match self.withheld {
            Some(ranked) => format!(
                "Nothing is proven to be missing. {} With {} the held-out error falls by {:.0} %, but {}.",
                self.error(),
                named(ranked),
                lowered(ranked),
                self.reason.map_or("it is not proven", Withheld::words)
            ),
            None if self.errors.above_floor() && !self.errors.above_input() => format!(
                "Nothing is proven to be missing: none of the effects of the catalogue is proven at a \
                 false-alarm rate of {:.0} %. {} A recording at the rate of the controller tells.",
                100.0 * self.false_alarm,
                self.error()
            ),
            // the floor is an estimate for white noise: coloured noise of the input reaches so far too
            None if self.errors.above_floor() => format!(
                "Nothing is proven to be missing: none of the effects of the catalogue is proven at a \
                 false-alarm rate of {:.0} %, and no dependence of the residual torque is significant. {} \
                 Coloured noise of the recorded input makes that much, and so does a disturbance from \
                 outside.",
                100.0 * self.false_alarm,
                self.error()
            ),
            None => format!(
                "Nothing is missing: none of the effects of the catalogue is proven at a \
                 false-alarm rate of {:.0} %. {}",
                100.0 * self.false_alarm,
                self.error()
            ),
        }
    }

    /// The effects found, each with its size and those that these data do not distinguish from it.
    fn names(&self) -> String {
        let name = |step: &crate::diagnose::Step| {
            let sized = self.sized(&step.id) + &self.by_logging(&step.id);
            match step.equals.as_slice() {
                [] => sized,
                equals => {
                    let equals: Vec<String> = equals.iter().map(|id| title(id)).collect();
                    format!(
                        "{sized} (or {}: not distinguishable from these data)",
                        equals.join(" or ")
                    )
                }
            }
        };
        self.diagnosis.steps.iter().map(name).collect::<Vec<_>>().join(", then ")
    }

    /// "turning scrub (turning_scrub), f_t = 0.0202 N m (95 %: 0.0198 to 0.0206)"; of many parameters the
    /// first two that are estimated.
    fn sized(&self, id: &str) -> String {
        let fit = self.diagnosis.last();
        let sizes: Vec<String> = parameters_of(fit, self.unit)
            .iter()
            .filter(|p| p.effect == id && !p.estimate.fixed && p.estimate.std_error.is_finite())
            .take(SIZES)
            .map(|p| size(&p.estimate))
            .collect();
        let effects = fit.model.effects().iter();
        let description = effects.map(|e| e.description()).find(|d| d.id == id);
        let name = description.map_or_else(|| title(id), |d| format::in_text(&d.title));
        match sizes.as_slice() {
            [] => format!("{name} ({id})"),
            sizes => format!("{name} ({id}), {}", sizes.join(", ")),
        }
    }

    /// What of a shift of the input may be no property of the actuator: half a row of an input that is held between
    /// its rows, all of it where the sensor of the speeds may be late.
    fn by_logging(&self, id: &str) -> String {
        if !shifts_input(id) {
            return String::new();
        }
        let held = self.if_held.map_or_else(String::new, |time| {
            let time = format::digits(time, 2);
            format!(", {time} s of it if the input is held through its rows")
        });
        let sensor = match self.speeds_alone {
            true => ", unless the sensor of the speeds is late, which angles would show",
            false => "",
        };
        held + sensor
    }

    /// Beside more that is missing than was found, what was found may take the place of something else; a shift of the
    /// input shows in when the wheels move, and nothing else moves them earlier or later.
    fn in_place(&self) -> &'static str {
        match self.diagnosis.steps.iter().all(|s| shifts_input(&s.id)) {
            true => "",
            false => " What was found may stand for a part of what is not in the catalogue.",
        }
    }

    /// What was found explains the larger part of the error; what is left may be far above the floor all the same.
    fn more(&self) -> &'static str {
        match self.errors.far_above_all() {
            true => " More is missing than was found.",
            false => "",
        }
    }

    fn error(&self) -> String {
        let ratio = self.errors.ratio();
        if !ratio.is_finite() {
            return "The simulation of the model diverges on the judged recordings.".into();
        }
        let with = match self.diagnosis.steps.len() {
            0 => "The",
            1 => "With it the",
            _ => "With them the",
        };
        // beside little noise a ratio says more than it means
        let little = match ratio > THRESHOLDS.above_floor && !self.errors.above_floor() {
            true => format!(
                ", beyond which it is {} of the top speed",
                format::percent(self.errors.excess())
            ),
            false if !self.errors.above_input() => {
                ", as much as the input may make between its rows".to_owned()
            }
            false => String::new(),
        };
        match (self.diagnosis.steps.as_slice(), ratio <= THRESHOLDS.at_floor) {
            (_, true) if ratio < FAR_BELOW_FLOOR => format!(
                "{with} 2 s simulation error is {ratio:.2} of the noise floor, which holds all that the input may do \
                 between its rows."
            ),
            ([_, ..], true) if self.errors.was_at_floor() => format!(
                "What is missing matters little in this motion: the 2 s simulation error is at the noise floor as it \
                 was before, and falls by {}.",
                format::percent(self.errors.fall())
            ),
            (_, true) => format!("{with} 2 s simulation error is at the noise floor."),
            ([], false) => {
                format!("The 2 s simulation error is {ratio:.1} times the noise floor{little}.")
            }
            (_, false) => format!(
                "This removes {} of the error above the noise floor; the 2 s simulation error is still \
                 {ratio:.1} times the floor{little}.",
                removed(self.errors.unexplained())
            ),
        }
    }

    /// The effect that is likely beside what the sentence says of it; empty where it is said already.
    pub(super) fn likely_beside(&self) -> String {
        match (self.conclusion, self.likely) {
            (Conclusion::Missing | Conclusion::Unknown, Some(ranked)) => {
                format!(" Likely, not proven: {}.", of(ranked))
            }
            _ => String::new(),
        }
    }
}

/// Whether an effect of the catalogue shifts the input in time.
fn shifts_input(id: &str) -> bool {
    crate::effects::find(id).is_some_and(|e| e.change() == Change::TimeShift)
}

/// The share of the squared error that went, in words that do not round what is left away.
fn removed(left: f64) -> String {
    let percent = 100.0 * (1.0 - left);
    if left > 0.0 && percent >= 99.0 { "more than 99 %".into() } else { format!("{percent:.0} %") }
}

/// Parameters of an effect that a sentence gives.
const SIZES: usize = 2;

/// The name of an effect of the catalogue within a sentence; the id of any other in words.
pub(crate) fn title(id: &str) -> String {
    let known = crate::effects::find(id).map(|effect| effect.description().title);
    known.map_or_else(|| id.replace('_', " "), |title| format::in_text(&title))
}

/// "f_t = 0.0202 N m (95 %: 0.0198 to 0.0206)".
fn size(e: &Estimate) -> String {
    let (low, high) = e.interval;
    // to the first digit of the standard error
    let decimals = (-e.std_error.log10().floor()).clamp(0.0, 9.0) as usize;
    let fixed = |v: f64| format::fixed(v, decimals);
    let unit = format::unit(&e.unit);
    let unit = if unit.is_empty() || unit == "1" { String::new() } else { format!(" {unit}") };
    format!("{} = {}{unit} (95 %: {} to {})", e.symbol, fixed(e.value), fixed(low), fixed(high))
}

fn of(ranked: &Ranked) -> String {
    format!("{}, which lowers the held-out error by {:.0} %", named(ranked), lowered(ranked))
}

/// "turning scrub (turning_scrub)".
fn named(ranked: &Ranked) -> String {
    let id = &ranked.candidate.id;
    format!("{} ({id})", title(id))
}

/// By how much a candidate lowers the held-out error [%].
fn lowered(ranked: &Ranked) -> f64 {
    ranked.fall.map_or(0.0, |fall| 100.0 * (1.0 - fall.ratio))
}
