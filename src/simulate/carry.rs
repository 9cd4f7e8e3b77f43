//! Integration steps of the sensitivities, one register of columns at a time.

use std::convert::Infallible;

use pulp::{Simd, WithSimd};

use super::forces::Departure;
use super::forcing::{Forcing, LANES, Pair, Quantities};
use crate::math::{Lanes, runge_kutta_motion, runge_kutta_step};
use crate::model::times;

/// The variational equation at one instant, solved for the accelerations: `dω' = by_state · (dα, dω) +
/// forcing`.
#[derive(Clone)]
pub(super) struct Node {
    /// Acceleration and friction signs for which it was solved.
    pub(super) place: ([f64; 2], [f64; 4]),
    pub(super) by_state: [[f64; 4]; 2],
    pub(super) forcing: Vec<Pair>,
}

/// Accelerations with a relative difference below this value differ by rounding.
const ROUNDING: f64 = 1e-9;

impl Node {
    /// Derivatives of the accelerations with respect to the columns of a register from lane `r` of group `g`
    /// on, for derivatives `w` of the speeds, without the part due to the angles.
    #[inline(always)]
    fn rate<S: Simd>(&self, simd: S, (g, r): (usize, usize), w: &[Lanes<S>; 2]) -> [Lanes<S>; 2] {
        let ([first, second], forcing) = (&self.by_state, &self.forcing[g]);
        [
            Lanes::load(simd, &forcing[0][r..]) + w[0] * first[2] + w[1] * first[3],
            Lanes::load(simd, &forcing[1][r..]) + w[0] * second[2] + w[1] * second[3],
        ]
    }

    /// Adds the accelerations by derivatives of the input at a share of the sample; `inverse` is that of the mass
    /// matrix.
    #[inline(always)]
    fn add_input(&mut self, (input, inverse): (&[InputSlope], &[f64; 3]), share: f64) {
        for (j, [start, end]) in input {
            let torque =
                [start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])];
            let a = times(inverse, &torque);
            let [first, second] = &mut self.forcing[j / LANES];
            first[j % LANES] += a[0];
            second[j % LANES] += a[1];
        }
    }

    /// Whether it is valid at the start of a step that begins where it was solved.
    pub(super) fn holds(&self, from: &Departure) -> bool {
        let (a, sign) = self.place;
        let close = |i: usize| {
            let now = from.rate[2 + i];
            (now - a[i]).abs() <= ROUNDING * (1.0 + now.abs())
        };
        sign == from.contact.sign && close(0) && close(1)
    }
}

/// A parameter, and the derivatives of the input with respect to it at both ends of a sample.
pub(super) type InputSlope = (usize, [[f64; 2]; 2]);

/// A step of the first `columns` columns if nothing depends on the angles, which are then integrated from the
/// speeds.
pub(super) struct Carry<'a> {
    /// At the start, in the middle and at the end.
    pub(super) nodes: [&'a mut Node; 3],
    /// Derivatives of alpha1, alpha2, omega1 and omega2, each a row of all columns.
    pub(super) rows: [&'a mut [f64]; 4],
    pub(super) h: f64,
    pub(super) columns: usize,
}

/// The same if something depends on the angles.
pub(super) struct Turn<'a>(pub(super) Carry<'a>);

/// An instant at which a node of sliding wheels is solved: the quantities, and the share of the sample at which the
/// input acts.
pub(super) type Solved = (Quantities, f64);

/// The same as [`Carry`] after the nodes of sliding wheels are solved: at the start, unless its node is known, in the
/// middle and at the end. Everything is borrowed: a register that is loaded for a copy from numbers just stored one by
/// one waits until they are in memory.
pub(super) struct Slide<'a, 'b> {
    pub(super) forcing: &'b Forcing,
    pub(super) start: Option<&'b Solved>,
    pub(super) later: &'b [Solved; 2],
    /// Derivatives of the input with respect to parameters at both ends of the sample, and the inverse of the
    /// mass matrix.
    pub(super) input: (&'b [InputSlope], &'b [f64; 3]),
    pub(super) carry: &'b mut Carry<'a>,
}

impl WithSimd for &mut Slide<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Slide { forcing, start, later, input, carry } = self;
        let columns = carry.columns;
        let [first, middle, end] = &mut carry.nodes;
        if let Some((quantities, share)) = start {
            forcing.write(simd, [quantities], columns, [&mut first.forcing]);
            first.add_input(*input, *share);
        }
        let [at_middle, at_end] = later;
        let out = [&mut middle.forcing[..], &mut end.forcing[..]];
        forcing.write(simd, [&at_middle.0, &at_end.0], columns, out);
        middle.add_input(*input, at_middle.1);
        end.add_input(*input, at_end.1);
        carry.with_simd(simd);
    }
}

impl WithSimd for &mut Carry<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [start, middle, end] = &self.nodes;
        let (start, middle, end): (&Node, &Node, &Node) = (start, middle, end);
        let [a1, a2, w1, w2] = &mut self.rows;
        let (a1, a2, w1, w2) = (&mut a1[..], &mut a2[..], &mut w1[..], &mut w2[..]);
        for c in (0..self.columns).step_by(Lanes::<S>::COUNT) {
            let place = (c / LANES, c % LANES);
            let angles = [Lanes::load(simd, &a1[c..]), Lanes::load(simd, &a2[c..])];
            let speeds = [Lanes::load(simd, &w1[c..]), Lanes::load(simd, &w2[c..])];
            let first = start.rate(simd, place, &speeds);
            let Ok((angles, speeds)) = runge_kutta_motion(
                &angles,
                &speeds,
                &first,
                self.h,
                // a function without a closure, which would not be compiled for wide registers
                #[inline(always)]
                |c, _, w| {
                    let node = if c < 1.0 { middle } else { end };
                    Ok::<_, Infallible>(node.rate(simd, place, w))
                },
            );
            angles[0].store(&mut a1[c..]);
            angles[1].store(&mut a2[c..]);
            speeds[0].store(&mut w1[c..]);
            speeds[1].store(&mut w2[c..]);
        }
    }
}

impl WithSimd for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Carry { nodes: [start, middle, end], rows, h, columns } = self.0;
        for c in (0..columns).step_by(Lanes::<S>::COUNT) {
            let place = (c / LANES, c % LANES);
            let before = [
                Lanes::load(simd, &rows[0][c..]),
                Lanes::load(simd, &rows[1][c..]),
                Lanes::load(simd, &rows[2][c..]),
                Lanes::load(simd, &rows[3][c..]),
            ];
            let Ok(after) = runge_kutta_step(
                &before,
                h,
                #[inline(always)]
                |c, x| {
                    let node = if c == 0.0 {
                        &*start
                    } else if c < 1.0 {
                        &*middle
                    } else {
                        &*end
                    };
                    let [first, second] = node.rate(simd, place, &[x[2], x[3]]);
                    let [by_first, by_second] = &node.by_state;
                    let of_first = x[0] * by_first[0] + x[1] * by_first[1];
                    let of_second = x[0] * by_second[0] + x[1] * by_second[1];
                    Ok::<_, Infallible>([x[2], x[3], first + of_first, second + of_second])
                },
            );
            for i in 0..4 {
                after[i].store(&mut rows[i][c..]);
            }
        }
    }
}
