//! All methods side by side.

use super::estimates::{figures as traces, truth};
use super::{Depth, Section, words};
use crate::diagnose::THRESHOLDS;
use crate::identify::Status;
use crate::math::rms;
use crate::report::block::{Block, Cell, Column, Table, Text, Tone};
use crate::report::figure::{Axis, BarSeries, Bars, ColourRole, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{MethodStudy, Performance, RecordingStudy, Role, Study};

/// The methods side by side: errors, estimates, status, notes.
#[derive(Default)]
pub struct Methods;

/// A method with an error within this factor of the lowest is mentioned with it.
const AS_GOOD: f64 = 1.01;
/// A method with an error above the lowest by more than this factor is reported as worse (judgement: as far as a model
/// may be from the noise floor).
const FAR: f64 = THRESHOLDS.above_floor;

impl Section for Methods {
    fn id(&self) -> &'static str {
        "methods"
    }

    fn title(&self) -> &'static str {
        "Methods"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "ISE is the integral of the squared errors of both wheel speeds, summed over the recordings; \
         with noisy inputs a free simulation drifts, so compare methods by their simulation error over 2 s at most, and \
         both with the noise floor."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        if study.methods.is_empty() {
            return vec![];
        }
        let mut blocks = vec![table(study).into()];
        blocks.extend(figure(study).map(Block::from));
        if study.of_paper {
            blocks.push(paper_index(study));
        }
        let remarks = remarks(study);
        if !remarks.is_empty() {
            blocks.push(Block::Heading("Notes on the methods".to_owned()));
            blocks.push(Block::List(remarks));
        }
        let other = study.methods.iter().filter(|m| m.estimates.is_empty());
        blocks.extend(other.flat_map(|m| traces(study, m)).map(Block::from));
        blocks
    }
}

/// The paper's index together with the contribution of noise.
fn paper_index(study: &Study) -> Block {
    Block::paragraph(format!(
        "The paper's quality index of 0.139 rad²/s is that of its emulator in the parallel structure, for \
         a run of unpublished length, noise and gain K: the index grows with the length and falls with K, \
         so it serves as an order of magnitude only. Here the noise of the measured speeds alone \
         contributes {} rad²/s on the evaluated recordings.",
        format::digits(sensor_noise(study), 3)
    ))
}

/// Sum over the recordings of a role; NaN where there is none or the method failed.
fn sum(study: &Study, role: Role, value: impl Fn(usize) -> Option<f64>) -> f64 {
    let of_role = |r: &usize| study.recordings[*r].role == role;
    let mut recordings = (0..study.recordings.len()).filter(of_role).peekable();
    if recordings.peek().is_none() {
        return f64::NAN;
    }
    recordings.map(|r| value(r).unwrap_or(f64::NAN)).sum()
}

fn judged_sum(study: &Study, method: &MethodStudy, value: fn(&Performance) -> f64) -> f64 {
    let one = |r: &usize| method.performance.get(*r).map_or(f64::NAN, value);
    if method.performance.is_empty() { f64::NAN } else { study.judged().iter().map(one).sum() }
}

/// Quality index due to the noise of the measured speeds alone, over the judged recordings [rad^2/s].
fn sensor_noise(study: &Study) -> f64 {
    let judged = study.judged().into_iter().map(|r| &study.recordings[r]);
    judged.map(RecordingStudy::ise_of_sensors).sum()
}

