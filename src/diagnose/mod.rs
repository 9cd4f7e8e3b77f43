//! Which effect is missing: candidates, evidence, equivalence, the verdict, the next run.

mod candidate;
mod drive_noise;
mod joint;
mod judge;
mod next_run;
mod outcome;
mod refit;
mod scan;
mod shapes;
mod signals;
mod stepwise;
mod verdict;

pub use candidate::{Candidate, Form, candidates};
pub use judge::{Judge, Judgement};
pub use next_run::{Limits, Proposal, Rivals, next_run};
pub use outcome::{Diagnosis, Ranked};
pub use refit::{Refit, refit};
pub use scan::{Score, scan};
pub use stepwise::{Settings, diagnose};
pub use verdict::{Conclusion, Errors, conclude, probabilities, structure};
