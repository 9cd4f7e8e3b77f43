//! The phases of a periodic torque in recordings whose angles start anew.

use nalgebra::{DMatrix, DVector};

use super::by_recording::{ByRecording, gain, ratio};
use crate::effects::Wave;
use crate::math::Information;

/// Rounds of amplitudes and phases in turn; each leaves a tenth or less of the remaining error.
const ROUNDS: usize = 20;
/// Number of phases in a turn at which the search starts; a descent continues from the best one.
const PLACES: usize = 72;

/// Waves with common amplitudes and a phase of their own in each recording.
///
/// ```text
/// maximise Σ_i (2 g_i' p_i - Σ_j p_i' S_ij p_j),   p_i = R(δ_i) p
/// ```
/// g, S: score and information of the columns in each recording, summed over the criteria of the screening
/// (regression, windows), each scaled by its variance; p: parameters in common; R: [`Wave::turn`]. One recording is
/// the reference, whose δ is zero.
pub(super) struct Aligned {
    /// The waves, with columns in the place of parameters.
    pub(super) waves: Vec<Wave>,
    /// Parameters in common, one per column.
    pub(super) p: DVector<f64>,
    /// How much later the angle of each wave starts \[rad\], recording by recording.
    pub(super) shifts: Vec<Vec<f64>>,
    /// Standard errors of the shifts \[rad\].
    pub(super) std_errors: Vec<Vec<f64>>,
    /// The reference recording: the one with the most information on the columns.
    pub(super) reference: usize,
    criteria: Vec<ByRecording>,
    information: DMatrix<f64>,
    score: DVector<f64>,
}

impl Aligned {
    /// The best phases of columns that are already in the model at `present`, from all criteria of the
    /// screening. `None` if no recording contains all of them.
    pub(super) fn new(
        mut criteria: Vec<ByRecording>,
        waves: Vec<Wave>,
        present: &DVector<f64>,
    ) -> Option<Self> {
        let columns = present.len();
        let size = criteria.first()?.score.len();
        let recordings = size / columns;
        // the score at zero amplitudes, not at those of the model
        let there = DVector::from_fn(size, |n, _| present[n % columns]);
        let (mut information, mut score) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let before: Vec<f64> = criteria.iter().map(|one| one.square).collect();
        for one in &mut criteria {
            let weight = one.degrees / one.square.max(f64::MIN_POSITIVE);
            one.score += &one.information * &there;
            one.square += one.gain(&there);
            information += weight * &one.information;
            score += weight * &one.score;
        }
        let apart = Information::new(&information);
        let (each, covariance) = (apart.solve(&score), apart.inverse());
        let of = |r: usize| (0..columns).map(move |c| r * columns + c);
        let known = |r: &usize| of(*r).all(|n| information[(n, n)] > 0.0);
        let spread = |r: usize| of(r).map(|n| covariance[(n, n)]).sum::<f64>();
        let reference =
            (0..recordings).filter(known).min_by(|a, b| spread(*a).total_cmp(&spread(*b)))?;
        let phase = |r: usize, wave: &Wave| {
            each[r * columns + wave.cosine].atan2(each[r * columns + wave.sine])
        };
        let shift = |r: usize, wave: &Wave| (phase(r, wave) - phase(reference, wave)) / wave.order;
        let shifts =
            (0..recordings).map(|r| waves.iter().map(|wave| shift(r, wave)).collect()).collect();
        let p = DVector::zeros(columns);
        let std_errors = vec![];
        let mut this =
            Self { waves, p, shifts, std_errors, reference, criteria, information, score };
        this.align();
        this.std_errors = this.std_errors_beside(&before);
        this.p.iter().all(|p| p.is_finite()).then_some(this)
    }

    /// How many shifts are estimated.
    pub(super) fn count(&self) -> usize {
        (self.shifts.len() - 1) * self.waves.len()
    }

