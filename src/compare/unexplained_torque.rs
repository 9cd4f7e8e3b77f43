//! The unmodelled torque as a function of a variable, by a score test with the Kalman filter.

use nalgebra::{DMatrix, DVector};

use super::circle::{self, opened};
use crate::effects::Motion;
use crate::filter::{Columns, Instant, Likelihood, ProcessNoise};
use crate::math::distribution::chi2_log_survival;
use crate::math::{Information, eliminate, pseudo_inverse, quantile_of_sorted};
use crate::model::{Model, ModelError};
use crate::recording::Recording;

/// Variables on which the residual torque may depend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// Speed of wheel 1 [rad/s].
    Omega1,
    /// Speed of wheel 2 [rad/s].
    Omega2,
    /// Acceleration of wheel 1 [rad/s^2].
    Acceleration1,
    /// Acceleration of wheel 2 [rad/s^2].
    Acceleration2,
    /// Speed of the axle's centre [m/s].
    ForwardSpeed,
    /// Turn rate [rad/s].
    TurnRate,
    /// Heading \[rad\], modulo a turn.
    Heading,
    /// Angle of wheel 1 \[rad\], modulo a turn.
    Alpha1,
    /// Angle of wheel 2 \[rad\], modulo a turn.
    Alpha2,
    /// Time since the start \[s\].
    Time,
    /// Input of wheel 1 [N m].
    #[serde(rename = "moment1")]
    Input1,
    /// Input of wheel 2 [N m].
    #[serde(rename = "moment2")]
    Input2,
}

impl Variable {
    /// All variables.
    pub const ALL: [Self; 12] = [
        Self::Omega1,
        Self::Omega2,
        Self::Acceleration1,
        Self::Acceleration2,
        Self::ForwardSpeed,
        Self::TurnRate,
        Self::Heading,
        Self::Alpha1,
        Self::Alpha2,
        Self::Time,
        Self::Input1,
        Self::Input2,
    ];

    /// Whether it is an acceleration.
    #[must_use]
    pub(super) const fn is_acceleration(self) -> bool {
        matches!(self, Self::Acceleration1 | Self::Acceleration2)
    }

    /// Whether it is an angle modulo a turn.
    #[must_use]
    pub(super) const fn is_cyclic(self) -> bool {
        matches!(self, Self::Heading | Self::Alpha1 | Self::Alpha2)
    }

    /// Whether feedback control makes the variable respond to every disturbance: inputs, and therefore
    /// accelerations.
    #[must_use]
    pub const fn answers(self) -> bool {
        self.is_acceleration() || matches!(self, Self::Input1 | Self::Input2)
    }

    /// Unit, for an input in `drive_unit`.
    #[must_use]
    pub fn unit(self, drive_unit: &'static str) -> &'static str {
        match self {
            Self::Omega1 | Self::Omega2 | Self::TurnRate => "rad/s",
            Self::Acceleration1 | Self::Acceleration2 => "rad/s²",
            Self::ForwardSpeed => "m/s",
            Self::Heading | Self::Alpha1 | Self::Alpha2 => "rad",
            Self::Time => "s",
            Self::Input1 | Self::Input2 => drive_unit,
        }
    }

    pub(super) fn at(
        self,
        motion: &Motion<f64>,
        acceleration: &[f64; 2],
        torque: &[f64; 2],
    ) -> f64 {
        let turn = |x: f64| x.rem_euclid(std::f64::consts::TAU);
        match self {
            Self::Omega1 => motion.omega[0],
            Self::Omega2 => motion.omega[1],
            Self::Acceleration1 => acceleration[0],
            Self::Acceleration2 => acceleration[1],
            Self::ForwardSpeed => motion.forward_speed(),
            Self::TurnRate => motion.turn_rate(),
            Self::Heading => turn(motion.heading()),
            Self::Alpha1 => turn(motion.alpha[0]),
            Self::Alpha2 => turn(motion.alpha[1]),
            Self::Time => motion.t,
            Self::Input1 => torque[0],
            Self::Input2 => torque[1],
        }
    }
}

/// The residual torque in one bin of a variable.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Bin {
    /// Middle of the bin.
    pub at: f64,
    /// Residual torque on wheel 1 and wheel 2 [N m].
    #[serde(rename = "moment")]
    pub torque: [f64; 2],
    /// Their standard errors.
    pub std_error: [f64; 2],
}

