//! The zero-phase filter of many signals side by side, in the widest registers.

use pulp::{Simd, WithSimd};

use super::filter::{Extension, Memory, Section};
use super::lanes::{Lanes, in_lanes};
use super::products::FILLED;

/// Registers of a row that are filtered in one pass: a value depends on the one before, so that one alone waits.
const TOGETHER: usize = 2;

/// [`filter_both_ways`](super::filter::filter_both_ways) of every column of `rows`, in place and equal to the last bit.
///
/// Row k has `width` numbers, a multiple of [`FILLED`]; there are more than `edge` rows of signals, with `edge` free
/// rows before and after them.
pub(crate) fn filter_columns(
    sections: &[Section],
    (rows, width): (&mut [f64], usize),
    edge: usize,
    extension: Extension,
) {
    debug_assert!(width % FILLED == 0 && rows.len() % width == 0 && rows.len() > 3 * edge * width);
    let last = rows.len() / width - 1 - edge;
    for k in 1..=edge {
        for c in 0..width {
            let at = |row: usize| row * width + c;
            rows[at(edge - k)] = extension.beyond(rows[at(edge)], rows[at(edge + k)]);
            rows[at(last + k)] = extension.beyond(rows[at(last)], rows[at(last - k)]);
        }
    }
    in_lanes(BothWays { sections, rows, width });
}

/// Forwards and backwards over all rows.
struct BothWays<'a> {
    sections: &'a [Section],
    rows: &'a mut [f64],
    width: usize,
}

impl WithSimd for BothWays<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for first in (0..self.width).step_by(TOGETHER * Lanes::<S>::COUNT) {
            if first + Lanes::<S>::COUNT < self.width {
                self.both_ways::<S, TOGETHER>(simd, first);
            } else {
                self.both_ways::<S, 1>(simd, first);
            }
        }
    }
}

impl BothWays<'_> {
    /// Of `N` registers from column `first` on.
    #[inline(always)]
    fn both_ways<S: Simd, const N: usize>(&mut self, simd: S, first: usize) {
        for backwards in [false, true] {
            for section in self.sections.chunks(2) {
                match section {
                    [one, two] => self.run::<S, N>(simd, (one, Some(two)), first, backwards),
                    [one] => self.run::<S, N>(simd, (one, None), first, backwards),
                    _ => {}
                }
            }
        }
    }

    /// One section, or two in one pass, from the steady state of the first row on.
    #[inline(always)]
    fn run<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (one, two): (&Section, Option<&Section>),
        first: usize,
        backwards: bool,
    ) {
        let count = self.rows.len() / self.width;
        let start = if backwards { count - 1 } else { 0 };
        let nothing = Lanes::splat(simd, 0.0);
        let mut before = [Memory { next: nothing, later: nothing }; N];
        let mut after = before;
        for n in 0..N {
            let place = start * self.width + first + n * Lanes::<S>::COUNT;
            let value = Lanes::load(simd, &self.rows[place..]);
            before[n] = one.steady(value);
            if let Some(two) = two {
                after[n] = two.steady(one.step(value, &mut one.steady(value)));
            }
        }
        for k in 0..count {
            let row = if backwards { count - 1 - k } else { k };
            for n in 0..N {
                let place = row * self.width + first + n * Lanes::<S>::COUNT;
                let mut value = Lanes::load(simd, &self.rows[place..]);
                value = one.step(value, &mut before[n]);
                if let Some(two) = two {
                    value = two.step(value, &mut after[n]);
                }
                value.store(&mut self.rows[place..]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::filter::{butterworth, filter_both_ways};
    use super::super::lanes::every_width;
    use super::*;

    #[test]
    fn columns_are_filtered_as_single_signals_at_every_width_of_the_registers() {
        let (count, edge) = (40, 13);
        let value = |k: usize, c: usize| ((7 * k + 3 * c) as f64).sin();
        for (width, order) in [(8, 4), (16, 3), (24, 2)] {
            let sections = butterworth(order, 5.0, 100.0).unwrap();
            for extension in [Extension::Odd, Extension::Even] {
                let mut rows = vec![0.0; (count + 2 * edge) * width];
                for k in 0..count {
                    (0..width).for_each(|c| rows[(edge + k) * width + c] = value(k, c));
                }
                filter_columns(&sections, (&mut rows, width), edge, extension);
                for c in 0..width {
                    let signal: Vec<f64> = (0..count).map(|k| value(k, c)).collect();
                    let expected = filter_both_ways(&sections, &signal, edge, extension);
                    let found = (0..count).map(|k| rows[(edge + k) * width + c]);
                    assert!(found.eq(expected), "{width} {order} {c}");
                }
            }
            let rows: Vec<f64> = (0..count * width).map(|k| value(k, 1)).collect();
            let at = |arch: pulp::Arch| {
                let mut rows = rows.clone();
                arch.dispatch(BothWays { sections: &sections, rows: &mut rows, width });
                rows
            };
            let all: Vec<Vec<f64>> = every_width().into_iter().map(at).collect();
            assert!(all.iter().all(|rows| *rows == all[0]));
        }
    }
}