    /// Twice the log-likelihood ratio of the waves with these phases in each criterion.
    pub(super) fn ratios(&self) -> Vec<f64> {
        self.ratios_of(&(self.turns(&self.shifts) * &self.p))
    }

    /// The same with a common phase for all recordings, at its own parameters.
    pub(super) fn ratios_in_common(&self) -> Vec<f64> {
        let turns = self.turns(&vec![vec![0.0; self.waves.len()]; self.shifts.len()]);
        let p = self.best_parameters(&turns);
        self.ratios_of(&(turns * p))
    }

    fn ratios_of(&self, each: &DVector<f64>) -> Vec<f64> {
        let of_one = |one: &ByRecording| ratio(one.degrees, one.square, one.gain(each));
        self.criteria.iter().map(of_one).collect()
    }

    /// Adds the shifts of recordings that were moved by these shifts already, as found by `again`; returns
    /// the largest of them in the angle of its wave \[rad\].
    pub(super) fn turn_by(&mut self, again: Self) -> f64 {
        let mut largest = 0.0_f64;
        let reference = &again.shifts[self.reference];
        for (own, more) in self.shifts.iter_mut().zip(&again.shifts) {
            for (w, wave) in self.waves.iter().enumerate() {
                let more = within_turn(wave, more[w] - reference[w]);
                own[w] += more;
                largest = largest.max(more.abs() * wave.order);
            }
        }
        self.std_errors = again.std_errors;
        largest
    }

    /// Parameters and shifts in turn.
    fn align(&mut self) {
        self.p = self.best_parameters(&self.turns(&self.shifts));
        for _ in 0..ROUNDS {
            for r in (0..self.shifts.len()).filter(|r| *r != self.reference) {
                for w in 0..self.waves.len() {
                    self.shifts[r][w] = self.best_shift(r, w);
                }
            }
            self.p = self.best_parameters(&self.turns(&self.shifts));
        }
    }

    /// The matrix from common parameters to those of each recording.
    fn turns(&self, shifts: &[Vec<f64>]) -> DMatrix<f64> {
        let columns = self.p.len();
        let mut out = DMatrix::zeros(shifts.len() * columns, columns);
        for (r, shifts) in shifts.iter().enumerate() {
            for c in 0..columns {
                let mut unit = vec![0.0; columns];
                unit[c] = 1.0;
                self.waves.iter().zip(shifts).for_each(|(wave, by)| wave.turn(&mut unit, *by));
                out.view_mut((r * columns, c), (columns, 1)).copy_from_slice(&unit);
            }
        }
        out
    }

    fn best_parameters(&self, turns: &DMatrix<f64>) -> DVector<f64> {
        let information = turns.tr_mul(&(&self.information * turns));
        Information::new(&information).solve(&turns.tr_mul(&self.score))
    }

    /// The gain with one shift at another value, in units of the variance.
    fn gain_with(&self, r: usize, w: usize, shift: f64) -> f64 {
        let mut shifts = self.shifts.clone();
        shifts[r][w] = shift;
        let each = self.turns(&shifts) * &self.p;
        gain(&self.information, &self.score, &each)
    }

    /// The best shift of a wave in a recording: from phases over the full turn and its present one, by halved steps.
    fn best_shift(&self, r: usize, w: usize) -> f64 {
        let turn = std::f64::consts::TAU / self.waves[w].order;
        let at = |shift: f64| (self.gain_with(r, w, shift), shift);
        let places = (0..PLACES).map(|k| at(turn * k as f64 / PLACES as f64));
        let mut best = places.fold(at(self.shifts[r][w]), |a, b| if b.0 > a.0 { b } else { a });
        let mut step = 0.5 * turn / PLACES as f64;
        while step > 1e-6 * turn {
            let sides = [at(best.1 - step), at(best.1 + step)];
            match sides.into_iter().find(|side| side.0 > best.0) {
                Some(side) => best = side,
                None => step *= 0.5,
            }
        }
        best.1
    }

