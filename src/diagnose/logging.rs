//! What the logger did to the recorded signals: the most likely account of input and speeds.

use rayon::prelude::*;

use super::rivals::rivals;
use super::scale::scale_of;
use super::speed_filter::{Averaged, Search, SpeedFilter};
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, likelihood_with_scatter, log_likelihood, timed};
use crate::effects::Scale;
use crate::filter::SURE;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// The accounts that may be given beside that of the file.
#[derive(Clone, Copy, Debug)]
pub struct Accounts {
    /// Averages of the speeds over the rows.
    pub averages: bool,
    /// Changes of an input between the rows that the file describes as held.
    pub steps: bool,
}

/// An account of the recorded signals.
#[derive(Clone, Debug)]
pub struct Logging {
    /// The input between the rows.
    pub hold: Hold,
    /// The average over the rows that the speeds passed through, if any.
    pub low_pass: Option<SpeedFilter>,
    /// Parameters of the model fitted under this account, possibly beside those of an effect.
    pub p: Vec<f64>,
}

/// The account of `recordings` that is significantly more likely than the one given, in which the input is as in `hold`
/// and the speeds are those of the wheels: of those `allowed` averages of the speeds over the rows (not of `recordings`
/// with angles), and changes of the input between the rows. This is asked where a model at `p` does not explain the
/// motion within noise, or is late; `None` otherwise.
///
/// ```text
/// input over a row   M_0 dt  (held),  or  (M_0 + (M_1 - M_0) s) dt,   s uniform in (0, 1): mean 1/2, variance 1/12
/// ```
/// A controller that runs faster than the log, or beside it, has such steps. Each account is fitted with its own time
/// of the input. If the account given is as likely with an effect of the catalogue, other than a second body or a
/// delay, the two are compared again with the likeliest of these in the model: a lag shows itself at the steps too, and
/// friction that is larger at rest makes speeds late. Recordings with no more windows than parameters follow any
/// account, and show none.
#[must_use]
pub fn more_likely_logging(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    hold: Hold,
    allowed: Accounts,
) -> Option<Logging> {
    let steps = allowed.steps && hold == Hold::Constant;
    let averages = allowed.averages && !recordings.iter().any(|r| r.measured().alpha);
    if !steps && !averages {
        return None;
    }
    let scale = scale_of(model, p, recordings);
    let allowed = Accounts { averages, steps };
    let context = Context { model, recordings, scale: &scale, allowed };
    let found = context.likelier(p, hold)?;
    let Some((model, start)) = context.as_likely_with_effect(&found, hold) else {
        return Some(found.logging);
    };
    let mut logging = Context { model: &model, ..context }.likelier(&start, hold)?.logging;
    logging.p.truncate(p.len());
    Some(logging)
}

/// An account with its log-likelihood, and those of late actuators in place of its average.
struct Account {
    logging: Logging,
    likelihood: f64,
    /// Ratio of the error of its fit to noise.
    error: f64,
    rivals: Vec<f64>,
}

impl Account {
    /// Whether it is more likely than another, whose likelihood is given. The likelihood of an incomplete model counts
    /// by as much less as its squared errors, `error` times noise, are larger than noise.
    fn is_surer(&self, other: f64, error: f64) -> bool {
        self.likelihood - other > SURE * error.powi(2).max(1.0)
    }
}

/// What every account is fitted to.
struct Context<'a, 'b> {
    model: &'b Model,
    recordings: &'b [&'a Recording],
    scale: &'b Scale,
    allowed: Accounts,
}

