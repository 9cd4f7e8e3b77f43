//! The time of the recorded input as a nuisance of every model of the diagnosis.

use std::ops::Range;

use super::cubic::{between_rows, cubic, weights_of_cubic};
use super::row_means::{line_with_means, line_with_means_of_spline};
use crate::effects::{Change, Description, Energy, ParameterSpec, Physics, Scale};
use crate::math::Real;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{Hold, held_later, mean_later};

/// Error of the time due to interpolation of the input between its rows, in rows.
pub(super) const INTERPOLATION: f64 = 0.02;

/// Id of the nuisance effect in models of the diagnosis; it is not an effect of the catalogue.
pub(super) const ID: &str = "input_timing";
/// Symbol of its parameter, the shift of the input \[s\], among the estimates of a diagnosis.
pub const SYMBOL: &str = "input_shift";

/// What the values of a recorded input are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Between {
    /// Those at the times of the rows; it varies linearly from one to the next.
    Line,
    /// Those at the times of the rows; it varies smoothly from one to the next.
    Smooth,
    /// Those that are held from each row to the next.
    Held,
    /// Means over a row of an input that varies within it.
    Means,
}

impl Between {
    /// The input of a simulation between its rows.
    pub(super) fn hold(self) -> Hold {
        if self == Self::Held { Hold::Constant } else { Hold::Linear }
    }
}

impl From<Hold> for Between {
    fn from(hold: Hold) -> Self {
        match hold {
            Hold::Linear => Self::Line,
            Hold::Constant => Self::Held,
        }
    }
}

/// The recorded input acts `shift` seconds later, within what logging explains.
///
/// ```text
/// M(t) = M_recorded(t - shift),   cubic between the rows (Catmull and Rom), or, of a held input, its mean over each row,
///                                 or, of means over a row, the line with these means; of a smooth input the line with the
///                                 means of the spline
/// ```
/// A cubic through a held command would let it act before it was given: its answer to the noise of the next speed would
/// agree with that speed.
///
/// It is fitted with every model, so that a wrong time base is not attributed to physics, nor physics to a
/// wrong time base.
#[derive(Clone, Debug)]
pub(super) struct InputTiming {
    /// Smallest and largest shift \[s\].
    pub(super) limits: (f64, f64),
    /// What the recorded values are.
    pub(super) between: Between,
}

