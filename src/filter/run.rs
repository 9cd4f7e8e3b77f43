//! The filter on its way from row to row: prediction, derivatives, measurement.

use nalgebra::{DMatrix, DVector};

use super::accumulate::ScoreSums;
use super::correction::{CHANNELS, Channel, Covariance, Mean, channels, correct};
use super::dynamics::Dynamics;
use super::input_noise::InputNoise;
use super::prepare::Prepared;
use super::sample::{Predicted, Sample};
use crate::math::LogProduct;
use crate::model::ModelError;
use crate::simulate::Ends;

/// Variance of an angle that defines the other one, of a computed channel.
pub(super) const EXACT: f64 = 1e-12;

/// Where a piece starts.
pub(super) struct Start {
    /// Angles \[rad\] and speeds [rad/s].
    pub(super) alpha: [f64; 2],
    pub(super) omega: [f64; 2],
    /// Variances of (alpha1, alpha2, omega1, omega2).
    pub(super) variance: [f64; 4],
    /// Acting input [N m].
    pub(super) input: [f64; 2],
}

/// Derivatives of the input over a step by the parameters.
#[derive(Clone, Debug)]
pub(super) struct InputSlopes {
    /// Of its mean.
    pub(super) mean: Vec<[f64; 2]>,
    /// Of its values at both ends, for parameters that act through them.
    pub(super) ends: Vec<Option<Ends>>,
}

/// What drives the filter over the rows of a recording.
pub(super) trait Drive {
    /// The step from row k - 1 to row k, with the derivatives of its input in `slopes` if they are wanted.
    fn sample<'s>(&self, k: usize, slopes: Option<&'s mut InputSlopes>) -> Sample<'s>;

    /// Writes the torques of the columns beyond the parameters over that step [N m].
    fn columns(&self, k: usize, sample: &Sample, predicted: &Predicted, extra: &mut [[f64; 2]]);
}

/// A measured value less its prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Row of the recording.
    pub row: usize,
    /// Channel: alpha1, alpha2, omega1, omega2.
    pub channel: usize,
    /// Innovation [rad, rad/s].
    pub value: f64,
    /// Its predicted variance [rad², rad²/s²].
    pub variance: f64,
}

/// Sums over the measured values of a run.
#[derive(Clone)]
pub(crate) struct Sums {
    /// Measured values.
    pub(crate) count: f64,
    /// `Σ e²/S`, e the innovation, S its variance.
    pub(crate) square: f64,
    /// `Σ ln S`.
    pub(crate) log_variance: f64,
    /// `Σ ψ ψ'/S`, of the parameters and of the columns behind them.
    pub(crate) information: DMatrix<f64>,
    /// `Σ ψ e/S`, ψ the derivative of the prediction.
    pub(crate) score: DVector<f64>,
    /// The same block by block, where blocks are closed.
    pub(crate) blocks: Vec<DVector<f64>>,
}

/// State and sums of a run.
pub(super) struct Run<'a, D, const N: usize> {
    dynamics: D,
    prepared: &'a Prepared<'a>,
    channels: Vec<Channel>,
    mean: Mean<N>,
    covariance: Covariance<N>,
    /// Derivatives of the mean by parameters and columns; empty if only the likelihood is wanted.
    psi: Vec<[f64; N]>,
    slopes: Option<InputSlopes>,
    /// Torques of the columns.
    extra: Vec<[f64; 2]>,
    information: ScoreSums,
    log_variance: LogProduct,
    square: f64,
    count: f64,
    blocks: Vec<DVector<f64>>,
    /// The mean score due to noise of the input, where it is wanted.
    pub(super) input_noise: Option<InputNoise<N>>,
    /// Innovations, where they are kept.
    pub(super) innovations: Option<Vec<Innovation>>,
}

impl<'a, D: Dynamics<N>, const N: usize> Run<'a, D, N> {
    /// A run with these `variance`s of the channels. With derivatives there are so many `(parameters, columns)`.
    pub(super) fn new(
        dynamics: D,
        prepared: &'a Prepared<'a>,
        variance: &[f64; 4],
        single: bool,
        derivatives: Option<(usize, usize)>,
    ) -> Self {
        let (parameters, columns) = derivatives.unwrap_or((0, 0));
        let width = parameters + columns;
        let slopes = InputSlopes { mean: vec![[0.0; 2]; parameters], ends: vec![None; parameters] };
        Self {
            dynamics,
            prepared,
            channels: channels(variance, &prepared.used, single),
            mean: Mean::zeros(),
            covariance: Covariance::zeros(),
            psi: vec![[0.0; N]; width],
            slopes: derivatives.map(|_| slopes),
            extra: vec![[0.0; 2]; columns],
            information: ScoreSums::new(width),
            log_variance: LogProduct::new(),
            square: 0.0,
            count: 0.0,
            blocks: vec![],
            input_noise: None,
            innovations: None,
        }
    }

