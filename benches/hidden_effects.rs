//! Hidden-effect benchmark: recordings with a known missing effect, and whether it is named.
//!
//! ```text
//! cargo bench --bench hidden_effects -- [--seeds N] [--noise 1,2,3] [--healthy N] [--pairs N]
//!                                       [--only EFFECT] [--verbose]
//! ```
//! Every effect at three sizes (weak, moderate, strong) and the noise levels asked for, `--healthy`
//! sets with nothing hidden per noise level, and `--pairs` random pairs of moderate effects. One
//! set is four recordings of 25 s; effects that are the same by their equations count as one. The
//! recordings come from the event-driven simulator under a 1 kHz controller; the fit uses the
//! filter, which shares neither integrator nor step with it.
#![allow(clippy::print_stdout)]

use amigo_ident::diagnose::{Settings, diagnose};
use amigo_ident::identify::kalman::{Likelihood, prepare};
use amigo_ident::identify::{Task, start};
use amigo_ident::model::Model;
use amigo_ident::recording::Recording;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, record};
use rayon::prelude::*;

/// Hidden effects at moderate size: parameters that make an effect of some 5-10 % of the moment.
const HIDDEN: [(&str, &[(&str, f64)]); 21] = [
    ("viscous_friction", &[("b", 2e-3)]),
    ("viscous_friction_1", &[("b1", 2e-3)]),
    ("viscous_friction_2", &[("b2", 2e-3)]),
    ("torque_offset", &[("o1", 0.012), ("o2", 0.008)]),
    ("stribeck", &[("fs", 0.03), ("ws", 0.8)]),
    ("quadratic_drag", &[("c", 2e-4)]),
    ("slope", &[("g_c", 0.015), ("g_s", 0.01)]),
    ("turning_scrub", &[("f_t", 0.012)]),
    ("yaw_viscous", &[("d_y", 1.2e-3)]),
    ("caster_drag", &[("f_c", 0.012)]),
    ("lateral_com", &[("m", 4e-4)]),
    ("wheel_radius_mismatch", &[("eps", 0.03)]),
    ("actuator_lag", &[("tau", 0.02)]),
    ("actuator_delay", &[("delay", 0.02)]),
    ("torque_gain", &[("g", 0.05)]),
    ("torque_saturation", &[("limit", 0.3)]),
    ("backlash_deadzone", &[("d", 0.01)]),
    ("torque_ripple", &[("n", 6.0)]),
    ("wheel_eccentricity", &[]),
    ("friction_warmup", &[("fw", 0.03), ("tw", 8.0)]),
    ("load_transfer_friction", &[("cl", 1.5e-4)]),
];

struct Case {
    hidden: Vec<&'static str>,
    size: f64,
    level: usize,
    seed: u64,
}

fn noise(level: usize) -> NoiseLevel {
    match level {
        1 => NoiseLevel { alpha: 5e-4, dalpha: 0.02, moment: 0.002 },
        2 => NoiseLevel { alpha: 1e-3, dalpha: 0.05, moment: 0.005 },
        3 => NoiseLevel { alpha: 2e-3, dalpha: 0.15, moment: 0.015 },
        _ => NoiseLevel { alpha: 5e-3, dalpha: 0.40, moment: 0.05 },
    }
}

fn recordings(case: &Case) -> Vec<Recording> {
    let model = Model::with_effects(Robot::amigobot(), &case.hidden).expect("registered effects");
    let mut p = model.initial();
    for id in &case.hidden {
        let (_, values) = HIDDEN.iter().find(|(name, _)| name == id).expect("listed");
        for (j, parameter) in model.parameters().iter().enumerate() {
            if parameter.effect != *id {
                continue;
            }
            let symbol = parameter.spec.symbol.as_str();
            let value = values.iter().find(|(s, _)| *s == symbol).map(|v| v.1);
            let shape = matches!(symbol, "ws" | "tw" | "n" | "limit");
            let value = value.unwrap_or(parameter.spec.typical);
            p[j] = match symbol {
                "limit" => value * case.size.powf(-0.35),
                _ if shape => value,
                _ => value * case.size,
            };
        }
    }
    (0..4)
        .map(|r| {
            let movement = Movement::rich(model.robot(), case.seed * 10 + r, 25.0, 12.0);
            let recorder = Recorder {
                rate: 100.0,
                control_rate: 1000.0,
                noise: noise(case.level),
                ticks: None,
                seed: case.seed * 1000 + r,
            };
            record("made", &model, &p, &movement, &recorder).expect("the truth can move")
        })
        .collect()
}

fn argument(name: &str) -> Option<String> {
    let mut arguments = std::env::args();
    arguments.by_ref().find(|a| a == name)?;
    arguments.next()
}