fn table(study: &Study) -> Table {
    let known = !study.truth.is_empty();
    let gain = format!("K = {} s⁻¹", format::number(study.emulator_gain));
    let mut columns = vec![
        Column::text("Method"),
        Column::text("Status"),
        Column::number(words::simulation_error(study), "rad/s"),
        Column::number("Over noise", "×"),
        Column::number("ISE train", "rad²/s"),
    ];
    if held_out(study) {
        columns.push(Column::number("ISE validation", "rad²/s"));
    }
    if study.emulated {
        columns.push(Column::number("Emulator, parallel", "rad²/s"));
        columns.push(Column::number("Emulator, serial-parallel", "rad²/s"));
    }
    columns.extend([Column::number("Time", "s"), Column::number("Evaluations", "")]);
    if known {
        columns.push(Column::number("Parameter error", "%"));
    }
    let error = if known {
        " Parameter error: root mean square over the free parameters, in percent of their true value."
    } else {
        ""
    };
    let emulators = if study.emulated {
        format!(" Emulators of eq. 19, {gain} on the wheel speeds: their ISE on the same data.")
    } else {
        String::new()
    };
    let on = if held_out(study) { "training and validation" } else { "training" };
    let drift = match study.recordings.iter().any(RecordingStudy::drifts) {
        true => {
            " Drift: noise of the input makes a free simulation of a correct model drift; its floor is the mean over many \
             such runs, and a single one may be far below."
        }
        false => "",
    };
    let caption = format!(
        "Methods. {} on {} data; ISE of the free simulation on {on} data.{drift}{emulators}{error}",
        words::simulation_error(study),
        study.judged_words()
    );
    let mut table = Table::new(caption, columns);
    for (index, method) in study.methods.iter().enumerate() {
        table.push(row(study, method, Some(index) == study.reference));
    }
    table.push(floor_row(study));
    table
}

fn row(study: &Study, method: &MethodStudy, is_reference: bool) -> Vec<Cell> {
    let name = Cell::text(words::method(study, method));
    let ended = Cell::text(words::status(method));
    let rms =
        if method.performance.is_empty() { f64::NAN } else { study.judged_window_rms(method) };
    let ratio = rms / study.judged_floor();
    let ise = |role| sum(study, role, |r| method.performance.get(r).map(|p| p.ise[0] + p.ise[1]));
    let mut row = vec![
        if is_reference { name.strong() } else { name },
        match method.status {
            _ if method.failure.is_some() => ended.tone(Tone::Bad),
            None | Some(Status::Converged) => ended,
            Some(Status::IterationLimit | Status::Stalled) => ended.tone(Tone::Notice),
        },
        digits(rms),
        digits(ratio),
        digits(ise(Role::Train)),
    ];
    if held_out(study) {
        row.push(digits(ise(Role::Validation)));
    }
    if study.emulated {
        row.push(digits(judged_sum(study, method, |p| p.ise_parallel)));
        row.push(digits(judged_sum(study, method, |p| p.ise_serial_parallel)));
    }
    row.push(Cell::formatted(format::significant(method.seconds, 2), method.seconds));
    row.push(Cell::count(method.work.evaluations));
    if !study.truth.is_empty() {
        row.push(digits(parameter_error(study, method)));
    }
    row
}

fn digits(value: f64) -> Cell {
    let text =
        if value == f64::INFINITY { "diverges".to_owned() } else { format::digits(value, 3) };
    Cell::formatted(text, value)
}

/// RMS relative error of the estimated parameters with known true values [%].
fn parameter_error(study: &Study, method: &MethodStudy) -> f64 {
    let known = method.estimates.iter().filter(|e| !e.fixed);
    let pairs = known.filter_map(|e| Some((e.value, truth(study, &e.symbol)?)));
    let errors =
        pairs.filter(|(_, truth)| *truth != 0.0).map(|(value, truth)| (value - truth) / truth);
    100.0 * rms(errors)
}

fn floor_row(study: &Study) -> Vec<Cell> {
    let ise = |role| {
        let value = sum(study, role, |r| Some(study.recordings[r].floor.ise.iter().sum()));
        let drifts = study.recordings.iter().any(|r| r.role == role && r.drifts());
        digits(value).noted(if drifts { "drift" } else { "" })
    };
    let mut row = vec![
        Cell::text("noise floor").strong(),
        Cell::text(""),
        digits(study.judged_floor()),
        digits(1.0),
        ise(Role::Train),
    ];
    if held_out(study) {
        row.push(ise(Role::Validation));
    }
    row
}

