//! Recordings with different initial angles: the robot was placed at another heading, or its counters were
//! reset at another wheel angle. A torque that is periodic in such an angle has another phase in each.

use nalgebra::DVector;

use super::{Criteria, Data, Search, Settings, held_in_time};
use crate::diagnose::aligned::{Aligned, within_turn};
use crate::diagnose::candidate::Candidate;
use crate::diagnose::candidates::candidates;
use crate::diagnose::fit::{WindowFit, fit};
use crate::diagnose::outcome::Ranked;
use crate::diagnose::regression::{Buffers, Regression};
use crate::diagnose::screen::Screen;
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::windows::Windows;
use crate::effects::{Cycle, Wave};
use crate::identify::{Task, start};
use crate::math::{distribution, median_high};
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::simulate::Hold;

/// Number of fits that alternate with shifts: the first shifts are of first order, with parameters that the
/// waves have biased.
const REFINEMENTS: usize = 5;

/// Where an angle of a recording starts against that of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartAngle {
    /// The angle.
    pub of: Cycle,
    /// How much later than recorded it starts \[rad\].
    pub angle_rad: f64,
    /// Standard error of that \[rad\].
    pub std_error_rad: f64,
}

impl StartAngle {
    /// How much later the angles of the wheels of `robot` start \[rad\].
    #[must_use]
    pub fn of_wheels(&self, robot: &Robot) -> [f64; 2] {
        let mut later = [0.0; 2];
        match self.of {
            Cycle::Heading => {
                let turn = self.angle_rad * robot.l1() / robot.r();
                later = [turn, -turn];
            }
            Cycle::Wheel(i) => later[i] = self.angle_rad,
        }
        later
    }
}

/// Initial angles of each of `recordings`, as far as torques periodic in them determine these: from the
/// effect of the catalogue whose periodic torques explain the error of `model` best with separate phases in
/// each recording. Entries are empty if a recording starts like the others; `None` if all do, if the model is
/// near the floor without them, and if other effects explain the error.
///
/// Periodic effects that are already in the model are removed first, so that the result is the same before
/// and after one is added; if one of their parameters is fixed, the angles are not changed.
#[must_use]
pub fn start_angles(
    model: &Model,
    recordings: &[&Recording],
    hold: Hold,
) -> Option<Vec<Vec<StartAngle>>> {
    if recordings.len() < 2 {
        return None;
    }
    let model = without_waves(model)?;
    let owned: Vec<Recording> = recordings.iter().map(|r| (*r).clone()).collect();
    let task = Task { model: &model, train: &owned, hold, seed: 0 };
    let starts = [start::start(&task, "start of the angles").ok()?];
    let data = Data { train: &owned, validation: &[], hold, corrected_s: 0.0 };
    let settings = Settings::default();
    let search = Search::new(&model, &starts, &data, &settings).ok()?;
    let (present, candidate, mut found) = search.waves(search.base(&model, &starts).ok()?)?;
    let mut with_waves = added(&present, &candidate, &found)?;
    for _ in 0..REFINEMENTS {
        let moved = moved(&owned, &found, model.robot());
        let Some((better, again)) = search.refined(&with_waves, &candidate, &moved) else { break };
        with_waves = better;
        if found.turn_by(again) < THRESHOLDS.least_angle_rad {
            break;
        }
    }
    let of = |r: usize| if r == found.reference { vec![] } else { known(&found, r) };
    Some((0..owned.len()).map(of).collect())
}

/// The model without its wave effects; `None` if a parameter of one of them is held.
fn without_waves(model: &Model) -> Option<Model> {
    let mut out = model.clone();
    for e in (0..model.effects().len()).rev() {
        if !model.effects()[e].has_waves() {
            continue;
        }
        if model.parameters()[model.slots(e)].iter().any(|p| p.fixed.is_some()) {
            return None;
        }
        out = out.without(e);
    }
    Some(out)
}