impl<'a> Context<'a, '_> {
    fn timed(&self, model: &Model, p: &[f64], hold: Hold) -> Option<Timed<'a>> {
        timed(model, p, 0.0, self.recordings, hold, self.scale)
    }

    /// The likeliest average of the speeds over the rows, beside a fit to the speeds as recorded; the model has `count`
    /// parameters.
    fn averaged(&self, plain: &Timed, count: usize, hold: Hold) -> Option<Account> {
        let Self { model, recordings, scale, allowed } = *self;
        if !allowed.averages {
            return None;
        }
        let p = &plain.fit.p[..count];
        let search = Search { plain, model, p, recordings, hold, scale };
        let Averaged { low_pass, likelihood, p, error } = search.most_likely()?;
        let late = search.late_actuators(low_pass.low_pass);
        let rivals = late.iter().filter_map(|fit| log_likelihood(fit, recordings, hold)).collect();
        let logging = Logging { hold, low_pass: Some(low_pass), p };
        Some(Account { logging, likelihood, error, rivals })
    }

    /// Steps of the input between the rows, with the speeds as recorded and with their likeliest average.
    fn between_rows(&self, p: &[f64]) -> Vec<Account> {
        let hold = Hold::Linear;
        let Some(timed) = self.timed(self.model, p, hold) else { return vec![] };
        let of = |scatter| likelihood_with_scatter(&timed.fit, self.recordings, hold, scatter);
        let [Some(likelihood), Some(less)] = [1.0, THRESHOLDS.less_scatter].map(of) else {
            return vec![];
        };
        if likelihood <= less {
            return vec![];
        }
        let logging = Logging { hold, low_pass: None, p: timed.fit.p[..p.len()].to_vec() };
        let alone = Account { logging, likelihood, error: timed.error(), rivals: vec![] };
        [alone].into_iter().chain(self.averaged(&timed, p.len(), hold)).collect()
    }

    /// The account that is significantly more likely than the one given, with the model near `p`.
    fn likelier(&self, p: &[f64], hold: Hold) -> Option<Account> {
        let given = self.timed(self.model, p, hold)?;
        let above = given.error() > THRESHOLDS.above_floor;
        if given.fit.is_short() || !above && !given.is_late(self.scale.logging) {
            return None;
        }
        let plain = log_likelihood(&given.fit, self.recordings, hold)?;
        let is_surer = |account: &Account, other: f64, error: f64| {
            account.is_surer(account.rivals.iter().copied().fold(other, f64::max), error)
        };
        let averaged = self.averaged(&given, p.len(), hold);
        let averaged = averaged.filter(|a| is_surer(a, plain, a.error));
        let held = averaged.as_ref().map_or(plain, |averaged| averaged.likelihood);
        let between = if above && self.allowed.steps { self.between_rows(p) } else { vec![] };
        let between = between.into_iter().max_by(|a, b| a.likelihood.total_cmp(&b.likelihood));
        // the errors of steps between the rows are small by their own large noise
        let between = between.filter(|a| is_surer(a, held, given.error()));
        between.map(|account| Account { error: given.error(), ..account }).or(averaged)
    }

    /// The likeliest model with an effect of [`rivals`] with which the account given is about as likely as another one,
    /// with its parameters.
    fn as_likely_with_effect(&self, account: &Account, hold: Hold) -> Option<(Model, Vec<f64>)> {
        let likelihood = |(model, p): (Model, Vec<f64>)| {
            let fit = self.timed(&model, &p, hold)?.fit;
            let likelihood = log_likelihood(&fit, self.recordings, hold)?;
            let p = fit.p[..p.len()].to_vec();
            (!account.is_surer(likelihood, account.error)).then_some((likelihood, model, p))
        };
        let all = rivals(self.model, &account.logging.p, self.scale);
        let near = all.into_par_iter().filter_map(likelihood);
        let likeliest = near.max_by(|a, b| a.0.total_cmp(&b.0));
        likeliest.map(|(_, model, p)| (model, p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Input, simulate};
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Steps per row of the motion.
    const FINE: usize = 10;

    /// 30 s at 50 Hz of a robot with `effects` whose input takes a new value every 10 rows, `late(k)` tenths of a row after
    /// row k, and is recorded at the rows.
    fn driven(effects: &[(&str, f64)], mut late: impl FnMut() -> usize) -> Recording {
        let ids: Vec<&str> = effects.iter().map(|e| e.0).collect();
        let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
        let mut p = model.initial();
        let first = p.len() - effects.len();
        p[first..].iter_mut().zip(effects).for_each(|(p, e)| *p = e.1);
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let rows = 1500;
        let mut value = [0.3; 2];
        let mut input = Vec::new();
        for _ in 0..rows / 10 {
            let (next, after) = ([0, 1].map(|_| rng.random_range(-0.2..0.8)), late());
            input.extend((0..10 * FINE).map(|k| if k < after { value } else { next }));
            value = next;
        }
        let t: Vec<f64> = (0..input.len()).map(|k| 0.02 / FINE as f64 * k as f64).collect();
        let fine = Input { t: &t, torque: &input, hold: Hold::Constant };
        let states = simulate(&model, &p, &fine, State::default()).unwrap();
        let mut noise = |w: f64| {
            let draw: f64 = StandardNormal.sample(&mut rng);
            w + 0.01 * draw
        };
        let omega = states.iter().step_by(FINE).map(|s| s.omega.map(&mut noise)).collect();
        let every = |v: &[[f64; 2]]| v.iter().step_by(FINE).copied().collect();
        let t = t.iter().step_by(FINE).copied().collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque: every(&input) };
        Recording::new("steps", channels, DriveUnit::NewtonMetre).unwrap()
    }

    fn account(recording: &Recording) -> Option<Logging> {
        let model = Model::base(Robot::amigobot());
        let all = Accounts { averages: true, steps: true };
        more_likely_logging(&model, &model.initial(), &[recording], Hold::Constant, all)
    }

    fn found(recording: &Recording) -> bool {
        account(recording).is_some_and(|logging| logging.hold == Hold::Linear)
    }

    #[test]
    fn steps_at_scattered_times_are_no_held_input() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        assert!(found(&driven(&[], || rng.random_range(0..FINE))));
    }

    #[test]
    fn held_inputs_stay_held_late_or_with_another_effect() {
        assert!(!found(&driven(&[], || 0)));
        // the same part of a row at every step is a delay
        assert!(!found(&driven(&[], || 6)));
        assert!(!found(&driven(&[("turning_scrub", 0.05)], || 0)));
        assert!(!found(&driven(&[("actuator_lag", 0.03)], || 0)));
    }

    #[test]
    fn an_average_over_the_rows_shows_in_the_noise_of_the_speeds() {
        let share = 0.4;
        for effects in [&[][..], &[("turning_scrub", 0.05)]] {
            let recorded = driven(effects, || 0);
            let mut averaged = recorded.omega().to_vec();
            for k in 1..averaged.len() {
                let last = averaged[k - 1];
                averaged[k] = [0, 1].map(|i| last[i] + share * (averaged[k][i] - last[i]));
            }
            let found = account(&recorded.with_omega(averaged)).unwrap();
            let filter = found.low_pass.unwrap().low_pass;
            let true_s = -0.02 / (1.0_f64 - share).ln();
            // another effect adds errors that are correlated like an average
            assert!((filter.time_s / true_s - 1.0).abs() < 0.2, "{filter:?} {true_s}");
            assert_eq!(found.hold, Hold::Constant);
            assert!(account(&recorded).is_none());
        }
    }
}