/// Whether there are validation recordings.
fn held_out(study: &Study) -> bool {
    study.recordings.iter().any(|r| r.role == Role::Validation)
}

/// States of a method that another one is better on the same recordings: its intervals do not show this.
fn worse(study: &Study, method: &MethodStudy) -> Option<String> {
    let error = |m: &MethodStudy| match m.performance.is_empty() {
        true => f64::NAN,
        false => study.judged_window_rms(m),
    };
    let physical = study.methods.iter().filter(|m| !m.estimates.is_empty());
    let finite = physical.filter(|m| error(m).is_finite());
    let best = finite.min_by(|a, b| error(a).total_cmp(&error(b)))?;
    let ratio = error(method) / error(best);
    let is_far = ratio.is_finite() && ratio > FAR && !method.estimates.is_empty();
    is_far.then(|| {
        let (times, best) = (format::significant(ratio, 2), words::method(study, best));
        format!(
            ": Its {} is {times} times that of {best} on the same recordings; prefer the estimates of {best}.",
            words::simulation_error(study)
        )
    })
}

/// Simulation error of every method, with the noise floor.
fn figure(study: &Study) -> Option<Figure> {
    let fitted: Vec<(&MethodStudy, f64)> = study
        .methods
        .iter()
        .filter(|m| !m.performance.is_empty())
        .map(|m| (m, study.judged_window_rms(m)))
        .collect();
    let finite = || fitted.iter().filter(|m| m.1.is_finite());
    let lowest = finite().map(|m| m.1).min_by(f64::total_cmp)?;
    let best: Vec<String> =
        finite().filter(|m| m.1 <= AS_GOOD * lowest).map(|m| words::method(study, m.0)).collect();
    if fitted.len() < 2 {
        return None;
    }
    let values: Vec<f64> = fitted.iter().map(|m| m.1).collect();
    let mut series = BarSeries::new("", ColourRole::Model, values.clone());
    series.text = values.iter().map(|v| format::digits(*v, 3)).collect();
    let bars = Bars {
        categories: fitted.iter().map(|m| words::method(study, m.0)).collect(),
        series: vec![series],
        highlight: None,
    };
    let title = format!(
        "Lowest {}: {}, {} times the noise floor",
        words::simulation_error(study),
        words::list(&best),
        format::digits(lowest / study.judged_floor(), 3)
    );
    let panel =
        Panel::new(Axis::linear(words::simulation_error(study), "rad/s"), Axis::unlabelled())
            .with(Layer::Bars(bars))
            .with(Layer::vline(study.judged_floor(), "noise floor", ColourRole::Ink));
    let figure = Figure::new("methods", title)
        .with_subtitle(format!("{}, on {} data", fitted_by(study), study.judged_words()))
        .with_caption("Root mean square error of both wheel speeds in these simulations.")
        .with_panel(panel);
    Some(figure)
}

/// States which fits these errors belong to: with a diagnosis, those of the verdict belong to other fits.
fn fitted_by(study: &Study) -> String {
    let model = format!("The {}, as each method fits it", words::fitted(study));
    match study.diagnosis {
        Some(_) => format!("{model} (the errors in the verdict are those of the diagnosis)"),
        None => model,
    }
}

fn remarks(study: &Study) -> Vec<Text> {
    // a note that several methods have is printed once
    let mut remarks: Vec<(String, Vec<String>)> = Vec::new();
    for method in &study.methods {
        let failure = method.failure.iter().map(|reason| format!(" failed: {reason}"));
        let notes = method.notes.iter().map(|note| format!(": {note}"));
        for note in failure.chain(notes).chain(worse(study, method)) {
            let name = words::method(study, method);
            match remarks.iter_mut().find(|(said, _)| *said == note) {
                Some((_, names)) => names.push(name),
                None => remarks.push((note, vec![name])),
            }
        }
    }
    let remark = |(note, names): (String, Vec<String>)| {
        Text::default().strong(words::list(&names)).plain(format::sentence(&note))
    };
    remarks.into_iter().map(remark).collect()
}
