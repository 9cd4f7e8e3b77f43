//! Regression within the bounds of physics, by convex programming.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::identifiability::inverse_where_known;
use super::inverse_dynamics::{NOISE_SHARE, Regression};
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, Note, PhysicalBound, Status, Task,
    Unsupported, fields_as_options,
};
use crate::math::robust::HUBER_THRESHOLD;
use crate::math::{clustered_covariance, robust_deviation};
use crate::model::base;

/// Inverse-dynamic regression with physical bounds (a quadratic or linear program).
///
/// ```text
/// minimise Σ loss(M - W θ)   subject to  a1 >= 1.001 |a2|,  frictions >= 0
/// ```
/// The bounds of every effect come from its description. `loss` is `squares`, `l1` (the median:
/// immune to a few wild rows) or `huber` between the two. Rows and filter as in
/// `torque_regression`. Which bound is active is read from its multiplier and stated in the notes.
///
/// Source: Sousa and Cortesão, Int. J. Robotics Research 33 (2014); solver: Goulart and Chen,
/// Clarabel (2024).
#[derive(Clone, Debug, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ConstrainedRegression {
    /// Cut-off of the filter \[Hz\]; chosen from noise and motion unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cutoff_hz: Option<f64>,
    /// Loss of a residual.
    pub loss: Loss,
    /// Largest relative distance of a1..a5 from their construction values; unlimited unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub within_construction: Option<f64>,
}

/// Loss of a residual.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// Least squares.
    #[default]
    Squares,
    /// Absolute value.
    L1,
    /// Square near zero, absolute value beyond 1.345 standard deviations.
    Huber,
}

const NAME: &str = "constrained_regression";
/// a1 exceeds |a2| by this factor, so that the mass matrix can be inverted.
const MARGIN: f64 = 1.001;
/// A multiplier above this share of the gradient's scale is an active bound.
const ACTIVE: f64 = 1e-5;

impl Identifier for ConstrainedRegression {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Regression within physical bounds (convex program)".into(),
            equation: "minimise Σ loss(M - Wθ) subject to a1 > |a2|, frictions >= 0".into(),
            source: "Sousa and Cortesão 2014; solver Clarabel (Goulart and Chen 2024)".into(),
            use_when: "least squares gives values that are physically impossible; outliers in the torques (l1)"
                .into(),
            avoid_when: "speeds are noisy (as torque_regression); its intervals are those without \
                         bounds and do not cover the bias by noise and filter"
                .into(),
        }
    }

    fn intervals_cover(&self) -> bool {
        false
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let rows = Regression::new(task, self.cutoff_hz, NOISE_SHARE, NAME)?;
        let gram = rows.x.tr_mul(&rows.x);
        let inverse = inverse_where_known(&gram);
        let unbounded = &inverse * rows.x.tr_mul(&rows.y);
        let sigma = spread(&(&rows.y - &rows.x * &unbounded));
        let bounds = self.bounds(task, rows.linear());
        let solved = self.program(&rows, &gram, sigma, &bounds).solve()?;
        let residuals = &rows.y - &rows.x * &solved.values;
        let (psi, slope) = self.influence(&residuals, spread(&residuals));
        let weighed =
            DMatrix::from_fn(rows.x.nrows(), rows.x.ncols(), |i, c| rows.x[(i, c)] * slope[i]);
        let bread = inverse_where_known(&rows.x.tr_mul(&weighed));
        let covariance = clustered_covariance(&bread, &rows.x, &psi, &rows.block, rows.x.nrows());
        let mut fit = rows.fit(NAME, &solved.values, &covariance)?;
        if self.loss == Loss::Squares {
            rows.note_of_bias(&mut fit, &rows.bias(&solved.values, &inverse));
        }
        for (bound, multiplier) in bounds.iter().zip(&solved.multipliers) {
            if *multiplier > ACTIVE {
                let symbols = task.model.symbols();
                let value =
                    |(c, _): &(usize, _)| (symbols[rows.linear()[*c]].clone(), unbounded[*c]);
                let unbounded = bound.columns.iter().map(value).collect();
                fit.notes.push(Note::ActiveBound { bound: bound.kind.clone(), unbounded });
            }
        }
        fit.status = solved.status;
        fit.work.iterations = solved.iterations;
        Ok(fit)
    }
}

