//! Windows over the same rows with several inputs or initial states, simulated together.

use std::ops::Range;

use rayon::prelude::*;

use super::Windows;
use super::errors::Errors;
use super::window::Window;
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::State;
use crate::simulate::{Realisation, has_lanes, speeds_of_realisations};

/// Windows that are simulated one after the other by one thread.
const IN_TURN: usize = 16;

impl Windows<'_> {
    /// Errors of a model in every window with all rows of the input, and with only every other one, both ways; `None`
    /// where [`Windows::errors`] has none.
    pub(super) fn errors_by_halves(&self, model: &Model, p: &[f64]) -> Option<[Vec<Errors>; 3]> {
        let halved = [0, 1].map(|phase| self.halved(phase));
        let [even, odd] = [0, 1].map(|n: usize| self.with_recordings(halved[n].iter().collect()));
        errors_of_several([self, &even, &odd], model, p)
    }

    /// Ranges of successive windows of one recording, [`IN_TURN`] at most.
    fn groups(&self) -> Vec<Range<usize>> {
        let places: Vec<usize> = (0..self.windows.len()).collect();
        let of_one =
            |a: &usize, b: &usize| self.windows[*a].recording == self.windows[*b].recording;
        let groups = places.chunk_by(of_one).flat_map(|places| places.chunks(IN_TURN));
        groups.map(|group| group[0]..group[0] + group.len()).collect()
    }
}

/// [`Windows::errors`] of windows over the same rows, which differ in their inputs and initial states alone. Each
/// simulation takes a lane of the processor if the model has lanes; the errors equal those of separate simulations to
/// rounding.
pub(super) fn errors_of_several<const N: usize>(
    several: [&Windows; N],
    model: &Model,
    p: &[f64],
) -> Option<[Vec<Errors>; N]> {
    let measured = |r: &&Recording| r.measured().omega;
    let found: Vec<Vec<Errors>> = if several[0].recordings.iter().all(measured) && has_lanes(model)
    {
        side_by_side(&several, model, p)?
    } else {
        several.iter().map(|windows| windows.errors(model, p)).collect::<Option<_>>()?
    };
    found.try_into().ok()
}

/// The same in the lanes of the processor.
fn side_by_side(several: &[&Windows], model: &Model, p: &[f64]) -> Option<Vec<Vec<Errors>>> {
    let first = several.first()?;
    let acting = several.iter().map(|windows| {
        let of = |r: &&Recording| model.input_of(r, r.torque(), p);
        windows.recordings.iter().map(of).collect::<Vec<_>>()
    });
    let acting: Vec<_> = acting.collect();
    let of_group = |group: &Range<usize>| -> Option<Vec<Vec<Errors>>> {
        let r = first.windows[group.start].recording;
        let rows: Vec<_> = first.windows[group.clone()].iter().map(|w| w.rows.clone()).collect();
        let starts = several.iter().map(|one| -> Vec<State> {
            one.windows[group.clone()].iter().map(|w| w.start).collect()
        });
        let starts: Vec<_> = starts.collect();
        let runs = acting.iter().zip(&starts);
        let runs: Vec<Realisation> =
            runs.map(|(torque, starts)| Realisation { torque: &torque[r], starts }).collect();
        let given = (first.recordings[r].t(), first.hold);
        let speeds = speeds_of_realisations(model, p, given, &rows, &runs)?.ok()?;
        let errors = |(one, speeds): (&&Windows, Vec<[f64; 2]>)| -> Option<Vec<Errors>> {
            let mut speeds = speeds.into_iter();
            let of = |window: &Window| {
                let own = speeds.by_ref().take(window.rows.len());
                let states: Vec<State> =
                    own.map(|omega| State { omega, ..State::default() }).collect();
                Errors::of(one.recordings[r], window, &states)
            };
            one.windows[group.clone()].iter().map(of).collect()
        };
        several.iter().zip(speeds).map(errors).collect()
    };
    let found: Vec<Vec<Vec<Errors>>> =
        first.groups().par_iter().map(of_group).collect::<Option<_>>()?;
    let mut out: Vec<Vec<Errors>> = several.iter().map(|_| Vec::new()).collect();
    for group in found {
        out.iter_mut().zip(group).for_each(|(out, errors)| out.extend(errors));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn simulations_together_equal_those_one_after_the_other() {
        let model = Model::base(Robot::amigobot());
        let mut p = model.initial();
        let recorded = [3, 4].map(|seed| {
            let noise = NoiseLevel { alpha: 0.0, dalpha: 0.02, torque: 0.02 };
            let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed };
            let movement = Movement::rich(model.robot(), seed, 20.0, 12.0);
            record("synthetic", &model, &p, &movement, &recorder).unwrap()
        });
        p[0] *= 1.03;
        let windows = Windows::new(recorded.iter().collect(), Hold::Linear, &model, &p);
        assert!(windows.groups().len() > 2);
        let together = windows.errors_by_halves(&model, &p).unwrap();
        let halved = [0, 1].map(|phase| windows.halved(phase));
        let [even, odd] =
            [0, 1].map(|n: usize| windows.with_recordings(halved[n].iter().collect()));
        for (together, alone) in together.iter().zip([&windows, &even, &odd]) {
            let alone = alone.errors(&model, &p).unwrap();
            assert_eq!(together.len(), alone.len());
            for (a, b) in together.iter().zip(&alone) {
                assert_eq!((a.compared, a.moving), (b.compared, b.moving));
                // sums are fused in lanes only; 1e-12 is the precision to which a window is simulated, times the number
                // of its rows
                let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-10;
                assert!(a.error.as_flattened().iter().zip(b.error.as_flattened()).all(close));
            }
        }
    }
}