/// The start angles of recording `r` that are known and large enough to be corrected.
fn known(found: &Aligned, r: usize) -> Vec<StartAngle> {
    let one = |(w, wave): (usize, &Wave)| {
        let (angle, std_error_rad) =
            (within_turn(wave, found.shifts[r][w]), found.std_errors[r][w]);
        let (size, error) = (angle.abs() * wave.order, std_error_rad * wave.order);
        // another effect that is missing too adds errors that are not independent
        let worth = error < THRESHOLDS.known_angle_rad
            && size > THRESHOLDS.least_angle_rad
            && size > THRESHOLDS.phase_differs * error;
        worth.then_some(StartAngle { of: wave.of, angle_rad: angle, std_error_rad })
    };
    found.waves.iter().enumerate().filter_map(one).collect()
}

/// The recordings with their angles moved to the found starts.
fn moved(recordings: &[Recording], found: &Aligned, robot: &Robot) -> Vec<Recording> {
    let one = |(recording, shifts): (&Recording, &Vec<f64>)| {
        let each = found.waves.iter().zip(shifts);
        each.fold(recording.clone(), |recording, (wave, &angle_rad)| {
            let start = StartAngle { of: wave.of, angle_rad, std_error_rad: 0.0 };
            recording.with_later_angles(start.of_wheels(robot))
        })
    };
    recordings.iter().zip(&found.shifts).map(one).collect()
}

/// The fit with the candidate added at the alignment, not yet refitted.
fn added(present: &WindowFit, candidate: &Candidate, found: &Aligned) -> Option<WindowFit> {
    let model = present.model.add_effect(candidate.effect.clone()).ok()?;
    let mut own = candidate.p.clone();
    candidate.linear.iter().zip(found.p.iter()).for_each(|(&j, value)| own[j] = *value);
    let p = present.p.iter().copied().chain(own).collect();
    Some(WindowFit { model, p, ..present.clone() })
}

