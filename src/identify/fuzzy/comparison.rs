//! Long comparisons of the fuzzy methods, with the figures they gave.
//!
//! All on the paper's movement (22 s, 100 Hz) at noise level N2 (0.05 rad/s, 1e-3 rad, 5e-3 N m),
//! noise floor 2 T sigma² = 0.110 rad²/s; times on two cores. `repeat` is the same movement with
//! other noise, `other` a rich movement of 25 s up to 12 rad/s, both with the same K and structure.
//! Run with `cargo test --release --lib fuzzy::comparison -- --ignored --nocapture`.

use std::time::Instant;

use super::tests::{ise, made, run};
use crate::robot::Robot;
use crate::simulate::{Movement, Structure};

/// ISE of the training recording in one line of a table.
#[allow(clippy::print_stdout)]
fn line(name: &str, options: &str, gain: f64, seed: u64) -> f64 {
    let train = [made(&Movement::paper(), seed)];
    let repeat = made(&Movement::paper(), seed + 100);
    let other = made(&Movement::rich(&Robot::amigobot(), 3, 25.0, 12.0), 3);
    let start = Instant::now();
    let fit = run(name, &format!("gain = {gain:?}\n{options}"), &train, 1);
    let seconds = start.elapsed().as_secs_f64();
    let structure = fit.dynamics.fuzzy().map_or(Structure::Parallel, |f| f.structure);
    let at = |recording| ise(&fit, recording, gain, structure);
    let reached = at(&train[0]);
    println!(
        "{name} {} K={gain}: ISE {reached:.4} repeat {:.4} other {:.1}, {} evaluations, \
         {seconds:.2} s",
        options.replace('\n', ", "),
        at(&repeat),
        at(&other),
        fit.work.evaluations,
    );
    reached
}

/// Constant consequents, range of the data, default options, seed 1; ISE (repeat) [rad²/s]:
///
/// | method | K = 0 | K = 1 | K = 2 | evaluations, s at K = 1 |
/// |---|---|---|---|---|
/// | fuzzy_least_squares | 0.277 (1.4) | 0.213 (0.283) | 0.191 (0.214) | 1, 0.01 |
/// | fuzzy_levenberg_marquardt | 0.113 (0.130) | 0.1105 (0.121) | 0.109 (0.118) | 22, 0.13 |
/// | same without continuation | 0.137 (20.8) | 0.112 (0.122) | 0.110 (0.118) | 24, 0.18 |
/// | fuzzy_gradient | 0.144 (6.2) | 0.1125 (0.129) | 0.110 (0.118) | 957, 3.0 |
/// | fuzzy_line_search, 6 sweeps | 1.10 (3.0) | 0.130 (0.140) | 0.125 (0.131) | 3052, 3.9 |
/// | fuzzy_nelder_mead | 0.160 (2.1) | 0.128 (0.141) | 0.121 (0.128) | 4820, 6.3 |
/// | fuzzy_genetic | 2.05 (3.2) | 0.148 (0.151) | 0.132 (0.137) | 3840, 3.1 |
/// | fuzzy_anfis | 0.109 (0.127) | 0.108 (0.117) | 0.107 (0.115) | 202, 1.4 |
///
/// fuzzy_least_squares in its serial-parallel structure, all others in the parallel one.
/// On the other movement every one of them fails (ISE 6 to 1000 at K = 1): rules know only the
/// speeds they were shown.
#[test]
#[ignore = "a measurement, about a minute"]
fn levenberg_marquardt_reaches_the_lowest_ise_with_the_fewest_evaluations() {
    for gain in [0.0, 1.0, 2.0] {
        let best = line("fuzzy_levenberg_marquardt", "", gain, 1);
        assert!(best < 1.1 * 0.11, "{best}");
        line("fuzzy_least_squares", "", gain, 1);
        line("fuzzy_levenberg_marquardt", "continuation = false", gain, 1);
        line("fuzzy_anfis", "", gain, 1);
        for name in ["gradient", "line_search", "nelder_mead", "genetic"] {
            let ise = line(&format!("fuzzy_{name}"), "", gain, 1);
            assert!(ise > best, "{name} {ise} {best}");
        }
    }
}

/// fuzzy_levenberg_marquardt with other systems, seed 1; ISE (repeat) [rad²/s]:
///
/// | system | K = 0 | K = 1 | K = 2 | K = 10 |
/// |---|---|---|---|---|
/// | constant, data | 0.113 (0.130) | 0.1105 (0.121) | 0.109 (0.118) | 0.102 (0.108) |
/// | constant, [0, 30] | 11 (190) | 0.92 (21) | 0.64 (0.69) | 0.207 (0.214) |
/// | affine, [0, 30] | 0.44 (230) | 0.162 (0.195) | 0.132 (0.166) | 0.109 (0.120) |
/// | affine, data | 0.109 (0.131) | 0.108 (0.123) | 0.106 (0.123) | 0.099 (0.108) |
/// | weighted sum, data | 0.113 (0.134) | 0.111 (0.121) | 0.109 (0.118) | 0.102 (0.109) |
/// | 9 functions (81 rules), data | 0.110 (18) | 0.108 (0.118) | 0.107 (0.116) | 0.100 (0.108) |
/// | serial-parallel, data | 0.277 (1.4) | 0.213 (0.283) | 0.191 (0.214) | 0.127 (0.136) |
/// | fuzzy_anfis, [0, 30] | 2.4 (14) | 0.92 (21) | 0.64 (0.69) | 0.110 (0.115) |
///
/// The paper's 0.139 lies between the constant rules on [0, 30] and those on the range of the
/// data, but it depends on K, on the noise and on the length of the run, none of which is given.
#[test]
#[ignore = "a measurement, some seconds"]
fn rules_over_the_range_of_the_data_beat_those_over_the_papers_range() {
    let name = "fuzzy_levenberg_marquardt";
    for gain in [0.0, 1.0, 2.0, 10.0] {
        let data = line(name, "", gain, 1);
        let paper = line(name, "range = \"paper\"", gain, 1);
        assert!(data < paper, "{data} {paper}");
        line(name, "range = \"paper\"\nconsequents = \"affine\"", gain, 1);
        line(name, "consequents = \"affine\"", gain, 1);
        line(name, "defuzzification = \"weighted_sum\"", gain, 1);
        line(name, "memberships = 9", gain, 1);
        line(name, "structure = \"serial_parallel\"", gain, 1);
        line("fuzzy_anfis", "range = \"paper\"", gain, 1);
    }
}

/// Six recordings, K = 1: ISE 0.107 to 0.116 (0.98 to 1.05 times the floor), repeats 0.113 to
/// 0.121. With the range of the data not widened it was 0.121 to 0.146 and one repeat of 4.4; with
/// a ridge of 1e-6 one repeat of 2.2. At K = 0: 0.110 to 0.173, and two of six repeats run away (35
/// and 207): rules have no stiction, so pure simulation does not hold at rest.
#[test]
#[ignore = "a measurement, some seconds"]
fn the_noise_floor_is_reached_on_every_recording() {
    for seed in 1..7 {
        let reached = line("fuzzy_levenberg_marquardt", "", 1.0, seed);
        assert!(reached < 1.1 * 0.11, "{reached}");
        line("fuzzy_levenberg_marquardt", "", 0.0, seed);
    }
}
