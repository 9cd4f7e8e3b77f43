//! The recordings, their noise, and the findings on them.

use super::{Depth, Section, listed, words};
use crate::diagnose::{Timing, Untimed};
use crate::identify::Note;
use crate::report::block::{Block, Cell, Column, Table, Text};
use crate::report::verdict::shifts_input;
use crate::report::{
    dead_time, dead_time_advice, dead_time_name, dead_time_with, format, no_dead_time,
};
use crate::study::{RecordingStudy, Study};

/// The recordings, with findings of conditioning and quality check.
#[derive(Default)]
pub struct Recordings;

impl Section for Recordings {
    fn id(&self) -> &'static str {
        "recordings"
    }

    fn title(&self) -> &'static str {
        "Recordings"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "Noise is the standard deviation of each channel, from differences between neighbouring \
         samples, right wheel / left wheel."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        if study.recordings.is_empty() {
            return vec![];
        }
        let columns = vec![
            Column::text("Recording"),
            Column::text("Use"),
            Column::number("Samples", ""),
            Column::number("Duration", "s"),
            Column::number("Rate", "Hz"),
            Column::number("Noise of angles", "rad"),
            Column::number("Noise of speeds", "rad/s"),
            Column::number("Noise of inputs", study.drive_unit.symbol()),
            Column::number("Noise floor, windows", "rad/s"),
            Column::number("Noise floor, quality index", "rad²/s"),
        ];
        let mut table = Table::new("The recordings of the experiment.", columns);
        let shown = listed::recordings(study);
        for &r in &shown {
            table.push(row(&study.recordings[r]));
        }
        let mut blocks: Vec<Block> =
            listed::left_out(study).into_iter().map(Block::paragraph).collect();
        blocks.push(table.into());
        blocks.extend(conditioning(study, &shown));
        blocks.extend(time_of_input(study).map(Block::paragraph));
        let groups = study.findings();
        let remarks = groups.len();
        let findings: Vec<Text> = groups
            .into_iter()
            .take(listed::MOST)
            .map(|(files, finding)| Text::default().strong(files).plain(format!(": {finding}")))
            .collect();
        if remarks == 0 {
            blocks.push(Block::paragraph("The check of the recordings found no issues."));
        } else {
            blocks.push(Block::Heading("Findings of the quality check".to_owned()));
            if findings.len() < remarks {
                let (here, all) = (findings.len(), remarks);
                let sentence = format!(
                    "The first {here} of {all} findings; results.json contains all of them."
                );
                blocks.push(Block::paragraph(sentence));
            }
            blocks.push(Block::List(findings));
        }
        blocks
    }
}

/// Faults of sensors and loggers found by conditioning; no table if there are none.
fn conditioning(study: &Study, shown: &[usize]) -> Option<Block> {
    let columns = vec![Column::text("Recording"), Column::text("Action"), Column::text("Finding")];
    let title = "Faults of sensors and loggers in the signals, and their correction.";
    let mut table = Table::new(title, columns);
    let mut any = false;
    for &r in shown {
        let recording = &study.recordings[r];
        for finding in &recording.conditioning {
            any = true;
            table.push(vec![
                Cell::text(&recording.file),
                Cell::text(finding.action.name()),
                Cell::text(finding.to_string()),
            ]);
        }
    }
    any.then(|| table.into())
}

fn row(r: &RecordingStudy) -> Vec<Cell> {
    let pair = |values: [f64; 2]| {
        let text = format::pair(values);
        Cell::formatted(text, values[0])
    };
    let measured = |is: bool, values| {
        if is { pair(values) } else { Cell::formatted("not measured", f64::NAN) }
    };
    let floor = r.floor.ise[0] + r.floor.ise[1];
    vec![
        Cell::text(&r.file),
        Cell::text(r.role.name()),
        Cell::count(r.samples),
        Cell::number(r.duration_s),
        Cell::number(r.rate_hz),
        measured(r.measured.alpha, r.noise.alpha),
        measured(r.measured.omega, r.noise.omega),
        pair(r.noise.torque),
        Cell::formatted(format::digits(r.floor.window_rms, 3), r.floor.window_rms),
        Cell::formatted(format::digits(floor, 3), floor).noted(if r.drifts() {
            "drift"
        } else {
            ""
        }),
    ]
}

/// The time between input and motion, or why it is not known; none if it was not estimated.
fn time_of_input(study: &Study) -> Option<String> {
    match &study.timing {
        Ok(timing) => Some(timed(study, timing)),
        Err(Untimed::NotSought) => None,
        Err(reason) => Some(match shift_found(study) {
            None => format!("Dead time: {}.", no_dead_time(reason)),
            Some(id) => format!(
                "Dead time by the model as given: {}; the diagnosis names {}.",
                no_dead_time(reason),
                words::effect_in_text(id)
            ),
        }),
    }
}

/// The time between input and motion, by the last model.
fn timed(study: &Study, timing: &Timing) -> String {
    let text = match &study.timing_as_given {
        Some(before) => dead_time_with(&words::found(study), timing, before.as_ref().ok()),
        None => dead_time(timing) + &decided(study, timing) + &by_filter(study, timing),
    };
    format!("{}: {text}.", dead_time_name(timing))
}

/// The same time by a method that estimates what is left of it in the corrected recordings.
fn by_filter(study: &Study, timing: &Timing) -> String {
    if timing.correction_s == 0.0 {
        return String::new();
    }
    let left = study.methods.iter().find_map(|method| {
        let left = method.notes.iter().find_map(|note| match *note {
            Note::InputShift(left, error) => Some((left, error)),
            _ => None,
        })?;
        Some((words::method(study, method), left))
    });
    left.map_or_else(String::new, |(method, (left, error))| {
        let all = format::fixed(1e3 * (timing.correction_s + left), 1);
        format!("; {method} finds {all} ± {} ms in all", format::fixed(1e3 * error, 1))
    })
}

/// The effect found that is a time of the input itself.
fn shift_found(study: &Study) -> Option<&String> {
    study.diagnosis.iter().flat_map(|d| &d.found).find(|id| shifts_input(id))
}

/// What became of a dead time that logging does not explain.
fn decided(study: &Study, timing: &Timing) -> String {
    match &study.diagnosis {
        _ if !timing.is_late() => String::new(),
        None => format!(": {}", dead_time_advice()),
        Some(_) => match shift_found(study) {
            Some(id) => format!("; the diagnosis names {}", words::effect_in_text(id)),
            None => {
                "; the diagnosis does not prove it, and its verdict is on the model without a delay"
                    .to_owned()
            }
        },
    }
}
