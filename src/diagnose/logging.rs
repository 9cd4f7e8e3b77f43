//! What the logger did to the recorded signals: the most likely account of input and speeds.

use rayon::prelude::*;

use super::as_recorded::{AsRecorded, Rival};
use super::speed_filter::{Averaged, Search, SpeedFilter};
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, likelihood_with_scatter, log_likelihood, timed};
use crate::filter::SURE;
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

/// The account of recordings that is significantly more likely than the one `given`, in which the input is as the file
/// describes it and the speeds are those of the wheels: of those `allowed` averages of the speeds over the rows (not of
/// recordings with angles), and changes of the input between the rows. `None` too where the model of the one given
/// explains the motion within noise and is not late.
///
/// ```text
/// input over a row   M_0 dt  (held),  or  (M_0 + (M_1 - M_0) s) dt,   s uniform in (0, 1): mean 1/2, variance 1/12
/// ```
/// A controller that runs faster than the log, or beside it, has such steps. Each account is fitted with its own time
/// of the input. If the account given is as likely with an effect of the catalogue other than a delay, the two are
/// compared again with the likeliest of these in the model: a lag and a slipping wheel show themselves at the steps too,
/// and friction that is larger at rest makes speeds late. Recordings with no more windows than parameters follow any
/// account, and show none.
#[must_use]
pub fn more_likely_logging(given: &AsRecorded, allowed: Accounts) -> Option<Logging> {
    let steps = allowed.steps && given.hold == Hold::Constant;
    let averages = allowed.averages && !given.recordings.iter().any(|r| r.measured().alpha);
    if !steps && !averages {
        return None;
    }
    let allowed = Accounts { averages, steps };
    let context = Context { given, allowed };
    let found = context.likelier()?;
    let Some(rival) = context.as_likely_with_effect(&found) else {
        return Some(found.logging);
    };
    let given_too = given.with_model(&rival.model, rival.p());
    let mut logging = Context { given: &given_too, allowed }.likelier()?.logging;
    logging.p.truncate(given.p.len());
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

/// The account given, and those beside it.
struct Context<'a, 'b> {
    given: &'b AsRecorded<'a>,
    allowed: Accounts,
}

impl Context<'_, '_> {
    /// The likeliest average of the speeds over the rows, beside a fit to the speeds as recorded.
    fn averaged(&self, plain: &Timed, hold: Hold) -> Option<Account> {
        let AsRecorded { model, p, recordings, scale, .. } = self.given;
        if !self.allowed.averages {
            return None;
        }
        let p = &plain.fit.p[..p.len()];
        let search = Search { plain, model, p, recordings, hold, scale };
        let Averaged { low_pass, likelihood, p, error } = search.most_likely()?;
        let late = search.late_actuators(low_pass.low_pass);
        let rivals = late.iter().filter_map(|fit| log_likelihood(fit, recordings, hold)).collect();
        let logging = Logging { hold, low_pass: Some(low_pass), p };
        Some(Account { logging, likelihood, error, rivals })
    }

    /// Steps of the input between the rows, with the speeds as recorded and with their likeliest average.
    fn between_rows(&self) -> Vec<Account> {
        let hold = Hold::Linear;
        let AsRecorded { model, p, recordings, scale, .. } = self.given;
        let Some(timed) = timed(model, p, 0.0, recordings, hold, scale) else { return vec![] };
        let of = |scatter| likelihood_with_scatter(&timed.fit, recordings, hold, scatter);
        let [Some(likelihood), Some(less)] = [1.0, THRESHOLDS.less_scatter].map(of) else {
            return vec![];
        };
        if likelihood <= less {
            return vec![];
        }
        let logging = Logging { hold, low_pass: None, p: timed.fit.p[..p.len()].to_vec() };
        let alone = Account { logging, likelihood, error: timed.error(), rivals: vec![] };
        [alone].into_iter().chain(self.averaged(&timed, hold)).collect()
    }

    /// The account that is significantly more likely than the one given.
    fn likelier(&self) -> Option<Account> {
        let AsRecorded { recordings, hold, scale, .. } = self.given;
        let given = self.given.fit()?;
        let above = given.error() > THRESHOLDS.above_floor;
        if given.fit.is_short() || !above && !given.is_late(scale.logging) {
            return None;
        }
        let plain = log_likelihood(&given.fit, recordings, *hold)?;
        let is_surer = |account: &Account, other: f64, error: f64| {
            account.is_surer(account.rivals.iter().copied().fold(other, f64::max), error)
        };
        let averaged = self.averaged(given, *hold);
        let averaged = averaged.filter(|a| is_surer(a, plain, a.error));
        let held = averaged.as_ref().map_or(plain, |averaged| averaged.likelihood);
        let between = if above && self.allowed.steps { self.between_rows() } else { vec![] };
        let between = between.into_iter().max_by(|a, b| a.likelihood.total_cmp(&b.likelihood));
        // the errors of steps between the rows are small by their own large noise
        let between = between.filter(|a| is_surer(a, held, given.error()));
        between.map(|account| Account { error: given.error(), ..account }).or(averaged)
    }

    /// The likeliest model with an effect more with which the account given is about as likely as another one.
    fn as_likely_with_effect(&self, account: &Account) -> Option<&Rival> {
        let near = |rivals| self.likeliest(rivals, account);
        near(self.given.rivals()).or_else(|| near(self.given.second_bodies()))
    }

    /// The likeliest of the rivals that are about as likely as an account.
    fn likeliest<'b>(&self, rivals: &'b [Rival], account: &Account) -> Option<&'b Rival> {
        let AsRecorded { recordings, hold, .. } = self.given;
        let near = rivals.par_iter().filter_map(|rival| {
            let likelihood = log_likelihood(&rival.fit, recordings, *hold)?;
            (!account.is_surer(likelihood, account.error)).then_some((likelihood, rival))
        });
        near.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, rival)| rival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit, Recording};
    use crate::robot::{Robot, State};
    use crate::simulate::{Input, simulate};
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Steps per row of the motion.
    const FINE: usize = 10;

    /// 30 s at 50 Hz of a robot with `effects` whose input takes a new value every 10 rows, `late(k)` tenths of a row
    /// after row k, and is recorded at the rows.
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
        let recordings = [recording];
        let given = AsRecorded::new(&model, &model.initial(), &recordings, Hold::Constant);
        more_likely_logging(&given, all)
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