/// `Σ factor θ_column >= limit`.
struct Bound {
    kind: PhysicalBound,
    columns: Vec<(usize, f64)>,
    limit: f64,
}

struct Solved {
    values: DVector<f64>,
    multipliers: Vec<f64>,
    status: Status,
    iterations: usize,
}

impl ConstrainedRegression {
    fn bounds(&self, task: &Task, linear: &[usize]) -> Vec<Bound> {
        let parameters = task.model.parameters();
        let construction = task.model.initial();
        let place = |j: usize| linear.iter().position(|&l| l == j);
        let mut out = Vec::new();
        for (c, &j) in linear.iter().enumerate() {
            let symbol = &parameters[j].spec.symbol;
            let low = parameters[j].spec.range.0;
            if low >= 0.0 {
                let kind = PhysicalBound::Range { symbol: symbol.clone(), low };
                out.push(Bound { kind, columns: vec![(c, 1.0)], limit: low });
            }
            if let Some(share) = self.within_construction.filter(|_| j < base::COUNT) {
                let reach = share * construction[j].abs();
                for side in [1.0, -1.0] {
                    let kind = PhysicalBound::Construction {
                        symbol: symbol.clone(),
                        value: construction[j] - side * reach,
                        is_lower: side > 0.0,
                    };
                    let limit = side * construction[j] - reach;
                    out.push(Bound { kind, columns: vec![(c, side)], limit });
                }
            }
        }
        for side in [1.0, -1.0] {
            let (mut columns, mut limit) = (Vec::new(), 0.0);
            for (j, factor) in [(0, 1.0), (1, side * MARGIN)] {
                match place(j) {
                    Some(c) => columns.push((c, factor)),
                    None => limit -= factor * construction[j],
                }
            }
            if !columns.is_empty() {
                out.push(Bound { kind: PhysicalBound::PositiveMass, columns, limit });
            }
        }
        out
    }

    /// The program in the variables (θ over its scale, then slacks over sigma).
    fn program(
        &self,
        rows: &Regression,
        gram: &DMatrix<f64>,
        sigma: f64,
        bounds: &[Bound],
    ) -> Program {
        let (n, width) = (rows.y.len(), rows.x.ncols());
        let scale = DVector::from_fn(width, |c, _| {
            if gram[(c, c)] > 0.0 { sigma * (n as f64 / gram[(c, c)]).sqrt() } else { 1.0 }
        });
        let mut program = Program::new(scale);
        match self.loss {
            Loss::Squares => {
                let right = rows.x.tr_mul(&rows.y);
                let unit = sigma * sigma * n as f64;
                for c in 0..width {
                    program.linear[c] = -right[c] * program.scale[c] / unit;
                    for k in 0..=c {
                        let value = gram[(k, c)] * program.scale[k] * program.scale[c] / unit;
                        program.quadratic.push((k, c, value));
                    }
                }
            }
            // Huber: residual = v + (r - v), ½ v² for v and the threshold for each |r - v|
            Loss::L1 | Loss::Huber => {
                for i in 0..n {
                    let v = (self.loss == Loss::Huber).then(|| program.variable(0.0));
                    let price = if v.is_some() { HUBER_THRESHOLD } else { 1.0 };
                    let size = program.variable(price / n as f64);
                    if let Some(v) = v {
                        program.quadratic.push((v, v, 1.0 / n as f64));
                    }
                    for side in [1.0, -1.0] {
                        // side (y - x θ - v) <= size
                        let mut row: Vec<(usize, f64)> = (0..width)
                            .map(|c| (c, -side * rows.x[(i, c)] * program.scale[c] / sigma))
                            .collect();
                        row.extend(v.map(|v| (v, -side)));
                        row.push((size, -1.0));
                        program.at_most(row, -side * rows.y[i] / sigma);
                    }
                }
            }
        }
        program.bounds = program.limits.len();
        for bound in bounds {
            let row: Vec<(usize, f64)> =
                bound.columns.iter().map(|&(c, f)| (c, -f * program.scale[c])).collect();
            // of unit length, so that multipliers compare
            let length = row.iter().map(|(_, v)| v * v).sum::<f64>().sqrt().max(1e-300);
            let row = row.into_iter().map(|(c, v)| (c, v / length)).collect();
            program.at_most(row, -bound.limit / length);
        }
        program
    }