    /// Leaves out the information that columns behind the `parameters` have about those of other groups of this `size`.
    pub(super) fn test_in_groups(&mut self, parameters: usize, size: usize) {
        self.information = ScoreSums::in_groups(self.psi.len(), parameters, size);
    }

    /// Starts a piece at row `k`; wheels that rest there have no speed.
    pub(super) fn start(&mut self, k: usize, start: &Start) {
        let still = self.prepared.still[k];
        (self.mean, self.covariance) = (Mean::zeros(), Covariance::zeros());
        for i in 0..2 {
            self.mean[i] = start.alpha[i];
            self.mean[2 + i] = if still[i] { 0.0 } else { start.omega[i] };
        }
        for i in 0..CHANNELS {
            self.covariance[(i, i)] = start.variance[i];
        }
        self.dynamics.start(&start.input, &mut self.mean, &mut self.covariance);
        self.psi.iter_mut().for_each(|column| *column = [0.0; N]);
        if let Some(input_noise) = &mut self.input_noise {
            input_noise.restart();
        }
    }

    /// Moves on to row `k`.
    #[inline]
    pub(super) fn row(&mut self, k: usize, drive: &impl Drive) -> Result<(), ModelError> {
        let derivatives = self.slopes.is_some();
        let sample = drive.sample(k, self.slopes.as_mut());
        let (mean, covariance) = (&mut self.mean, &mut self.covariance);
        let predicted = self.dynamics.predict(&sample, mean, covariance, derivatives)?;
        if derivatives {
            drive.columns(k, &sample, &predicted, &mut self.extra);
            self.dynamics.carry(&sample, &self.extra, &mut self.psi);
        }
        if let Some(input_noise) = &mut self.input_noise {
            let slopes = self.dynamics.mass_slopes(&predicted);
            let moved = (&self.dynamics.transition(), &self.dynamics.gain());
            input_noise.carry(moved, slopes, sample.step, sample.still);
        }
        if self.prepared.recording.is_reading(k) {
            self.measure(k);
        }
        Ok(())
    }

    #[inline]
    fn measure(&mut self, k: usize) {
        let recording = self.prepared.recording;
        let ([a1, a2], [w1, w2]) = (recording.alpha()[k], recording.omega()[k]);
        let values = [a1, a2, w1, w2];
        let (mean, covariance, psi) = (&mut self.mean, &mut self.covariance, &mut self.psi);
        for channel in &self.channels {
            let row = self.information.next_row();
            let Some(number) = channel.value else {
                // the difference of the wheels of a single axis contains no information
                correct(channel, 0.0, mean, covariance, psi, row);
                continue;
            };
            if let Some(input_noise) = &mut self.input_noise {
                let s = covariance[(number, number)] + channel.variance;
                input_noise.correct(number, s, covariance);
            }
            let (e, s) = correct(channel, values[number], mean, covariance, psi, row);
            self.count += 1.0;
            self.square += e * (e / s);
            self.log_variance.add(s);
            self.information.add(e, s);
            if let Some(innovations) = &mut self.innovations {
                innovations.push(Innovation { row: k, channel: number, value: e, variance: s });
            }
        }
    }

    /// Blocks closed so far.
    pub(super) fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Closes a block of rows whose score is kept apart, if it has one.
    pub(super) fn close(&mut self) {
        let score = self.information.take_score();
        if score.iter().any(|v| *v != 0.0) {
            self.blocks.push(score);
        }
    }

    /// The sums, with what else was wanted.
    pub(super) fn finish(self) -> (Sums, Option<InputNoise<N>>, Option<Vec<Innovation>>) {
        let (information, score) = self.information.finish();
        let sums = Sums {
            count: self.count,
            square: self.square,
            log_variance: self.log_variance.finish(),
            information,
            score,
            blocks: self.blocks,
        };
        (sums, self.input_noise, self.innovations)
    }
}
