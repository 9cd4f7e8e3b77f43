//! Zero-phase Butterworth low-pass and derivatives of sampled signals.

use std::ops::{Add, Mul, Sub};

use super::error::MathError;

/// A value of a signal, or one value of each of several signals in parallel.
pub trait Sample: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Sample for T {}

/// Extension of a signal beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// Point reflection at the end, `f(-t) = 2 f(0) - f(t)`: keeps value and slope.
    Odd,
    /// Mirror reflection, `f(-t) = f(t)`: the derivative of a signal with odd extension.
    Even,
}

impl Extension {
    /// The value beyond the `end` that corresponds to one as far `inside`.
    pub(super) fn beyond<T: Sample>(self, end: T, inside: T) -> T {
        match self {
            Self::Odd => end * 2.0 - inside,
            Self::Even => inside,
        }
    }
}

/// One second-order section: `(b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// b0, b1, b2: weights of this and the last two inputs.
    pub numerator: [f64; 3],
    /// a1, a2: weights of the last two outputs (a0 is one).
    pub denominator: [f64; 2],
}

/// State of a section: the weighted values before.
#[derive(Clone, Copy)]
pub(super) struct Memory<T> {
    pub(super) next: T,
    pub(super) later: T,
}

impl Section {
    /// The steady state of the `first` value.
    #[inline(always)]
    pub(super) fn steady<T: Sample>(&self, first: T) -> Memory<T> {
        let ([_, b1, b2], [a1, a2]) = (self.numerator, self.denominator);
        let steady = first * self.steady_gain();
        let later = first * b2 - steady * a2;
        Memory { next: first * b1 - steady * a1 + later, later }
    }

    /// The next value (transposed direct form II).
    #[inline(always)]
    pub(super) fn step<T: Sample>(&self, x: T, memory: &mut Memory<T>) -> T {
        let ([b0, b1, b2], [a1, a2]) = (self.numerator, self.denominator);
        let y = x * b0 + memory.next;
        memory.next = x * b1 - y * a1 + memory.later;
        memory.later = x * b2 - y * a2;
        y
    }

    fn steady_gain(&self) -> f64 {
        self.numerator.iter().sum::<f64>() / (1.0 + self.denominator.iter().sum::<f64>())
    }

    fn is_first_order(&self) -> bool {
        self.numerator[2] == 0.0 && self.denominator[1] == 0.0
    }
}

/// A Butterworth low-pass of the given order as second-order sections.
///
/// ```text
/// |H(jW)|^2 = 1 / (1 + (W/Wc)^(2 order)),  s = 2 fs (z-1)/(z+1),  Wc = 2 fs tan(pi fc/fs)
/// ```
///
/// `cutoff` and `sample_rate` in \[Hz\].
///
/// Source: A. V. Oppenheim, R. W. Schafer, *Discrete-Time Signal Processing*, 7.1.
///
/// # Errors
/// If the order is not 1..=20 or the cut-off does not lie between 0 and half the sample rate.
///
/// # Examples
/// ```
/// use amigo_ident::math::filter::butterworth;
/// assert_eq!(butterworth(5, 8.0, 100.0)?.len(), 3);
/// # Ok::<(), amigo_ident::math::MathError>(())
/// ```
pub fn butterworth(order: usize, cutoff: f64, sample_rate: f64) -> Result<Vec<Section>, MathError> {
    if !(1..=20).contains(&order) {
        let found = order as f64;
        return Err(MathError::OutOfRange { setting: "filter order", found, expected: "1 to 20" });
    }
    let ratio = cutoff / sample_rate;
    if !(ratio > 0.0 && ratio < 0.5) {
        let expected = "more than 0 and less than half the sample rate [Hz]";
        return Err(MathError::OutOfRange {
            setting: "cut-off frequency",
            found: cutoff,
            expected,
        });
    }
    let warped = (std::f64::consts::PI * ratio).tan();
    let mut sections = Vec::with_capacity(order.div_ceil(2));
    if order % 2 == 1 {
        let gain = warped / (1.0 + warped);
        let pole = (warped - 1.0) / (warped + 1.0);
        sections.push(Section { numerator: [gain, gain, 0.0], denominator: [pole, 0.0] });
    }
    for pair in 0..order / 2 {
        let angle = std::f64::consts::PI * (2 * pair + 1) as f64 / (2 * order) as f64;
        let damping = 2.0 * warped * angle.sin();
        let square = warped * warped;
        let norm = 1.0 + damping + square;
        let gain = square / norm;
        sections.push(Section {
            numerator: [gain, 2.0 * gain, gain],
            denominator: [2.0 * (square - 1.0) / norm, (1.0 - damping + square) / norm],
        });
    }
    Ok(sections)
}