    /// Influence of each residual and its slope.
    fn influence(&self, residuals: &DVector<f64>, sigma: f64) -> (DVector<f64>, DVector<f64>) {
        let limit = HUBER_THRESHOLD * sigma;
        // the density of residuals at zero, from those within half a standard deviation
        let near = 0.5 * sigma;
        match self.loss {
            Loss::Squares => (residuals.clone(), DVector::repeat(residuals.len(), 1.0)),
            Loss::L1 => (
                residuals.map(crate::math::sgn),
                residuals.map(|r| if r.abs() < near { 1.0 / near } else { 0.0 }),
            ),
            Loss::Huber => (
                residuals.map(|r| r.clamp(-limit, limit)),
                residuals.map(|r| if r.abs() < limit { 1.0 } else { 0.0 }),
            ),
        }
    }
}

/// Robust standard deviation, never zero.
fn spread(residuals: &DVector<f64>) -> f64 {
    robust_deviation(residuals.iter().copied()).max(1e-12)
}

/// `minimise ½ z'Pz + q'z  subject to  A z <= b`, z = (θ / scale, slacks).
struct Program {
    scale: DVector<f64>,
    quadratic: Vec<(usize, usize, f64)>,
    linear: Vec<f64>,
    rows: Vec<Vec<(usize, f64)>>,
    limits: Vec<f64>,
    /// Rows from here on are bounds of θ.
    bounds: usize,
}

impl Program {
    fn new(scale: DVector<f64>) -> Self {
        let linear = vec![0.0; scale.len()];
        Self { scale, quadratic: vec![], linear, rows: vec![], limits: vec![], bounds: 0 }
    }

    fn variable(&mut self, price: f64) -> usize {
        self.linear.push(price);
        self.linear.len() - 1
    }

    fn at_most(&mut self, row: Vec<(usize, f64)>, limit: f64) {
        self.rows.push(row);
        self.limits.push(limit);
    }

    fn solve(&self) -> Result<Solved, IdentifyError> {
        let failed = |reason| IdentifyError::Unsupported { method: NAME.into(), reason };
        let n = self.linear.len();
        let matrix = |height: usize, entries: Vec<(usize, usize, f64)>| {
            let (mut i, mut j, mut v) = (vec![], vec![], vec![]);
            for (row, column, value) in entries {
                i.push(row);
                j.push(column);
                v.push(value);
            }
            CscMatrix::new_from_triplets(height, n, i, j, v)
        };
        let p = matrix(n, self.quadratic.clone());
        let entries = self.rows.iter().enumerate();
        let entries = entries.flat_map(|(r, row)| row.iter().map(move |&(c, v)| (r, c, v)));
        let a = matrix(self.rows.len(), entries.collect());
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_iter(200)
            .tol_gap_abs(1e-10)
            .tol_gap_rel(1e-10)
            .tol_feas(1e-10)
            .build()
            .map_err(|e| failed(Unsupported::Solver(e.to_string())))?;
        let cones = [SupportedConeT::NonnegativeConeT(self.limits.len())];
        let mut solver = DefaultSolver::new(&p, &self.linear, &a, &self.limits, &cones, settings)
            .map_err(|e| failed(Unsupported::Solver(e.to_string())))?;
        solver.solve();
        let solution = &solver.solution;
        let status = match solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Status::Converged,
            SolverStatus::MaxIterations | SolverStatus::MaxTime => Status::IterationLimit,
            SolverStatus::InsufficientProgress => Status::Stalled,
            other => return Err(failed(Unsupported::Bounds(other))),
        };
        Ok(Solved {
            values: DVector::from_fn(self.scale.len(), |c, _| solution.x[c] * self.scale[c]),
            multipliers: solution.z[self.bounds..].to_vec(),
            status,
            iterations: solution.iterations as usize,
        })
    }
}
