//! From the values of the linear parameters and their covariance to a fit.

use nalgebra::{DMatrix, DVector};

use super::identifiability::identified;
use super::start::with_positive_mass;
use super::{Fit, IdentifyError, Note, SingleAxis, Task};
use crate::model::base::{A1, A2};

/// A fit of the linear parameters alone: shapes and what shifts the input are held where the model starts.
///
/// `information` of the columns states which directions the data determine, up to a factor; `covariance`
/// is that of the columns.
pub(super) fn linear_fit(
    method: &str,
    task: &Task,
    linear: &[usize],
    values: &DVector<f64>,
    information: &DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> Result<Fit, IdentifyError> {
    let total = task.model.parameters().len();
    let mut p = task.model.initial();
    for (value, &j) in values.iter().zip(linear) {
        p[j] = *value;
    }
    let mut held = task.model.clone();
    for j in task.model.free().into_iter().filter(|j| !linear.contains(j)) {
        held = held.fix(&task.model.parameters()[j].spec.symbol, p[j])?;
    }
    let spread = |small: &DMatrix<f64>| {
        let mut out = DMatrix::zeros(total, total);
        for (i, &a) in linear.iter().enumerate() {
            for (k, &b) in linear.iter().enumerate() {
                out[(a, b)] = small[(i, k)];
            }
        }
        out
    };
    let known = identified(
        &held,
        &p,
        &spread(information),
        Some(&spread(covariance)),
        SingleAxis::CountedTwice,
        task.train,
    );
    let (mut notes, mut covariance) = (known.notes, known.covariance);
    let is_unknown = |j: usize| covariance[(j, j)].is_infinite();
    if settle(&mut p, task, is_unknown(A1) || is_unknown(A2), &mut notes) {
        [A1, A2].into_iter().for_each(|j| covariance[(j, j)] = f64::INFINITY);
    }
    let unit = task.train[0].drive_unit();
    let mut out = Fit::physical(method, task.model, p, covariance, unit);
    for (j, estimate) in out.estimates.iter_mut().enumerate() {
        estimate.fixed |= !linear.contains(&j);
    }
    out.notes = notes;
    Ok(out)
}

/// Where the data give `only_sum`, a1 + a2 or a1 - a2, takes of all that fit one that can move (a1 above
/// |a2|). Where the fitted values contradict that, as differences of wheels that hardly differ do, keeps their larger
/// combination in the same way and says so; held values stay. Whether values were replaced that contradict it.
pub(super) fn settle(p: &mut [f64], task: &Task, only_sum: bool, notes: &mut Vec<Note>) -> bool {
    let contradicted = !only_sum && !(p[A1] > p[A2].abs());
    if contradicted {
        notes.push(Note::MassNotPositive);
    }
    let fitted = [p[A1], p[A2]];
    if only_sum || contradicted {
        with_positive_mass(task.model, p);
    }
    contradicted && [p[A1], p[A2]] != fitted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn inertias_that_no_robot_has_keep_their_larger_combination() {
        let model = Model::base(Robot::amigobot());
        let task = Task { model: &model, train: &[], hold: Hold::Linear, seed: 0 };
        let mut notes = vec![];
        // straight runs: a1 + a2 is known, and a1 - a2 came out negative
        let mut p = model.initial();
        (p[A1], p[A2]) = (0.012, 0.013);
        assert!(settle(&mut p, &task, false, &mut notes));
        assert!((p[A1] + p[A2] - 0.025).abs() < 1e-15 && p[A1] > p[A2].abs(), "{p:?}");
        assert!(matches!(notes[..], [Note::MassNotPositive]));
        // where the data leave a choice nothing is contradicted
        (p[A1], p[A2]) = (0.0125, 0.0125);
        assert!(!settle(&mut p, &task, true, &mut notes));
        assert!((p[A1] + p[A2] - 0.025).abs() < 1e-15 && p[A1] > p[A2].abs(), "{p:?}");
        assert_eq!(notes.len(), 1);
        // what the user holds is not moved, and not called unknown
        let held = model.fix("a1", 0.01).unwrap().fix("a2", 0.02).unwrap();
        (p[A1], p[A2]) = (0.01, 0.02);
        assert!(!settle(&mut p, &Task { model: &held, ..task }, false, &mut notes));
        assert_eq!((p[A1], p[A2]), (0.01, 0.02));
    }
}