/// How the residual torque depends on a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Dependence {
    /// Variable of the abscissa.
    pub variable: Variable,
    /// Bins in order; none without curves.
    pub bins: Vec<Bin>,
    /// Test statistic: chi-square distributed with `rank` degrees of freedom if the model is complete.
    pub statistic: f64,
    /// Degrees of freedom.
    pub rank: usize,
    /// -ln of the p-value.
    pub log_significance: f64,
    /// Root mean square of the curve over bins and wheels, minus its own noise [N m]; NaN without curves.
    pub size: f64,
}

/// What of the residual torque is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Statistic and significance of every variable.
    Tests,
    /// The curves too, which take another search for the noise and another pass.
    Curves,
}

/// All dependences, the strongest first.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct UnexplainedTorque {
    /// One per variable.
    pub dependences: Vec<Dependence>,
}

/// Number of bins per variable.
const BINS: usize = 12;
/// Directions of the binned information with less than this share are discarded.
const WEAK: f64 = 1e-4;

/// The residual torque over every variable, by a score test: an indicator column for each bin is propagated
/// in one filter pass at the fitted parameters, and the part that the parameters can absorb is projected out.
///
/// ```text
/// I = H_JJ - H_JB H_BB⁻¹ H_BJ,  s = g_J - H_JB H_BB⁻¹ g_B,  T = s' I⁺ s ~ χ²(rank I)
/// torque in a bin = s/I ± 1/√I
/// ```
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn unexplained_torque(
    model: &Model,
    p: &[f64],
    noise: &ProcessNoise,
    likelihood: &Likelihood,
    asked: Asked,
) -> Result<UnexplainedTorque, ModelError> {
    let recordings: Vec<&Recording> = likelihood.prepared.iter().map(|p| p.recording).collect();
    let edges = Variable::ALL.map(|v| Edges::of(v, model, &recordings));
    let columns = Bins { of: &edges };
    let all: Vec<&dyn Columns> = recordings.iter().map(|_| &columns as &dyn Columns).collect();
    let (h, g) = likelihood.totals(model, p, noise, &all)?;
    let base = model.free();
    let curves = match asked {
        Asked::Tests => None,
        // the tests include the slow unknown torque, which would absorb most of the curves; the curves are
        // computed without it, at the white noise that then fits
        Asked::Curves => {
            let white = Likelihood { slow_moment: false, ..likelihood.clone() };
            let flat = ProcessNoise { sigma_d: 0.0, ..*noise };
            let (flat, _) = white.noise(model, p, &flat);
            Some(white.totals(model, p, &flat, &all)?)
        }
    };
    let mut dependences: Vec<Dependence> = Variable::ALL
        .iter()
        .enumerate()
        .map(|(v, &variable)| {
            let start = p.len() + v * 2 * BINS;
            let columns: Vec<usize> = (start..start + 2 * BINS).collect();
            let (statistic, rank) = test(&h, &g, &base, &columns);
            let curve = |(h, g): &(DMatrix<f64>, DVector<f64>)| {
                curve(&edges[v].edges, h, g, &base, &columns)
            };
            let (bins, size) = curves.as_ref().map(curve).map_or((vec![], f64::NAN), |bins| {
                let size = size(&bins);
                (bins, size)
            });
            let log_significance =
                if edges[v].cut.is_some() { log_significance(statistic, rank) } else { 0.0 };
            Dependence { variable, bins, statistic, rank, log_significance, size }
        })
        .collect();
    dependences.sort_by(|a, b| b.log_significance.total_cmp(&a.log_significance));
    Ok(UnexplainedTorque { dependences })
}

/// The bins of a variable.
struct Edges {
    /// At equal counts, from the 1 % to the 99 % quantile.
    edges: Vec<f64>,
    /// Where the circle of an angle is [cut]; zero for another variable, `None` for an angle that hardly changes.
    cut: Option<f64>,
}