impl Search<'_> {
    /// The candidate whose waves with separate phases explain the most, with the fit that they are added to:
    /// effects that explain more are added first. `None` if no candidate needs separate phases.
    fn waves(&self, base: WindowFit) -> Option<(WindowFit, Candidate, Aligned)> {
        let mut present = base;
        for round in 0..=self.settings.max_effects {
            let near = !self.is_above_floor(present.cost);
            if near && (round > 0 || !self.is_periodic(&present)) {
                return None;
            }
            let held = held_in_time(&present);
            let criteria =
                [self.criteria(&present.model, &present.p), self.criteria(&held, &present.p)];
            let (model, p) = (&present.model, &present.p);
            let all = candidates(model, p, &[], &[], &self.windows.recordings, &self.scale);
            let phased = self.phased(&criteria[0], &all);
            let best = phased.into_iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion))?;
            let open = |than: f64| best.criterion < than - THRESHOLDS.strong;
            if round == 0 && !open(best.in_common.min(0.0)) {
                return None;
            }
            let mut others = self.screened(&present, &criteria);
            others.sort_by(|a, b| a.screened.total_cmp(&b.screened));
            if open(best.in_common) && best.criterion < others.first()?.screened {
                let (candidate, aligned) = (best.candidate.clone(), best.aligned);
                drop(criteria);
                return Some((present, candidate, aligned));
            }
            let wanted: Vec<usize> = (0..others.len().min(THRESHOLDS.exchanged)).collect();
            self.refit_all(&present, &mut others, &wanted, Some(&criteria));
            let refits = others.into_iter().filter_map(|r: Ranked| r.refit);
            let lowest = refits.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
            drop(criteria);
            present = lowest;
        }
        None
    }

    /// Whether the torque balance alone shows a torque that is periodic in the heading, with separate phases. Recordings
    /// of few headings let the parameters absorb a part of it, so that the error may be near the floor. The many orders
    /// of a ripple are left out: they cost more than the rest of the conditioning.
    fn is_periodic(&self, present: &WindowFit) -> bool {
        let WindowFit { model, p, .. } = present;
        let balance = (Regression::new(model, p, &self.smoothed, self.scale.speed), None);
        let mut all = candidates(model, p, &[], &[], &self.windows.recordings, &self.scale);
        all.retain(|candidate| candidate.waves().iter().any(|wave| wave.of == Cycle::Heading));
        let phased = self.phased(&balance, &all);
        phased.iter().any(|c| c.criterion < c.in_common.min(0.0) - THRESHOLDS.strong)
    }

    /// Whether a cost is larger than noise explains.
    fn is_above_floor(&self, cost: f64) -> bool {
        cost > 0.5 * THRESHOLDS.above_floor.powi(2) * self.windows.values() as f64
    }

    /// Every candidate with waves, shape by shape, with phases. Ratios of effects with many orders are divided by
    /// their median as in [`Search::level_grids`].
    fn phased<'c>(&self, criteria: &Criteria, all: &'c [Candidate]) -> Vec<Phased<'c>> {
        let mut buffer = Buffers::default();
        let mut out: Vec<Phased> = Vec::new();
        let mut ids: Vec<&str> = all.iter().map(|c| c.id.as_str()).collect();
        ids.dedup();
        for id in ids {
            let own = all.iter().filter(|c| c.id == id && !c.waves().is_empty());
            let own: Vec<(&Candidate, Aligned)> = own
                .filter_map(|c| {
                    let by_torque = criteria.0.as_ref().map(|r| r.by_recording(c, &mut buffer));
                    let by_windows = criteria.1.as_ref().map(|s| s.by_recording(c));
                    let criteria = by_torque.into_iter().chain(by_windows).collect();
                    let none = DVector::zeros(c.columns());
                    Some((c, Aligned::new(criteria, c.waves(), &none)?))
                })
                .collect();
            let Some((first, aligned)) = own.first() else { continue };
            let levelled = first.is_of_orders() && own.len() >= THRESHOLDS.many_orders;
            let free = (first.columns() + aligned.count()) as f64;
            let expected = distribution::chi2_quantile(0.5, free);
            let count = aligned.ratios().len();
            let ratios: Vec<Vec<f64>> = own.iter().map(|(_, aligned)| aligned.ratios()).collect();
            let levels: Vec<f64> = (0..count)
                .map(|n| (median_high(ratios.iter().map(|r| r[n])) / expected).max(1.0))
                .map(|level| if levelled { level } else { 1.0 })
                .collect();
            let criterion = |candidate: &Candidate, ratios: &[f64], shifts: usize| {
                let each = ratios.iter().zip(&levels).map(|(ratio, level)| {
                    self.bic(candidate, ratio / level) + shifts as f64 * self.degrees.ln()
                });
                each.sum::<f64>()
            };
            out.extend(own.into_iter().zip(&ratios).map(|((candidate, aligned), ratios)| {
                let in_common = criterion(candidate, &aligned.ratios_in_common(), 0);
                let with = criterion(candidate, ratios, aligned.count());
                Phased { candidate, aligned, criterion: with, in_common }
            }));
        }
        out
    }

    /// A fit on recordings whose angles were moved, and the shifts that they still need with it.
    fn refined(
        &self,
        before: &WindowFit,
        candidate: &Candidate,
        moved: &[Recording],
    ) -> Option<(WindowFit, Aligned)> {
        let recordings: Vec<&Recording> = moved.iter().collect();
        let windows = Windows::weighted(recordings, self.windows.hold, &before.model, &before.p);
        let found = fit(&windows, &before.model, &before.p, &self.scale)?;
        let first = found.p.len() - candidate.p.len();
        let mut at = candidate.clone();
        at.p.copy_from_slice(&found.p[first..]);
        let own = at.linear.iter().map(|&j| std::mem::take(&mut at.p[j]));
        let own = DVector::from_vec(own.collect());
        let symbols = found.model.symbols();
        let hold = |model: Model, j: usize| model.fix(&symbols[j], found.p[j]);
        let held = (first..found.p.len()).try_fold(found.model.clone(), hold).ok()?;
        let screen = Screen::new(&held, &found.p, &windows, self.degrees)?;
        let again = Aligned::new(vec![screen.by_recording(&at)], at.waves(), &own)?;
        Some((found, again))
    }
}

/// A candidate with the phases of its waves, and its criterion in the screening with them and without.
struct Phased<'c> {
    candidate: &'c Candidate,
    aligned: Aligned,
    criterion: f64,
    in_common: f64,
}