/// Samples by which `scipy.signal.sosfiltfilt` extends a signal at each end.
#[must_use]
pub fn reflected(sections: &[Section]) -> usize {
    let first_order = sections.iter().filter(|s| s.is_first_order()).count();
    3 * (2 * sections.len() + 1 - first_order)
}

/// Filters forwards and backwards a signal that is extended by `edge` samples, or by as many as it
/// has besides the one at the end.
///
/// Filter and derivative commute up to the ends if the signal is extended [`Extension::Odd`] and its
/// derivative [`Extension::Even`].
#[must_use]
pub fn filter_both_ways<T: Sample>(
    sections: &[Section],
    signal: &[T],
    edge: usize,
    extension: Extension,
) -> Vec<T> {
    let Some(&first) = signal.first() else { return vec![] };
    let edge = edge.min(signal.len() - 1);
    let mut extended = Vec::with_capacity(signal.len() + 2 * edge);
    extended.resize(edge, first);
    extended.extend_from_slice(signal);
    extended.resize(signal.len() + 2 * edge, first);
    filter_within(sections, &mut extended, edge, extension);
    extended.truncate(edge + signal.len());
    extended.drain(..edge);
    extended
}

/// [`filter_both_ways`] in place, for a signal of more than `edge` samples with `edge` free places before and
/// after it.
pub(crate) fn filter_within<T: Sample>(
    sections: &[Section],
    signal: &mut [T],
    edge: usize,
    extension: Extension,
) {
    extend(signal, edge, extension);
    for sections in sections.chunks(2) {
        let Some(&first) = signal.first() else { return };
        run(sections, first, signal.iter_mut());
    }
    for sections in sections.chunks(2) {
        let Some(&last) = signal.last() else { return };
        run(sections, last, signal.iter_mut().rev());
    }
}

/// Filters in place by one section, or by two in one pass, in which a value of the second is computed beside the
/// next one of the first; starts in the steady state of the `first` value.
fn run<'s, T: Sample + 's>(
    sections: &[Section],
    first: T,
    signal: impl Iterator<Item = &'s mut T>,
) {
    let Some((one, others)) = sections.split_first() else { return };
    let mut before = one.steady(first);
    let Some(two) = others.first() else {
        return signal.for_each(|value| *value = one.step(*value, &mut before));
    };
    let between = one.step(first, &mut one.steady(first));
    let mut after = two.steady(between);
    signal.for_each(|value| *value = two.step(one.step(*value, &mut before), &mut after));
}

