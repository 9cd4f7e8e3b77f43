//! Parameters that are not identifiable from the data, and the identifiable combinations.

use nalgebra::{DMatrix, DVector};

use super::regressor::Regressor;
use super::{Note, SingleAxis, Task, Unknown};
use crate::effects::Motion;
use crate::math::Information;
use crate::model::Model;
use crate::model::base::{A1, A2, A3, A4, A5};
use crate::recording::{DriveUnit, Recording};

/// Covariance of all parameters, with notes on it.
pub(super) struct Identified {
    /// Covariance of all parameters; infinite for parameters that are not identifiable, zero for
    /// fixed ones.
    pub(super) covariance: DMatrix<f64>,
    /// What is not identifiable.
    pub(super) notes: Vec<Note>,
}

/// A parameter whose torque, at the speeds of the recordings, is uncertain by more than this many
/// times the largest input is not identifiable.
const LARGEST_TORQUE_ERROR: f64 = 1e3;
/// Directions in which noise is this share of the columns are not identifiable.
const NOISE_SHARE: f64 = 0.5;
/// Parts of a projection below this are rounding.
const ROUNDING: f64 = 1e-9;
/// Relative accuracy of directions that are dominated by noise.
const ROUGH: f64 = 0.1;
/// Parameters with less than this part in a direction do not take part in it.
const PART: f64 = 1e-3;

/// Inverts the information of the free parameters (scaled to unit diagonal) and determines which are
/// not identifiable, which combination of two is identifiable instead, and which motion identifies them.
///
/// `values` has one entry per parameter; `information` is that of all parameters. A `given`
/// covariance replaces the inverse information for identifiable parameters.
pub(super) fn identified(
    model: &Model,
    values: &[f64],
    information: &DMatrix<f64>,
    given: Option<&DMatrix<f64>>,
    axis: SingleAxis,
    train: &[Recording],
) -> Identified {
    let free = model.free();
    let n = free.len();
    let mut information = information.clone();
    for j in undetermined(model, values, &information, given, train) {
        information.row_mut(j).fill(0.0);
        information.column_mut(j).fill(0.0);
    }
    let known = Information::new(&information.select_rows(&free).select_columns(&free));
    let scale = known.scale();
    let finite = given.cloned().unwrap_or_else(|| among_all(model, &known.inverse()));
    let mut covariance = finite.clone();
    let mut notes = Vec::new();
    let directions = sparse_basis(&known.null_directions(), PART);
    for direction in directions.column_iter() {
        let direction = direction.into_owned();
        let part: Vec<usize> = (0..n).filter(|&i| direction[i] != 0.0).collect();
        for &i in &part {
            covariance[(free[i], free[i])] = f64::INFINITY;
        }
        notes.push(note(model, values, &finite, &free, scale, &direction, &part));
    }
    if train.iter().all(Recording::is_single_axis) {
        notes.push(Note::SingleAxis(axis));
    }
    Identified { covariance, notes }
}

/// The covariance of all parameters from that of the free ones: the others have none.
pub(crate) fn among_all(model: &Model, of_free: &DMatrix<f64>) -> DMatrix<f64> {
    let total = model.parameters().len();
    let free = model.free();
    let mut all = DMatrix::zeros(total, total);
    for (i, &a) in free.iter().enumerate() {
        for (k, &b) in free.iter().enumerate() {
            all[(a, b)] = of_free[(i, k)];
        }
    }
    all
}

/// The covariance of all parameters from the information of all: fixed ones have none, and those
/// that take part in a direction which the data do not give have an infinite one.
fn covariance_of_free(model: &Model, information: &DMatrix<f64>) -> DMatrix<f64> {
    let free = model.free();
    let of_free = information.select_rows(&free).select_columns(&free);
    among_all(model, &Information::new(&of_free).covariance())
}

/// Linear parameters with information by rounding only: a column that should be zero is not exactly
/// zero.
fn undetermined(
    model: &Model,
    values: &[f64],
    information: &DMatrix<f64>,
    given: Option<&DMatrix<f64>>,
    train: &[Recording],
) -> Vec<usize> {
    let input = largest_input(train);
    let wanting = |(j, torque): (usize, f64)| {
        let variance = given.map_or_else(|| 1.0 / information[(j, j)], |given| given[(j, j)]);
        (variance.sqrt() * torque > LARGEST_TORQUE_ERROR * input).then_some(j)
    };
    torque_of_each(model, values, train).into_iter().filter_map(wanting).collect()
}

