//! Fuzzy emulator fitted by the simplex of Nelder and Mead.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Scaled, Search, Start};
use super::{IdentifyError, MethodDescription, NoStart, Status};

/// The simplex of Nelder and Mead over the consequents of the rules that the recordings reach, several
/// vertices a round.
///
/// ```text
/// c      = mean of the best n + 1 - p vertices
/// x_r    = 2 c - x for each of the p worst; then, where it is the best of all, x_e = 3 c - 2 x,
///          where it is no better than the vertices kept, (c + x_r)/2 or (c + x)/2
/// shrink   halfway to the best vertex where none of the p has improved
/// first  = start + edge · columns of L⁻ᵀ,   L Lᵀ = ∫ Psi'Psi dt + 1 % of its mean diagonal
/// ```
/// The p moves do not depend on each other, so that their costs are computed side by side. The moves commute
/// with linear maps, so that the first simplex alone decides in what scales the search goes: its edges are as
/// long as the data of the serial-parallel structure leave each direction open.
///
/// Source: Nelder and Mead, Computer Journal 7 (1965); several vertices a round: Lee and Wiswall,
/// Computational Economics 30 (2007).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Simplex {
    /// Largest number of rounds.
    pub iterations: usize,
    /// Edge of the first simplex: its square is the increase of the ISE, by each edge, for an emulator in the
    /// serial-parallel structure [rad/√s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub edge: f64,
    /// Initial values.
    pub start: Start,
}

impl Default for Simplex {
    fn default() -> Self {
        Self { iterations: 200, edge: 1.0, start: Start::Best }
    }
}

/// Largest number of vertices that move in a round: as many as the widest registers simulate at once.
const MOST_MOVES: usize = 8;
/// Smallest number of vertices per vertex that moves, so that the shape of the simplex is kept.
const KEPT: usize = 3;
/// Share of the mean curvature that is added to regularise directions that the data do not determine.
const OPEN: f64 = 1e-2;
/// Relative difference of the costs of the worst and the best vertex at which it has converged.
const TOLERANCE: f64 = 1e-6;

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyNelderMead = Fuzzy<Simplex>;

impl Search for Simplex {
    const NAME: &'static str = "fuzzy_nelder_mead";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: Nelder-Mead simplex".into(),
            equation: "minimise ISE(theta) without derivatives by a simplex of n + 1 points".into(),
            source: "Nelder and Mead 1965; Lee and Wiswall 2007".into(),
            use_when: "optimisers are compared".into(),
            avoid_when: "more than a dozen rules are fitted: the simplex stagnates in many \
                         dimensions"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let start = job.start(self.start)?;
        let free = job.problem.reached();
        let mut curvature = job.problem.closed_curvature(&free);
        let n = free.len();
        let open = OPEN * curvature.trace() / n.max(1) as f64;
        curvature += DMatrix::identity(n, n) * open;
        let Some(factor) = curvature.cholesky() else {
            return Err(job.no_start(NoStart::Rules));
        };
        let scaled = Scaled { start, free, factor: factor.l() };
        let simplex = Vertices { job, scaled, vertices: vec![] };
        Ok(simplex.descend(self.edge, self.iterations))
    }
}

/// Steps from the start in scaled coordinates, and their cost.
type Vertex = (DVector<f64>, f64);

/// The simplex in the space of the free consequents.
struct Vertices<'a> {
    job: &'a Job,
    scaled: Scaled,
    /// From the best to the worst.
    vertices: Vec<Vertex>,
}

impl Vertices<'_> {
    fn theta(&self, z: &DVector<f64>) -> Vec<f64> {
        self.scaled.theta(z).data.into()
    }

    fn judged(&self, points: Vec<DVector<f64>>) -> Vec<Vertex> {
        let thetas: Vec<Vec<f64>> = points.iter().map(|z| self.theta(z)).collect();
        let costs = self.job.problem.costs(&thetas);
        let best = costs.iter().copied().fold(f64::INFINITY, f64::min);
        self.job.journal.note_many(costs.len(), best);
        points.into_iter().zip(costs).collect()
    }

    fn descend(mut self, edge: f64, iterations: usize) -> Found {
        let n = self.scaled.free.len();
        let corner = |i: usize| DVector::from_fn(n, |j, _| if i == j { edge } else { 0.0 });
        self.vertices = self.judged((0..=n).map(corner).collect());
        let (mut rounds, mut status) = (0, Status::IterationLimit);
        while rounds < iterations {
            self.vertices.sort_by(|a, b| a.1.total_cmp(&b.1));
            if self.vertices[n].1 - self.vertices[0].1 <= TOLERANCE * self.vertices[0].1 {
                status = Status::Converged;
                break;
            }
            self.round((n / KEPT).clamp(1, MOST_MOVES));
            rounds += 1;
        }
        self.vertices.sort_by(|a, b| a.1.total_cmp(&b.1));
        Found { theta: self.theta(&self.vertices[0].0), iterations: rounds, status }
    }

    /// Moves the `moves` worst vertices.
    fn round(&mut self, moves: usize) {
        let kept = self.vertices.len() - moves;
        let (best, last_kept) = (self.vertices[0].1, self.vertices[kept - 1].1);
        let mut centre = DVector::zeros(self.scaled.free.len());
        self.vertices[..kept].iter().for_each(|(z, _)| centre += z);
        centre /= kept as f64;
        let reflect = |(z, _): &Vertex| &centre * 2.0 - z;
        let reflected = self.judged(self.vertices[kept..].iter().map(reflect).collect());
        // a reflection that is neither the best of all nor as bad as those that move is taken as it is
        let second = |(old, new): (&Vertex, &Vertex)| {
            if new.1 < best {
                Some(&centre * 3.0 - &old.0 * 2.0)
            } else if new.1 < last_kept {
                None
            } else {
                Some((&centre + if new.1 < old.1 { &new.0 } else { &old.0 }) * 0.5)
            }
        };
        let pairs = self.vertices[kept..].iter().zip(&reflected);
        let trials: Vec<Option<DVector<f64>>> = pairs.map(second).collect();
        let asked: Vec<bool> = trials.iter().map(Option::is_some).collect();
        let mut tried = self.judged(trials.into_iter().flatten().collect()).into_iter();
        let mut improved = false;
        for ((old, new), asked) in self.vertices[kept..].iter_mut().zip(reflected).zip(asked) {
            let tried = if asked { tried.next() } else { None };
            let better = tried.filter(|tried| tried.1 < new.1.min(old.1));
            improved |= better.is_some() || new.1 < last_kept;
            if let Some(found) = better.or(Some(new)).filter(|found| found.1 < old.1) {
                *old = found;
            }
        }
        if !improved {
            self.shrink();
        }
    }

    /// All vertices halfway to the best one.
    fn shrink(&mut self) {
        let best = &self.vertices[0].0;
        let halfway = self.vertices[1..].iter().map(|(z, _)| (z + best) * 0.5).collect();
        let moved = self.judged(halfway);
        self.vertices.truncate(1);
        self.vertices.extend(moved);
    }
}