/// Fills `edge` samples at each end with the extension of the signal between them.
fn extend<T: Sample>(signal: &mut [T], edge: usize, extension: Extension) {
    let last = signal.len() - 1 - edge;
    for k in 1..=edge {
        signal[edge - k] = extension.beyond(signal[edge], signal[edge + k]);
        signal[last + k] = extension.beyond(signal[last], signal[last - k]);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::least_squares::tests::lcg;
    use super::*;

    /// `scipy.signal.sosfiltfilt` of a Butterworth filter.
    pub(crate) fn low_pass(signal: &[f64], order: usize, cutoff: f64, rate: f64) -> Vec<f64> {
        let sections = butterworth(order, cutoff, rate).unwrap();
        filter_both_ways(&sections, signal, reflected(&sections), Extension::Odd)
    }

    /// sin(5 t) + uniform noise, 60 samples at 100 Hz.
    pub(crate) fn noisy_sine() -> Vec<f64> {
        lcg(60, 3).iter().enumerate().map(|(k, e)| (0.05 * k as f64).sin() + e).collect()
    }

    #[track_caller]
    pub(crate) fn assert_samples(found: &[f64], at: &[usize], expected: &[f64], tolerance: f64) {
        for (&k, &e) in at.iter().zip(expected) {
            assert!((found[k] - e).abs() <= tolerance, "sample {k}: {} is not {e}", found[k]);
        }
    }

    #[test]
    fn a_fourth_order_design_equals_scipy_butter() {
        let sections = butterworth(4, 8.0, 100.0).unwrap();
        // scipy.signal.butter(4, 8, fs=100, output="sos"), poles sorted the other way round
        let gain: f64 = sections.iter().map(|s| s.numerator[0]).product();
        assert!((gain - 0.002234891698082326).abs() < 1e-16);
        let narrow = sections[0].denominator;
        let wide = sections[1].denominator;
        assert_samples(&narrow, &[0, 1], &[-1.479798894397217, 0.6886769530538618], 1e-14);
        assert_samples(&wide, &[0, 1], &[-1.2128120926202186, 0.3840041622865537], 1e-14);
    }

    #[test]
    fn noisy_signals_come_out_as_from_scipy_sosfiltfilt() {
        let at = [0, 1, 7, 30, 58, 59];
        let v = noisy_sine();
        // scipy 1.17, even and odd orders; both are exact up to rounding
        let cases = [
            (
                4,
                8.0,
                [
                    -0.26822478623299295,
                    -0.08538468141979356,
                    0.41098043896342684,
                    1.0489231293008736,
                    0.19767208757472818,
                    0.11508930173563307,
                ],
            ),
            (
                3,
                12.0,
                [
                    -0.2631857977183093,
                    0.022540310530750285,
                    0.27903821513964655,
                    1.0386376297650954,
                    0.1951786184885263,
                    0.11145827176234611,
                ],
            ),
            (
                2,
                20.0,
                [
                    -0.2626920695993218,
                    0.11876128862362291,
                    0.24636747223821664,
                    0.9761873268323717,
                    0.2423090891674351,
                    0.11174294619937224,
                ],
            ),
        ];
        for (order, cutoff, expected) in cases {
            assert_samples(&low_pass(&v, order, cutoff, 100.0), &at, &expected, 1e-12);
        }
    }

    #[test]
    fn filter_and_difference_commute_up_to_the_ends() {
        let v = noisy_sine();
        let slope = |v: &[f64]| -> Vec<f64> {
            let at = |k: usize| v[(k + 1).min(v.len() - 1)] - v[k.saturating_sub(1)];
            (0..v.len()).map(|k| if k % (v.len() - 1) == 0 { 2.0 * at(k) } else { at(k) }).collect()
        };
        let sections = butterworth(4, 8.0, 100.0).unwrap();
        let first = slope(&filter_both_ways(&sections, &v, 59, Extension::Odd));
        let last = filter_both_ways(&sections, &slope(&v), 59, Extension::Even);
        // exact but for the start of the filter, which has died away over the 59 samples to 1e-4
        assert_samples(&first, &(0..v.len()).collect::<Vec<_>>(), &last, 2e-3);
    }

    #[test]
    fn a_constant_passes_unchanged() {
        let flat = low_pass(&[7.0; 40], 4, 5.0, 100.0);
        assert!(flat.iter().all(|f| (f - 7.0).abs() < 1e-12));
    }

    #[test]
    fn bad_input_is_refused() {
        assert!(butterworth(4, 50.0, 100.0).is_err());
        assert!(butterworth(0, 5.0, 100.0).is_err());
        assert!(butterworth(4, f64::NAN, 100.0).is_err());
    }
}
