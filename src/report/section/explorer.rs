//! Explorer of the recordings: speeds, input and residual torque synchronised with the position of the robot.

use super::curves::{self, broken_at_gaps, simulated, wheel};
use super::{Depth, Section, listed, what_if, words};
use crate::report::block::{Block, Track};
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{ModelStudy, Performance, RecordingStudy, Study};

/// Measured and simulated motion of each recording, to scroll and zoom.
#[derive(Default)]
pub struct Explorer;

/// Largest number of samples of all recordings together, and of one: keeps the page below 3 MB.
const SAMPLES: (usize, usize) = (4000, 1000);
/// Largest number of recordings that can be selected.
const CHOICES: usize = 40;

impl Section for Explorer {
    fn id(&self) -> &'static str {
        "explorer"
    }

    fn title(&self) -> &'static str {
        "Recording explorer"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "The path shows what the robot was doing where the residual torque is large: the cursor on the curves moves the \
         robot, and the slider moves both."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let shown = shown(study);
        let each = (SAMPLES.0 / shown.len().max(1)).min(SAMPLES.1);
        let tracks: Vec<Track> = shown.iter().map(|&r| track(study, r, each)).collect();
        if tracks.is_empty() {
            return vec![];
        }
        let mut blocks = Vec::new();
        if shown.len() < study.recordings.len() {
            let (here, all) = (shown.len(), study.recordings.len());
            blocks.push(Block::paragraph(format!("{here} of {all} recordings can be chosen.")));
        }
        blocks.push(Block::Explorer(tracks));
        blocks.extend(what_if::blocks(study, &shown));
        blocks
    }
}

/// The recordings that can be selected: that of the other figures first, then those on which errors are
/// judged.
fn shown(study: &Study) -> Vec<usize> {
    let mut shown = listed::recordings(study);
    shown.retain(|&r| study.recordings[r].t.len() > 1);
    shown.truncate(CHOICES);
    let (judged, first) = (study.judged(), curves::shown(study).map(|(r, _)| r));
    shown.sort_by_key(|r| (Some(*r) != first, !judged.contains(r)));
    shown
}

fn track(study: &Study, index: usize, most: usize) -> Track {
    let recording = &study.recordings[index];
    let stride = recording.t.len().div_ceil(most).max(1);
    let seen = Seen { study, index, recording, stride };
    let mut figure = Figure::new("explorer", "").linked("explorer");
    figure.panels.extend((0..2).map(|i| seen.speeds(i)));
    figure.panels.push(seen.input());
    figure.panels.extend((0..2).map(|i| seen.residual_torque(i)));
    let place = |(t, at): (&f64, &[f64; 3])| [*t, at[0], at[1], at[2]];
    let path = recording.t.iter().zip(&recording.path).step_by(stride).map(place).collect();
    Track { name: seen.name(), note: seen.errors(), figure, path }
}

/// One recording with the models of the verdict, at a reduced number of samples.
struct Seen<'a> {
    study: &'a Study,
    index: usize,
    recording: &'a RecordingStudy,
    stride: usize,
}

impl<'a> Seen<'a> {
    /// The models with their names and roles.
    fn models(&self) -> Vec<(&'a ModelStudy, String, ColourRole)> {
        match (&self.study.given, &self.study.completed) {
            (Some(given), Some(completed)) => vec![
                (given, words::given(self.study), ColourRole::Given),
                (completed, words::added(self.study), ColourRole::Model),
            ],
            (Some(given), None) => vec![(given, words::given(self.study), ColourRole::Model)],
            (None, _) => vec![],
        }
    }

    /// "floor_1.csv (validation)": short enough for a list on a phone.
    fn name(&self) -> String {
        format!("{} ({})", self.recording.file, self.recording.role.name())
    }

    /// "2 s simulation error: base model 0.38, with turning scrub 0.052 rad/s"; empty where there is none.
    fn errors(&self) -> String {
        let error = |m: &ModelStudy| m.performance.get(self.index).map(|p| p.window_rms);
        let errors: Vec<String> = self
            .models()
            .iter()
            .filter_map(|(model, name, _)| {
                Some(format!("{name} {}", format::digits(error(model)?, 3)))
            })
            .collect();
        if errors.is_empty() {
            return String::new();
        }
        format!("{}: {} rad/s", words::simulation_error(self.study), errors.join(", "))
    }