/// Largest recorded input [unit of the input].
fn largest_input(train: &[Recording]) -> f64 {
    let inputs = train.iter().flat_map(|r| r.torque().iter().flatten());
    inputs.fold(0.0_f64, |most, m| most.max(m.abs()))
}

/// The parameter whose estimate is the most misleading, if there is one:
///
/// ```text
/// se_j |torque by parameter j in a curve at the recorded speeds| > largest recorded input
/// ```
/// An error of one standard error in such a parameter causes a torque as large as the whole
/// input, so simulations of another motion with this estimate are meaningless. The parameter
/// with the largest of these torques is returned. `information` is that of all parameters.
///
/// For a single axis, mapped to both wheels, only sums are identifiable and no parameter of one
/// wheel alone can be fixed: there `se_j` is the error if all others were known, and the
/// differences keep their initial values.
pub(super) fn least_known(
    model: &Model,
    values: &[f64],
    information: &DMatrix<f64>,
    train: &[Recording],
) -> Option<usize> {
    let covariance = if train.iter().all(Recording::is_single_axis) {
        DMatrix::from_diagonal(&information.diagonal().map(|i| 1.0 / i))
    } else {
        covariance_of_free(model, information)
    };
    let input = largest_input(train);
    let share = |(j, torque): (usize, f64)| {
        let error = covariance[(j, j)].sqrt() * torque;
        // a column without torque at one value has none at any other
        let known = torque == 0.0 && information[(j, j)] > 0.0;
        (!known && !(error <= input)).then_some((j, error))
    };
    let unknown = torque_of_each(model, values, train).into_iter().filter_map(share);
    // the last of equal ones, a2: a1 is the larger inertia and then stands for the sum
    let least = unknown.max_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    least.map(|(j, _)| j)
}

/// The value at which parameter `j` is held if the data do not identify it: that of the construction data for the base
/// model, zero for an effect, which has no typical size in the unit of any input and of a robot of any scale. The
/// construction data are in newton metres: per ampere or volt a friction is held at zero and an inertia at an `estimate`
/// from the data, unless the file gives an initial value.
pub(super) fn held_value(task: &Task, j: usize, estimate: f64) -> f64 {
    let is_torque = task.train.iter().all(|r| r.drive_unit() == DriveUnit::NewtonMetre);
    match j {
        A1 | A2 | A3 if !is_torque => task.model.parameters()[j].start.unwrap_or(estimate),
        A4 | A5 if !is_torque => task.model.parameters()[j].start.unwrap_or(0.0),
        A1..=A5 => task.model.initial()[j],
        _ => 0.0,
    }
}

/// Every free linear parameter with the torque that one unit of it makes in a curve at the speeds
/// of the recordings, reached within a second.
fn torque_of_each(model: &Model, values: &[f64], train: &[Recording]) -> Vec<(usize, f64)> {
    let speed = train.iter().map(Recording::top_speed).fold(0.0, f64::max);
    let regressor = Regressor::new(model, values);
    let omega = [speed, -0.5 * speed];
    let motion = Motion::at(0.0, [0.0; 2], omega, model.robot());
    let balance = regressor.at(&motion);
    let torque =
        |c: usize| balance.total_torque(c, &omega).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    regressor.linear.iter().enumerate().map(|(c, &j)| (j, torque(c))).collect()
}

/// The projection of parameters onto the directions in which columns move by more than their own
/// noise; `None` where that is all of them.
///
/// ```text
/// drop d:  d' N d > 1/2 d' A d,    A = x'x,  N the part of it that is noise
/// Π = 1 - D (D' A D)⁻¹ D' A
/// ```
/// Straight driving with noisy speeds is the case: the difference of the two accelerations is noise
/// alone, from which least squares would estimate a1 - a2. The directions themselves are only known
/// up to the noise, so parts of a few percent count as none and ratios near one as one.
pub(super) fn known_part(a: &DMatrix<f64>, noise: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let known = Information::new(a);
    let half = known.whitening();
    let share = (half.transpose() * noise * &half).symmetric_eigen();
    let dropped: Vec<usize> =
        (0..half.ncols()).filter(|&k| share.eigenvalues[k] > NOISE_SHARE).collect();
    if dropped.is_empty() {
        return None;
    }
    let scale = known.scale();
    let mut d = &half * share.eigenvectors.select_columns(&dropped);
    (0..n).for_each(|i| d.row_mut(i).scale_mut(scale[i]));
    let mut d = sparse_basis(&d, ROUGH);
    for i in 0..n {
        d.row_mut(i).unscale_mut(scale[i]);
    }
    for mut column in d.column_iter_mut() {
        let largest = column.camax();
        for v in column.iter_mut().filter(|v| (v.abs() / largest - 1.0).abs() < ROUGH) {
            *v = largest * v.signum();
        }
    }
    let inside = inverse_where_known(&(d.transpose() * a * &d));
    let mut out = DMatrix::identity(n, n) - &d * inside * d.transpose() * a;
    // values below rounding are set to zero, since the column would otherwise count as identifiable
    for i in 0..n {
        for k in 0..n {
            if out[(i, k)].abs() * scale[i] < ROUNDING * scale[k] {
                out[(i, k)] = 0.0;
            }
        }
    }
    Some(out)
}