impl Physics for InputTiming {
    fn description(&self) -> Description {
        Description {
            id: ID.into(),
            title: "Timing of the recorded input".into(),
            equation: "M(t) = recorded M(t - shift)".into(),
            cause: "logging: the input is averaged or held over a row".into(),
            signature: String::new(),
            excitation: String::new(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape(
            SYMBOL,
            "time by which logging shifts the input",
            "s",
            (-1.0, 1.0),
            1e-3,
        )]
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn change(&self) -> Change {
        Change::TimeShift
    }

    fn limits(&self, _scale: &Scale) -> Vec<(f64, f64)> {
        vec![self.limits]
    }

    fn input<T: Real>(&self, t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        // behind the last row its length is a convention
        let last_s = || Some(t.last()? - t.iter().nth_back(1)?);
        Some(match self.between {
            Between::Line => later(t, m, p[0]),
            Between::Smooth => line_with_means_of_spline(t, m, p[0], last_s()?),
            Between::Held => mean_later(t, m, p[0], last_s()?),
            Between::Means => line_with_means(t, m, p[0], last_s()?),
        })
    }
}

/// Indices of the effects of a model that delay its input, without the nuisance effect.
pub(super) fn shifts(model: &Model) -> impl DoubleEndedIterator<Item = usize> {
    let effects = model.effects();
    let is_one = |e: &usize| effects[*e].change() == Change::TimeShift && effects[*e].id() != ID;
    (0..effects.len()).filter(is_one)
}

/// An acting input, and its derivatives by every parameter; those by parameters without one are empty.
type Derivatives = (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>);

/// The acting input of a recording, and its derivatives with respect to every parameter like
/// [`Model::input_derivatives`], except that those with respect to a delay are means over a row.
///
/// ```text
/// dM/dT = (M(t - T - h/2) - M(t - T + h/2))/h
/// ```
/// The derivative of a command with a step between two rows is non-zero only within this row: for delays that
/// are not whole rows of non-uniform length, the samples may miss it, and a descent would stop.
pub(super) fn input_derivatives(model: &Model, recording: &Recording, p: &[f64]) -> Derivatives {
    let (torque, half) = (recording.torque(), 0.5 * recording.step());
    let (acting, mut derivatives) = model.input_derivatives_of(recording, torque, p);
    for j in shifts(model).flat_map(|e| model.slots(e)) {
        let at = |value: f64| {
            let mut moved = p.to_vec();
            moved[j] = value;
            model.input_of(recording, torque, &moved)
        };
        let (low, high) = ((p[j] - half).max(0.0), p[j] + half);
        let rows = at(low).into_iter().zip(at(high));
        derivatives[j] = rows.map(|(a, b)| [0, 1].map(|i| (b[i] - a[i]) / (high - low))).collect();
    }
    (acting, derivatives)
}

/// A signal delayed by `shift` seconds, by cubic interpolation between its rows; the end values are held.
pub(super) fn later<T: Real>(t: &[f64], m: &[[T; 2]], shift: T) -> Vec<[T; 2]> {
    let mut row = 0;
    t.iter().map(|&now| between_rows(t, m, -shift + now, &mut row)).collect()
}

/// A recording whose input acts `shift` seconds later; one that is held between the rows by the mean over each row.
#[must_use]
pub fn with_later_input(recording: &Recording, shift: f64, hold: Hold) -> Recording {
    recording.with_interpolated_torque(|torque| match hold {
        Hold::Linear => shifted(recording, torque, shift),
        Hold::Constant => held_later(recording, torque, shift),
    })
}

/// A signal of a recording delayed by `shift` seconds, by cubic interpolation between its rows; the end
/// values of every piece are held.
#[must_use]
pub fn shifted(recording: &Recording, signal: &[[f64; 2]], shift: f64) -> Vec<[f64; 2]> {
    let pieces = recording.pieces().iter();
    pieces.flat_map(|p| later(&recording.t()[p.clone()], &signal[p.clone()], shift)).collect()
}

/// A signal of a recording with several delays, row by row as in [`shifted`].
pub(super) struct Shifted<'a> {
    recording: &'a Recording,
    whole: &'a [[f64; 2]],
    /// The piece of the last row, with its times and values.
    piece: Range<usize>,
    t: &'a [f64],
    signal: &'a [[f64; 2]],
    delays: Vec<Delay>,
}

/// One of the delays of [`Shifted`].
struct Delay {
    shift: f64,
    /// The delay of the rows of the piece if these are at equal distances.
    even: Option<EvenShift>,
    /// Where in the piece the last instant was found.
    row: usize,
}

impl<'a> Shifted<'a> {
    pub(super) fn new(recording: &'a Recording, whole: &'a [[f64; 2]], shifts: &[f64]) -> Self {
        let (t, signal) = (&[][..], &[][..]);
        let delays = shifts.iter().map(|shift| Delay { shift: *shift, even: None, row: 0 });
        Self { recording, whole, piece: 0..0, t, signal, delays: delays.collect() }
    }

    /// Calls `see` with the number of every delay and the value in row `k`; fast for rows in order.
    #[inline]
    pub(super) fn at(&mut self, k: usize, mut see: impl FnMut(usize, [f64; 2])) {
        if !self.piece.contains(&k) {
            self.enter_piece_of(k);
        }
        let (t, signal, k) = (self.t, self.signal, k - self.piece.start);
        for (n, Delay { shift, even, row }) in self.delays.iter_mut().enumerate() {
            let inside = even.as_ref().and_then(|even| even.at(signal, k));
            see(n, inside.unwrap_or_else(|| between_rows(t, signal, -*shift + t[k], row)));
        }
    }

    fn enter_piece_of(&mut self, k: usize) {
        let all = || 0..self.recording.len();
        self.piece = self.recording.piece_of(k).cloned().unwrap_or_else(all);
        self.t = &self.recording.t()[self.piece.clone()];
        self.signal = &self.whole[self.piece.clone()];
        let step = even_step(self.t);
        for Delay { shift, even, row } in &mut self.delays {
            (*even, *row) = (step.map(|step| EvenShift::new(*shift / step)), 0);
        }
    }
}

/// Largest deviation of an instant from equal distances, in rows, for which these stand for it: far below the
/// resolution of a time of the input, above rounding of times of a day.
const EVEN: f64 = 1e-9;

/// Step of rows at equal distances \[s\]; `None` of others.
fn even_step(t: &[f64]) -> Option<f64> {
    let (first, last) = t.first().zip(t.last())?;
    let step = (last - first) / (t.len() - 1) as f64;
    let is_even = |(k, t): (usize, &f64)| (t - first - k as f64 * step).abs() <= EVEN * step;
    (step > 0.0 && t.iter().enumerate().all(is_even)).then_some(step)
}

/// A shift of rows at equal distances, whose weights are the same for all rows.
struct EvenShift {
    /// Whole rows from a row to the one before its shifted instant.
    rows: isize,
    weights: [f64; 3],
}

impl EvenShift {
    /// A shift of so many rows to a later time.
    fn new(later: f64) -> Self {
        let rows = (-later).floor();
        Self { rows: rows as isize, weights: weights_of_cubic(-later - rows, [0.5; 2]) }
    }