    fn speeds(&self, i: usize) -> Panel {
        let measured = wheel(&self.recording.t, &self.recording.omega, i);
        let mut layers =
            vec![line(self.thin(measured), "measured".to_owned(), ColourRole::Measured, 2.6)];
        for (model, name, role) in self.models() {
            let Some(p) = model.performance.get(self.index) else { continue };
            let points = self.broken(simulated(self.recording, &p.windows, i), p);
            layers.push(line(points, format!("{name}, 2 s"), role, 1.3));
        }
        self.panel(words::OMEGA[i], "rad/s", layers, i == 0)
    }

    fn input(&self) -> Panel {
        let roles = [ColourRole::Wheel1, ColourRole::Wheel2];
        let of = |i: usize| {
            let points = self.thin(wheel(&self.recording.t, &self.recording.torque, i));
            line(points, format!("{} {}", words::INPUT[i], words::WHEELS[i]), roles[i], 1.2)
        };
        self.panel("input", self.study.drive_unit.symbol(), vec![of(0), of(1)], true)
    }

    fn residual_torque(&self, i: usize) -> Panel {
        let mut layers = Vec::new();
        for (model, name, role) in self.models() {
            let Some(torque) = model.residual_torque.get(self.index) else { continue };
            let points = self.thin(wheel(&self.recording.t, torque, i));
            layers.push(line(points, name, role, 1.3));
        }
        let label = format!("residual torque, {}", words::WHEELS[i]);
        self.panel(&label, self.study.drive_unit.symbol(), layers, i == 0)
    }

    /// A panel over time; only the first of its kind has its layers in the legend.
    fn panel(&self, label: &str, unit: &str, layers: Vec<Layer>, is_first: bool) -> Panel {
        let ends = (self.recording.t[0], self.recording.t[self.recording.t.len() - 1]);
        let time = Axis::linear("time", "s").with_range(ends.0, ends.1);
        let mut panel = Panel::new(time, Axis::linear(label, unit));
        panel.layers = layers;
        if !is_first {
            panel.layers.iter_mut().for_each(Layer::unlabel);
        }
        panel
    }

    fn thin(&self, points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
        points.into_iter().step_by(self.stride).collect()
    }

    /// A reduced number of points, without the jumps where the 2 s simulations restart.
    fn broken(&self, mut points: Vec<(f64, f64)>, performance: &Performance) -> Vec<(f64, f64)> {
        for start in performance.window_starts.iter().filter(|start| **start > 0) {
            let last_kept = (start - 1) / self.stride * self.stride;
            if let Some(point) = points.get_mut(last_kept) {
                point.1 = f64::NAN;
            }
        }
        self.thin(points)
    }
}

fn line(points: Vec<(f64, f64)>, label: String, role: ColourRole, width: f64) -> Layer {
    let points = broken_at_gaps(points);
    Layer::Line { points, label, role, width, dash: Dash::Solid }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::section::tests::full;

    #[test]
    fn every_recording_can_be_chosen_with_the_same_panels_and_layers() {
        let study = full();
        let blocks = Explorer.blocks(&study);
        let Some(Block::Explorer(tracks)) = blocks.last() else { panic!("{blocks:?}") };
        assert_eq!(tracks.len(), study.recordings.len());
        let kinds = |track: &Track| -> Vec<usize> {
            track.figure.panels.iter().map(|panel| panel.layers.len()).collect()
        };
        assert!(tracks.iter().all(|track| kinds(track) == kinds(&tracks[0])));
        assert!(tracks[0].note.contains("rad/s"), "{}", tracks[0].note);
        assert!(!tracks[0].name.contains("rad/s"), "{}", tracks[0].name);
    }

    #[test]
    fn many_recordings_share_the_samples() {
        let mut study = full();
        let one = study.recordings[0].clone();
        study.recordings = vec![one; 50];
        let blocks = Explorer.blocks(&study);
        let Some(Block::Explorer(tracks)) = blocks.last() else { panic!("{blocks:?}") };
        assert_eq!(tracks.len(), CHOICES);
        assert!(tracks.iter().all(|track| track.path.len() <= SAMPLES.0 / CHOICES + 1));
    }
}
