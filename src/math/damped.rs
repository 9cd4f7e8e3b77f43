//! The loop of damped Gauss-Newton methods.

/// How a minimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MinimumStatus {
    /// The expected decrease fell below the tolerance.
    Converged,
    /// The allowed number of steps was taken.
    MaxIterations,
    /// No step, however short, lowers the cost: rounding, or inconsistent gradient and cost.
    Stalled,
    /// The cost could not be computed at the start, or start, bounds and gradient differ in length.
    NoStart,
}

/// What comes next in a search.
pub(crate) enum Proposal<S> {
    /// A step to be tried.
    Step(S),
    /// No step is worth trying.
    End(MinimumStatus),
}

/// What became of a step.
pub(crate) enum Attempt {
    /// The search is where it was.
    Rejected,
    /// The search has moved.
    Accepted,
    /// The search has moved, and by so little that it has converged.
    Last,
}

/// A search by damped Gauss-Newton steps: score, information, damping and the criterion by which a step is accepted.
pub(crate) trait DampedSearch {
    /// What is tried: a place, a displacement or a share of one.
    type Step;

    /// The step from the present point after `accepted` steps, and after `rejected` failures since the last of them.
    fn propose(&mut self, accepted: usize, rejected: usize) -> Proposal<Self::Step>;

    /// Moves by a step if it is accepted.
    fn attempt(&mut self, step: Self::Step) -> Attempt;
}

/// Steps until the search ends: how, and after how many accepted steps.
pub(crate) fn take_steps<S: DampedSearch>(search: &mut S) -> (MinimumStatus, usize) {
    let (mut accepted, mut rejected) = (0, 0);
    loop {
        let step = match search.propose(accepted, rejected) {
            Proposal::Step(step) => step,
            Proposal::End(status) => return (status, accepted),
        };
        match search.attempt(step) {
            Attempt::Rejected => rejected += 1,
            Attempt::Accepted => (accepted, rejected) = (accepted + 1, 0),
            Attempt::Last => return (MinimumStatus::Converged, accepted + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newton's method for the root of 2, halving steps that do not lower |x² - 2|.
    struct Root {
        x: f64,
    }

    impl Root {
        fn left(x: f64) -> f64 {
            (x * x - 2.0).abs()
        }
    }

    impl DampedSearch for Root {
        type Step = f64;

        fn propose(&mut self, accepted: usize, rejected: usize) -> Proposal<f64> {
            match accepted {
                20 => Proposal::End(MinimumStatus::MaxIterations),
                _ if rejected == 40 => Proposal::End(MinimumStatus::Stalled),
                _ => Proposal::Step(
                    0.5_f64.powi(rejected as i32) * (2.0 - self.x * self.x) / (2.0 * self.x),
                ),
            }
        }

        fn attempt(&mut self, step: f64) -> Attempt {
            let there = self.x + step;
            if !(Self::left(there) < Self::left(self.x)) {
                return Attempt::Rejected;
            }
            self.x = there;
            if Self::left(there) < 1e-9 { Attempt::Last } else { Attempt::Accepted }
        }
    }

    #[test]
    fn rejected_steps_are_proposed_again_and_only_accepted_ones_count() {
        let mut search = Root { x: 0.1 };
        let (status, steps) = take_steps(&mut search);
        assert_eq!(status, MinimumStatus::Converged);
        // from 0.1 the whole step leads to 10, farther away: halved until it leads to less than 2
        assert!((search.x - 2.0_f64.sqrt()).abs() < 1e-9 && steps < 8, "{} {steps}", search.x);
        let (status, steps) = take_steps(&mut Root { x: 2.0_f64.sqrt() });
        assert_eq!((status, steps), (MinimumStatus::Stalled, 0));
    }
}
