//! Which effect is missing: candidates, screening, acceptance, the verdict, the next run.

mod acceptance;
mod aligned;
mod as_recorded;
mod balance;
mod by_recording;
mod candidate;
mod candidates;
mod cubic;
mod cutoff;
mod dead_time;
mod differences;
mod evidence;
mod fit;
mod hold;
mod input_timing;
mod joint;
mod judge;
mod low_pass;
mod next_run;
mod onset;
mod other_times;
mod outcome;
mod phases;
mod regression;
mod rivals;
mod row_means;
mod scale;
mod screen;
mod search;
mod shapes;
mod signals;
mod smoothed;
mod speed_filter;
mod spline;
mod thresholds;
mod timing;
mod untimed;
mod verdict;
mod whole;
mod windows;

pub use acceptance::Fall;
pub use as_recorded::AsRecorded;
pub use candidate::{Candidate, Form};
pub use candidates::candidates;
pub use cutoff::cutoff;
pub use dead_time::Timing;
pub use differences::{Difference, difference};
pub use fit::{WindowFit, fit};
pub use hold::{Acting, Course, Known, course_of_input};
pub use input_timing::{SYMBOL as INPUT_SHIFT, shifted, with_later_input};
pub use judge::{Judge, Judgement, Sampling};
pub use logging::{Accounts, Logging, more_likely_logging};
pub use low_pass::{Computed, LowPass};
pub use next_run::{Limits, Proposal, Rivals, next_run};
pub use other_times::other_times_as_good;
pub use outcome::{Diagnosis, Ranked, Step};
pub use phases::{Phase, phases};
pub use row_means::with_line_of_means;
pub use scale::scale_of;
pub use search::{Data, Progress, Settings, StartAngle, diagnose, start_angles};
pub use shapes::shapes_placed;
pub use speed_filter::{SpeedFilter, speed_filter};
pub use thresholds::{THRESHOLDS, Thresholds};
pub use timing::timing;
pub use untimed::Untimed;
pub use verdict::{
    Conclusion, Errors, conclude, explainable, is_refuted, likely, probabilities, structure,
    structured, structured_by_blocks, withheld,
};
pub use windows::{Windows, mobility};

#[cfg(test)]
mod logger_tests;
mod logging;
#[cfg(test)]
mod tests;