    /// The shifted signal in row `k`; `None` near the ends.
    #[inline(always)]
    fn at(&self, signal: &[[f64; 2]], k: usize) -> Option<[f64; 2]> {
        let before = k.checked_add_signed(self.rows)?.checked_sub(1)?;
        let four = signal.get(before..before.checked_add(4)?)?;
        Some(cubic(&self.weights, [four[0], four[1], four[2], four[3]]))
    }
}

#[cfg(test)]
mod tests {
    use super::{EvenShift, even_step, later};
    use crate::diagnose::cubic::between_rows;
    use crate::recording::{Channels, DriveUnit, Recording};
    use crate::simulate::{held_later, mean_later};

    #[test]
    fn a_parabola_is_shifted_exactly_inside_and_held_at_the_ends() {
        let t: Vec<f64> = (0..20).map(|k| 0.01 * f64::from(k)).collect();
        let parabola = |t: f64| [3.0 * t * t - t, 2.0];
        let m: Vec<[f64; 2]> = t.iter().map(|&t| parabola(t)).collect();
        for shift in [-0.013, 0.004, 0.025] {
            let found = later(&t, &m, shift);
            // Catmull and Rom's slopes are exact for parabolas away from the ends
            for k in 5..14 {
                assert!((found[k][0] - parabola(t[k] - shift)[0]).abs() < 1e-14, "{k} {shift}");
                assert_eq!(found[k][1], 2.0);
            }
        }
        assert_eq!(later(&t, &m, 0.5)[3], m[0]);
        assert_eq!(later(&t, &m, 0.0), m);
        // a row does not depend on those that are left out before it
        for shift in [-0.013, 0.004, 0.025] {
            let (whole, mut row) = (later(&t, &m, shift), 0);
            for k in (0..t.len()).step_by(3) {
                assert_eq!(between_rows(&t, &m, -shift + t[k], &mut row), whole[k]);
            }
        }
        // rows at equal distances have the same weights
        let step = even_step(&t).unwrap();
        for shift in [-0.013, 0.004, 0.01, 0.025] {
            let (whole, even) = (later(&t, &m, shift), EvenShift::new(shift / step));
            for k in 0..t.len() {
                let found = even.at(&m, k).unwrap_or(whole[k]);
                assert!((found[0] - whole[k][0]).abs() < 1e-12, "{k} {shift}");
            }
            assert!((3..14).all(|k| even.at(&m, k + 1).is_some()));
        }
        assert_eq!(even_step(&[0.0, 0.01, 0.021]), None);
    }

    #[test]
    fn a_held_input_acts_no_earlier_than_it_was_given() {
        let t: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k) + 1e-3 * f64::from(k % 3)).collect();
        let m: Vec<[f64; 2]> = (0..50).map(|k| [f64::from(k * k % 7), f64::from(k % 5)]).collect();
        let channels =
            Channels { alpha: None, omega: Some(m.clone()), torque: m.clone(), t: t.clone() };
        let recording = Recording::new("held", channels, DriveUnit::NewtonMetre).unwrap();
        for shift in [-0.013, 0.0, 0.004, 0.025] {
            let found = mean_later(&t, &m, shift, recording.step());
            let same = held_later(&recording, &m, shift);
            // behind the last row its length is a convention
            for k in 0..t.len() - 1 {
                assert!((0..2).all(|i| (found[k][i] - same[k][i]).abs() < 1e-10), "{k} {shift}");
            }
        }
        let mut other = m.clone();
        other[30] = [100.0; 2];
        let [one, other] = [&m, &other].map(|m| mean_later(&t, m, 0.002, 0.01));
        assert_eq!(one[..30], other[..30]);
    }
}
