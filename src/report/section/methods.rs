//! Every method by one index on the same recordings.

use super::Section;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::format;
use crate::study::{MethodStudy, Performance, Role, Study};

/// The table of methods.
#[derive(Default)]
pub struct Methods;

impl Section for Methods {
    fn id(&self) -> &'static str {
        "methods"
    }
    fn title(&self) -> &'static str {
        "Methods compared"
    }
    fn how_to_read(&self) -> &'static str {
        "ISE is the paper's quality index, the integral of e_w1² + e_w2², summed over recordings; \
         free simulation, and the emulator of eq. (19) with the stated gain K on the wheel speeds."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let k = format::significant(study.emulator_gain, 3);
        vec![
            table(study, &k).into(),
            Block::paragraph(format!(
                "The paper's ISE of 0.139 rad²/s belongs to a run of unpublished length, noise and \
                 gain; here K = {k} 1/s. Sensor noise alone costs {} rad²/s on these recordings.",
                format::significant(sensor_noise(study), 3)
            )),
        ]
    }
}

/// ISE that sensor noise alone costs on all judged recordings.
fn sensor_noise(study: &Study) -> f64 {
    study
        .judged()
        .iter()
        .map(|&r| {
            let r = &study.recordings[r];
            (r.noise.omega[0].powi(2) + r.noise.omega[1].powi(2)) * r.duration_s
        })
        .sum()
}

fn table(study: &Study, k: &str) -> Table {
    let truth = !study.truth.is_empty();
    let mut columns = vec![
        Column::text("Method"),
        Column::text("Status"),
        Column::number("ISE train", "rad²/s"),
        Column::number("ISE validation", "rad²/s"),
        Column::number(format!("ISE parallel, K = {k}"), "rad²/s"),
        Column::number(format!("ISE serial-parallel, K = {k}"), "rad²/s"),
        Column::number("Window error", "rad/s"),
        Column::number("over noise floor", ""),
        Column::number("Time", "s"),
        Column::number("Passes", ""),
    ];
    if truth {
        columns.push(Column::number("Worst error of a1..a5", "%"));
    }
    let mut table = Table::new("All methods on the same recordings.", columns);
    for method in &study.methods {
        table.push(row(study, method, truth));
    }
    table
}

fn row(study: &Study, m: &MethodStudy, truth: bool) -> Vec<Cell> {
    let name = if m.options.is_empty() { m.name.clone() } else { format!("{} ({})", m.name, m.options) };
    if let Some(reason) = &m.failure {
        let mut row = vec![Cell::text(name), Cell::text(reason).tone(Tone::Bad)];
        row.resize(if truth { 11 } else { 10 }, Cell::text("–"));
        return row;
    }
    let sum = |role: Role, value: &dyn Fn(&Performance) -> f64| {
        let of: Vec<f64> = (0..study.recordings.len())
            .filter(|&r| study.recordings[r].role == role)
            .filter_map(|r| m.performance.get(r).map(value))
            .collect();
        if of.is_empty() { f64::NAN } else { of.iter().sum() }
    };
    let judged = |value: &dyn Fn(&Performance) -> f64| -> f64 {
        study.judged().iter().filter_map(|&r| m.performance.get(r).map(value)).sum()
    };
    let cell = |v: f64| match v {
        v if v.is_infinite() => Cell::formatted("diverges", f64::MAX),
        v => Cell::formatted(format::significant(v, 3), v),
    };
    let window = study.judged_window_rms(m);
    let mut row = vec![
        Cell::text(name),
        Cell::text(m.status.map_or(String::new(), |s| format!("{s:?}").to_lowercase())),
        cell(sum(Role::Train, &|p| p.ise[0] + p.ise[1])),
        cell(sum(Role::Validation, &|p| p.ise[0] + p.ise[1])),
        cell(judged(&|p| p.ise_parallel)),
        cell(judged(&|p| p.ise_serial_parallel)),
        cell(window),
        cell(window / study.judged_floor()),
        cell(m.seconds),
        Cell::count(m.work.evaluations),
    ];
    if truth {
        row.push(cell(worst_error(study, m)));
    }
    row
}

/// Largest relative error of a1..a5 [%].
fn worst_error(study: &Study, m: &MethodStudy) -> f64 {
    m.estimates
        .iter()
        .take(5)
        .filter_map(|e| {
            let truth = study.truth.iter().find(|(s, _)| *s == e.symbol)?.1;
            Some(100.0 * ((e.value - truth) / truth).abs())
        })
        .fold(f64::NAN, f64::max)
}