fn main() {
    let seeds: u64 = argument("--seeds").and_then(|s| s.parse().ok()).unwrap_or(1);
    let levels: Vec<usize> = argument("--noise")
        .unwrap_or("2".into())
        .split(',')
        .filter_map(|s| s.parse().ok())
        .collect();
    let only = argument("--only");
    let count =
        |name: &str, default: u64| argument(name).and_then(|s| s.parse().ok()).unwrap_or(default);
    let sizes = [0.4, 1.0, 2.5];
    let mut cases = Vec::new();
    for &level in &levels {
        for seed in 0..seeds {
            for (id, _) in HIDDEN {
                for size in sizes {
                    cases.push(Case { hidden: vec![id], size, level, seed });
                }
            }
        }
        for k in 0..count("--healthy", 5) {
            cases.push(Case { hidden: vec![], size: 1.0, level, seed: 100 + k });
        }
        for k in 0..count("--pairs", 0) {
            // a fixed walk through all pairs, without neighbours in the list (often alike)
            let n = HIDDEN.len() as u64;
            let (a, b) = (k % n, (k * 5 + 7 + k / n) % n);
            if a == b {
                continue;
            }
            let hidden = vec![HIDDEN[a as usize].0, HIDDEN[b as usize].0];
            cases.push(Case { hidden, size: 1.0, level, seed: 500 + k });
        }
    }
    cases.retain(|c| only.as_deref().is_none_or(|o| c.hidden.join("+") == o));
    let rows: Vec<(String, bool)> = cases
        .par_iter()
        .map(|case| {
            let row = judge(case);
            if std::env::args().any(|a| a == "--verbose") {
                println!("{}", row.0);
            }
            row
        })
        .collect();
    println!("\nnot named right:");
    for (line, _) in rows.iter().filter(|r| !r.1) {
        println!("{line}");
    }
    println!("\n| hidden | noise | size | right | of |\n|---|---|---|---|---|");
    for &level in &levels {
        for (name, size, wanted) in [
            ("weak", 0.4, 1),
            ("moderate", 1.0, 1),
            ("strong", 2.5, 1),
            ("pair", 1.0, 2),
            ("nothing", 1.0, 0),
        ] {
            let of: Vec<bool> = cases
                .iter()
                .zip(&rows)
                .filter(|(c, _)| c.level == level && c.size == size && c.hidden.len() == wanted)
                .map(|(_, r)| r.1)
                .collect();
            if !of.is_empty() {
                let right = of.iter().filter(|r| **r).count();
                let kind = match wanted {
                    0 => "none",
                    1 => "one effect",
                    _ => "two effects",
                };
                println!("| {kind} | N{level} | {name} | {right} | {} |", of.len());
            }
        }
    }
}

fn judge(case: &Case) -> (String, bool) {
    let recordings = recordings(case);
    let model = Model::base(Robot::amigobot());
    let task = Task { model: &model, train: &recordings, hold: Hold::Linear, seed: 0 };
    let begin = std::time::Instant::now();
    let first = start::start(&task, "benchmark").expect("moving recordings");
    let likelihood = Likelihood {
        prepared: recordings.iter().map(prepare).collect(),
        hold: Hold::Linear,
        slow_moment: true,
        timing: false,
    };
    let d = diagnose(&model, &first, &likelihood, &Settings::default()).expect("a fit");
    let found = d.found();
    let wanted = case.hidden.iter().map(|s| (*s).to_string()).collect::<Vec<_>>();
    let same = |a: &str, b: &str| {
        let twins = amigo_ident::effects::find(a).map(|e| e.description().equivalent);
        a == b || twins.is_some_and(|t| t.iter().any(|t| t == b))
    };
    let right =
        found.len() == wanted.len() && wanted.iter().all(|w| found.iter().any(|f| same(f, w)));
    let top: Vec<String> = d
        .ranking
        .iter()
        .take(3)
        .map(|r| {
            format!(
                "{} E*{:.0} L{:.0} C{:.0}{}",
                r.candidate.id,
                r.evidence(),
                r.score.log_significance,
                r.score.cross_gain,
                if r.refit.as_ref().is_some_and(|x| !x.in_range) { " out" } else { "" }
            )
        })
        .collect();
    let line = format!(
        "{} {:<24} x{:<4} N{} seed {} -> {:<40} [{}] equals {:?} {:.1}s",
        if right { "ok " } else { "BAD" },
        case.hidden.join("+"),
        case.size,
        case.level,
        case.seed,
        found.join("+"),
        top.join(", "),
        d.equals.first().unwrap_or(&vec![]),
        begin.elapsed().as_secs_f64(),
    );
    (line, right)
}