impl Edges {
    fn of(variable: Variable, model: &Model, recordings: &[&Recording]) -> Self {
        let mut values = Vec::new();
        for recording in recordings {
            let (t, torque) = (recording.t(), recording.torque());
            for (k, m) in recording.local_motion().iter().enumerate().step_by(3) {
                let x = Motion::at(t[k] - t[0], m.alpha, m.omega, model.robot());
                values.push(variable.at(&x, &m.acceleration, &torque[k]));
            }
        }
        let cut = match variable.is_cyclic() {
            true => circle::cut(values.iter().copied()),
            false => Some(0.0),
        };
        values.iter_mut().for_each(|v| *v = on_line(variable, *v, cut));
        values.sort_by(f64::total_cmp);
        let edge = |b: usize| quantile_of_sorted(&values, b as f64 / BINS as f64);
        Self { edges: (0..=BINS).map(edge).collect(), cut }
    }
}

/// A value of a variable, an angle on the circle that is opened at its `cut`.
fn on_line(variable: Variable, value: f64, cut: Option<f64>) -> f64 {
    if variable.is_cyclic() { opened(value, cut.unwrap_or(0.0)) } else { value }
}

struct Bins<'a> {
    of: &'a [Edges; 12],
}

impl Columns for Bins<'_> {
    fn count(&self) -> usize {
        Variable::ALL.len() * 2 * BINS
    }

    fn together(&self) -> usize {
        2 * BINS
    }

    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]) {
        out.iter_mut().for_each(|column| *column = [0.0; 2]);
        for (v, variable) in Variable::ALL.iter().enumerate() {
            let Edges { edges, cut } = &self.of[v];
            let value = variable.at(&at.motion, &at.acceleration, &at.input);
            let value = on_line(*variable, value, *cut);
            let bin = edges[1..BINS].partition_point(|edge| *edge <= value);
            out[v * 2 * BINS + 2 * bin] = [1.0, 0.0];
            out[v * 2 * BINS + 2 * bin + 1] = [0.0, 1.0];
        }
    }
}

fn test(h: &DMatrix<f64>, g: &DVector<f64>, base: &[usize], columns: &[usize]) -> (f64, usize) {
    let (information, score) = eliminate(h, g, base, columns);
    score_statistic(&information, &score)
}

fn size(bins: &[Bin]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for bin in bins {
        for (m, s) in bin.torque.iter().zip(&bin.std_error) {
            if m.is_finite() && s.is_finite() {
                sum += m * m - s * s;
                count += 1.0;
            }
        }
    }
    f64::max(sum / f64::max(count, 1.0), 0.0).sqrt()
}

/// The curve of the residual torque: all bins of a variable jointly, by the pseudo-inverse, without the part
/// that the parameters can absorb.
fn curve(
    edges: &[f64],
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    base: &[usize],
    columns: &[usize],
) -> Vec<Bin> {
    let (information, score) = eliminate(h, g, base, columns);
    // all bins are in N m: scaled to unit diagonal, as `Information` does, bins with few rows would count as others
    let largest = information.diagonal().max();
    let inverse = pseudo_inverse(&information, 1e-3 * largest.max(1e-300))
        .unwrap_or_else(|| DMatrix::zeros(columns.len(), columns.len()));
    let torque = &inverse * score;
    (0..BINS)
        .map(|b| {
            let entry = |i: usize| {
                let j = 2 * b + i;
                let empty = information[(j, j)] <= 1e-8 * h[(columns[j], columns[j])];
                let variance = inverse[(j, j)];
                if empty || variance <= 0.0 {
                    (f64::NAN, f64::NAN)
                } else {
                    (torque[j], variance.sqrt())
                }
            };
            let (one, two) = (entry(0), entry(1));
            Bin {
                at: 0.5 * (edges[b] + edges[b + 1]),
                torque: [one.0, two.0],
                std_error: [one.1, two.1],
            }
        })
        .collect()
}

/// `T = s' I⁺ s` and the rank of I; directions below 1e-4 of the largest, after scaling to unit diagonal, are
/// discarded.
#[must_use]
fn score_statistic(information: &DMatrix<f64>, score: &DVector<f64>) -> (f64, usize) {
    let known = Information::truncated(information, WEAK);
    (known.statistic(score), known.rank())
}

/// -ln P(χ²_k > T), accurate in the far tail.
#[must_use]
pub fn log_significance(statistic: f64, rank: usize) -> f64 {
    if rank == 0 { 0.0 } else { -chi2_log_survival(statistic, rank as f64) }
}
