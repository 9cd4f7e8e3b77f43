//! Fuzzy emulator fitted by a genetic algorithm.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Journal, Problem, Search, Start};
use super::{IdentifyError, MethodDescription, Status};

/// A real-coded genetic algorithm over the consequents of the rules that the recordings reach.
///
/// ```text
/// parents   best of three drawn at random, twice
/// child     every gene uniform between the parents' and 30 % beyond on either side (BLX-0.3)
/// mutation  each gene with 1/n, normal; its size falls from 0.2 reach to 0.002 reach
/// survivors the two best as they are, children for the rest
/// ```
/// All random numbers are drawn in one order from the seed of the task and only the costs are
/// computed in parallel and side by side in registers, so that the result depends neither on the number of
/// threads nor on the width of the registers.
///
/// Source: the paper's abstract (genetic algorithms); Eshelman and Schaffer, Foundations of Genetic
/// Algorithms 2 (1993) for the crossover.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Genetic {
    /// Size of the population.
    #[schemars(range(min = 4))]
    pub population: usize,
    /// Number of generations.
    pub generations: usize,
    /// Half the interval of every consequent, about the start [rad/s²].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: f64,
    /// Initial value of the first individual.
    pub start: Start,
}

impl Default for Genetic {
    fn default() -> Self {
        Self { population: 40, generations: 100, reach: 5.0, start: Start::Friction }
    }
}

/// Number of individuals that survive unchanged.
const ELITE: usize = 2;
/// Distance beyond its parents at which a child may lie, relative to their distance.
const BEYOND: f64 = 0.3;

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyGenetic = Fuzzy<Genetic>;

impl Search for Genetic {
    const NAME: &'static str = "fuzzy_genetic";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: genetic algorithm".into(),
            equation: "tournaments of three, BLX-0.3 crossover, shrinking normal mutation, elite \
                       of two"
                .into(),
            source: "Giergiel and Buratowski 2010, abstract; Eshelman and Schaffer 1993".into(),
            use_when: "optimisers are compared, or the cost has so many minima that descent from \
                       one start fails"
                .into(),
            avoid_when:
                "time or accuracy matters: after thousands of simulations its ISE is still higher \
                         than that of fuzzy_levenberg_marquardt after fifty"
                    .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let start = job.start(self.start)?;
        let theta = self.evolve(&job.problem, start.as_slice(), job.seed, &job.journal);
        Ok(Found { theta, iterations: self.generations, status: Status::IterationLimit })
    }
}

/// Genes (steps from the start, in units of the reach, within ±1) and their cost.
type Individual = (Vec<f64>, f64);

impl Genetic {
    fn evolve(&self, problem: &Problem, start: &[f64], seed: u64, journal: &Journal) -> Vec<f64> {
        let free = problem.reached();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let theta = |genes: &[f64]| {
            let mut theta = start.to_vec();
            for (&j, gene) in free.iter().zip(genes) {
                theta[j] += self.reach * gene;
            }
            theta
        };
        let judge = |children: Vec<Vec<f64>>| -> Vec<Individual> {
            let thetas: Vec<Vec<f64>> = children.iter().map(|genes| theta(genes)).collect();
            let costs = problem.costs(&thetas);
            let best = costs.iter().copied().fold(f64::INFINITY, f64::min);
            journal.note_many(costs.len(), best);
            children.into_iter().zip(costs).collect()
        };
        let first = (0..self.population).map(|i| {
            let spread = if i == 0 { 0.0 } else { 1.0 };
            free.iter().map(|_| spread * rng.random_range(-1.0..=1.0)).collect()
        });
        let mut population = judge(first.collect());
        for generation in 0..self.generations {
            population.sort_by(|a, b| a.1.total_cmp(&b.1));
            let left = 1.0 - generation as f64 / self.generations as f64;
            let size = 0.002 + 0.2 * left * left;
            let children = (ELITE..self.population)
                .map(|_| {
                    let (a, b) =
                        (tournament(&population, &mut rng), tournament(&population, &mut rng));
                    child(a, b, size, &mut rng)
                })
                .collect();
            let mut next = judge(children);
            next.extend(population.drain(..ELITE));
            population = next;
        }
        let best = population.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or_else(|| start.to_vec(), |best| theta(&best.0))
    }
}

fn tournament<'a>(population: &'a [Individual], rng: &mut ChaCha8Rng) -> &'a [f64] {
    // sorted by cost: the smallest of three places wins
    let place = (0..3).map(|_| rng.random_range(0..population.len())).min().unwrap_or(0);
    &population[place].0
}

fn child(a: &[f64], b: &[f64], size: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let chance = 1.0 / a.len().max(1) as f64;
    let gene = |(x, y): (&f64, &f64)| {
        let (low, high) = (x.min(*y), x.max(*y));
        let beyond = BEYOND * (high - low);
        let mut gene = low - beyond + (high - low + 2.0 * beyond) * rng.random::<f64>();
        if rng.random::<f64>() < chance {
            let normal: f64 = StandardNormal.sample(rng);
            gene += size * normal;
        }
        gene.clamp(-1.0, 1.0)
    };
    a.iter().zip(b).map(gene).collect()
}