    /// Standard errors of the shifts, from the curvature of the gain and the squared errors that remain with the
    /// waves, relative to the variances that scale the criteria.
    fn std_errors_beside(&self, weighted_by: &[f64]) -> Vec<Vec<f64>> {
        let each = self.turns(&self.shifts) * &self.p;
        let left = |(one, by): (&ByRecording, &f64)| (one.square - one.gain(&each)) / by;
        let variance = self.criteria.iter().zip(weighted_by).map(left).fold(0.0, f64::max);
        let one = |r: usize, w: usize| {
            let (at, h) = (self.shifts[r][w], 1e-3 / self.waves[w].order);
            let [below, here, above] = [-h, 0.0, h].map(|step| self.gain_with(r, w, at + step));
            (2.0 * variance * h * h / (2.0 * here - below - above).max(0.0)).sqrt()
        };
        let of = |r: usize| (0..self.waves.len()).map(|w| one(r, w)).collect();
        (0..self.shifts.len()).map(of).collect()
    }
}

/// A shift as the nearest to zero of those that are the same for the wave.
pub(super) fn within_turn(wave: &Wave, shift: f64) -> f64 {
    let turn = std::f64::consts::TAU / wave.order;
    shift - turn * (shift / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Cycle;

    #[test]
    fn the_phases_of_each_recording_are_found_and_their_errors_are_those_of_the_amplitudes() {
        // a wave of amplitude 2 at phases 0.3, 1.5 and -2.0, seen in columns that are orthogonal
        let phases = [0.3_f64, 1.5, -2.0];
        let information =
            DMatrix::from_diagonal(&DVector::from_vec(vec![9.0, 9.0, 4.0, 4.0, 4.0, 4.0]));
        let each = phases.iter().flat_map(|phase| [2.0 * phase.cos(), 2.0 * phase.sin()]);
        let truth = DVector::from_iterator(6, each);
        let score = &information * &truth;
        let square = truth.dot(&score) + 100.0;
        let one = ByRecording { information, score, square, degrees: 100.0 };
        let wave = Wave { of: Cycle::Heading, order: 1.0, sine: 0, cosine: 1 };
        let found = Aligned::new(vec![one], vec![wave], &DVector::zeros(2)).unwrap();
        assert_eq!(found.reference, 0, "the one with the most information");
        for (r, phase) in phases.iter().enumerate() {
            let expected = phase - phases[0];
            assert!((found.shifts[r][0] - expected).abs() < 1e-5, "{:?}", found.shifts);
        }
        // the variance that is left is one; a phase of amplitude A has 1/(A² information)
        assert!((found.std_errors[1][0] - 1.0 / (2.0 * 4.0_f64.sqrt())).abs() < 1e-4);
        assert!((found.ratios()[0] - 100.0 * (square / 100.0).ln()).abs() < 1e-6);
        assert!(found.ratios_in_common()[0] < found.ratios()[0] / 2.0);
    }

    #[test]
    fn what_the_model_has_already_counts_as_a_part_of_the_wave() {
        let information = DMatrix::from_diagonal_element(4, 4, 5.0);
        let truth = DVector::from_vec(vec![1.0, 0.0, 0.0, 1.0]);
        let present = DVector::from_vec(vec![1.0, 0.0]);
        let there = DVector::from_vec(vec![1.0, 0.0, 1.0, 0.0]);
        let score = &information * (truth - there);
        let one = ByRecording { information, score, square: 60.0, degrees: 50.0 };
        let wave = Wave { of: Cycle::Wheel(0), order: 4.0, sine: 0, cosine: 1 };
        let found = Aligned::new(vec![one], vec![wave], &present).unwrap();
        let quarter = std::f64::consts::FRAC_PI_2 / 4.0;
        let shift = within_turn(&wave, found.shifts[1][0] - found.shifts[0][0]);
        assert!((shift - quarter).abs() < 1e-5, "a quarter of a wave of order four: {shift}");
    }
}
