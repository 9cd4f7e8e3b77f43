//! Descent over shapes that are whole numbers.

use super::fit::{WindowFit, fit_within};
use super::windows::Windows;
use crate::effects::{ParameterKind, Scale};
use crate::model::Model;

/// The fit of which no step of one in a free whole-number shape of effect number `e` lowers the cost by more
/// than `negligible`; every step is fitted from the parameters before it.
///
/// The start with the lowest cost may have another whole number than the minimum, and the descent from it changes real
/// parameters alone: where friction stops a wheel, a start with the right exponent of a Stribeck curve and a
/// wrong speed keeps the wheel at rest for a whole window.
pub(super) fn over_whole_numbers(
    windows: &Windows,
    fit: WindowFit,
    e: usize,
    scale: &Scale,
    negligible: f64,
) -> WindowFit {
    let mut best = fit;
    for j in free_whole_numbers(&best.model, e) {
        let (low, high) = best.model.parameters()[j].spec.range;
        for step in [-1.0, 1.0] {
            loop {
                let mut p = best.p.clone();
                p[j] += step;
                let inside = (low..=high).contains(&p[j]);
                let next = inside.then(|| fit_within(windows, &best.model, &p, scale, negligible));
                match next.flatten() {
                    Some(next) if next.cost < best.cost - negligible => best = next,
                    _ => break,
                }
            }
        }
    }
    best
}

/// The first `count` of `starts`, which are in the order of their cost: first the best of each combination of whole
/// `numbers`, then the others.
pub(super) fn followed<S>(
    starts: Vec<S>,
    count: usize,
    numbers: impl Fn(&S) -> Vec<f64>,
) -> Vec<S> {
    let (mut first, mut others): (Vec<S>, Vec<S>) = (vec![], vec![]);
    for start in starts {
        let is_new = first.iter().all(|before| numbers(before) != numbers(&start));
        if is_new { &mut first } else { &mut others }.push(start);
    }
    first.extend(others);
    first.truncate(count);
    first
}

/// The estimated whole-number shapes of effect number `e` at the parameters `p`.
pub(super) fn whole_numbers(model: &Model, e: usize, p: &[f64]) -> Vec<f64> {
    free_whole_numbers(model, e).into_iter().map(|j| p[j]).collect()
}

/// Places in the parameters of the shapes of effect number `e` that are estimated.
pub(super) fn free_shapes(model: &Model, e: usize) -> Vec<usize> {
    let free = |&j: &usize| {
        let parameter = &model.parameters()[j];
        parameter.fixed.is_none() && parameter.spec.kind == ParameterKind::Shape
    };
    model.slots(e).filter(free).collect()
}

/// Those of them that are whole numbers.
fn free_whole_numbers(model: &Model, e: usize) -> Vec<usize> {
    let is_whole = |&j: &usize| model.parameters()[j].spec.whole;
    free_shapes(model, e).into_iter().filter(is_whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::fit::fit;
    use crate::diagnose::scale::scale_of;
    use crate::recording::Recording;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn a_fit_with_another_exponent_of_the_stribeck_curve_steps_to_that_of_the_data() {
        let model = Model::with_effects(Robot::amigobot(), &["stribeck"]).unwrap();
        let mut truth = model.initial();
        truth.splice(5.., [0.06, 3.0, 0.0, 2.0]);
        let movement = Movement::rich(model.robot(), 3, 15.0, 12.0);
        let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let train = record("synthetic", &model, &truth, &movement, &recorder).unwrap();
        let recordings: Vec<&Recording> = vec![&train];
        let scale = scale_of(&model, &truth, &recordings);
        let windows = Windows::new(recordings, Hold::Linear, &model, &truth);
        let at = |exponent: f64, fixed: bool| {
            let model = if fixed { model.fix("fse", exponent).unwrap() } else { model.clone() };
            let start: Vec<f64> = truth[..8].iter().copied().chain([exponent]).collect();
            fit(&windows, &model, &start, &scale).unwrap()
        };
        let last = model.effects().len() - 1;
        let first = at(1.0, false);
        let stepped = over_whole_numbers(&windows, first.clone(), last, &scale, 0.0);
        assert_eq!(stepped.p[8], 2.0, "{} {:?} {:?}", first.cost, first.p, stepped.p);
        // as a descent that has the exponent from the start, to the decrease of the cost at which one ends
        let own = at(2.0, false);
        assert!((stepped.cost / own.cost - 1.0).abs() < 1e-2, "{} {}", stepped.cost, own.cost);
        assert_eq!(over_whole_numbers(&windows, own, last, &scale, 0.0).p[8], 2.0);
        // an exponent that is held is not stepped
        let held = at(1.0, true);
        assert_eq!(over_whole_numbers(&windows, held, last, &scale, 0.0).p[8], 1.0);
    }

    #[test]
    fn starts_with_every_whole_number_are_followed_before_second_ones() {
        let starts = vec![(1.0, 'a'), (1.0, 'b'), (2.0, 'c'), (3.0, 'd')];
        let names = |count| -> String {
            let kept = followed(starts.clone(), count, |(n, _)| vec![*n]);
            kept.into_iter().map(|(_, name)| name).collect()
        };
        assert_eq!([names(2), names(4)], ["ac".to_string(), "acdb".to_string()]);
        // without whole numbers the order remains
        let kept = followed(starts.clone(), 2, |_| vec![]);
        assert_eq!(kept, starts[..1].iter().chain(&starts[1..2]).copied().collect::<Vec<_>>());
    }
}
