//! Selection of initial values for descents.

use crate::model::Model;
use crate::robot::State;
use crate::simulate::{Input, ise_of_many};

/// A stretch that is simulated freely: its input, the state it starts from, the measured speeds
/// [rad/s].
pub(super) type Stretch<'a> = (Input<'a>, State, &'a [[f64; 2]]);

/// Places of the `count` parameter vectors with the smallest ISE over all stretches, smallest
/// first; vectors that cannot be simulated come last.
pub(super) fn lowest<'a>(
    model: &Model,
    vectors: &[Vec<f64>],
    count: usize,
    stretches: impl Iterator<Item = Stretch<'a>>,
) -> Vec<usize> {
    let mut sums = vec![0.0; vectors.len()];
    for (input, start, measured) in stretches {
        let found = ise_of_many(model, vectors, &input, start, measured);
        for (sum, ise) in sums.iter_mut().zip(found) {
            *sum += ise.unwrap_or(f64::INFINITY);
        }
    }
    let mut places: Vec<usize> = (0..vectors.len()).collect();
    places.sort_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    places.truncate(count);
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::simulate::{Hold, simulate};

    #[test]
    fn the_guesses_nearest_the_truth_come_first_and_impossible_ones_last() {
        let model = Model::base(Robot::amigobot());
        let t: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let torque: Vec<_> = t.iter().map(|t| [0.4 * t.sin(), 0.3 * (2.0 * t).sin()]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let truth = model.initial();
        let motion = simulate(&model, &truth, &input, State::default()).unwrap();
        let measured: Vec<_> = motion.iter().map(|s| s.omega).collect();
        let scaled = |factor: f64| truth.iter().map(|a| factor * a).collect::<Vec<f64>>();
        let mut vectors = [2.0, 1.0, 1.2, 1.05].map(scaled).to_vec();
        vectors[0][1] = 3.0 * vectors[0][0];
        let stretches = [(input, State::default(), &measured[..])];
        assert_eq!(lowest(&model, &vectors, 4, stretches.into_iter()), [1, 3, 2, 0]);
    }
}