/// A basis of the same space whose columns share as few rows as possible (Gauss-Jordan with full
/// pivoting); parts below `tolerance` of the largest are zero.
fn sparse_basis(directions: &DMatrix<f64>, tolerance: f64) -> DMatrix<f64> {
    let mut d = directions.clone();
    for c in 0..d.ncols() {
        let (mut row, mut column) = (0, c);
        for k in c..d.ncols() {
            let i = d.column(k).icamax();
            if d[(i, k)].abs() > d[(row, column)].abs() {
                (row, column) = (i, k);
            }
        }
        d.swap_columns(c, column);
        let pivot = d[(row, c)];
        if pivot == 0.0 {
            break;
        }
        d.column_mut(c).unscale_mut(pivot);
        let own = d.column(c).into_owned();
        for k in (0..d.ncols()).filter(|&k| k != c) {
            let factor = d[(row, k)];
            d.column_mut(k).axpy(-factor, &own, 1.0);
        }
    }
    for mut column in d.column_iter_mut() {
        let largest = column.camax();
        column.iter_mut().filter(|v| v.abs() < tolerance * largest).for_each(|v| *v = 0.0);
    }
    d
}

/// Inverse of a symmetric matrix over its non-zero directions, after scaling it to unit diagonal.
pub(super) fn inverse_where_known(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    Information::new(matrix).inverse()
}

/// The note on a direction that the data do not determine.
fn note(
    model: &Model,
    values: &[f64],
    finite: &DMatrix<f64>,
    free: &[usize],
    scale: &DVector<f64>,
    direction: &DVector<f64>,
    part: &[usize],
) -> Note {
    let name = |i: usize| model.parameters()[free[i]].spec.symbol.clone();
    let effect = model.parameters()[free[part[0]]].effect.clone();
    let unknown = match *part {
        [i] => Unknown::One(name(i)),
        [i, k] => {
            // the identifiable combination is orthogonal to the direction that is not
            let (di, dk) = (direction[i] / scale[i], direction[k] / scale[k]);
            let (a, b, weight) = (free[i], free[k], -dk / di);
            let (aa, bb) = (finite[(a, a)], finite[(b, b)] * weight * weight);
            let variance = aa + 2.0 * finite[(a, b)] * weight + bb;
            // a difference of rounding errors is not a variance
            let is_known = variance > f64::EPSILON * (aa + bb);
            Unknown::Two {
                first: name(i),
                second: name(k),
                weight,
                value: values[a] + weight * values[b],
                std_error: if is_known { variance.sqrt() } else { f64::INFINITY },
            }
        }
        _ => Unknown::Several(part.iter().map(|&i| name(i)).collect()),
    };
    Note::Unknown { unknown, effect }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn construction_data_in_newton_metres_are_no_values_per_ampere() {
        let held = |unit: DriveUnit, j: usize| {
            let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
            let rows: Vec<[f64; 2]> = t.iter().map(|t| [t.sin(); 2]).collect();
            let channels = Channels { t, alpha: None, omega: Some(rows.clone()), torque: rows };
            let train = [Recording::new("run.csv", channels, unit).unwrap()];
            let model = Model::base(Robot::amigobot());
            held_value(&Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 }, j, 0.7)
        };
        for (j, construction) in Model::base(Robot::amigobot()).initial().into_iter().enumerate() {
            assert_eq!(held(DriveUnit::NewtonMetre, j), construction);
            assert_eq!(held(DriveUnit::Ampere, j), if j < A4 { 0.7 } else { 0.0 });
        }
    }
}
