//! Measured and simulated speeds of the models of the verdict, on the recording that is shown.

use super::curves::{self, broken_at_gaps, residual, simulated, wheel};
use super::words;
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel, Size};
use crate::report::format;
use crate::study::{ModelStudy, Performance, RecordingStudy, Study};

/// Duration of the excerpt on the first screen \[s\]: four simulations of 2 s.
const STRETCH: f64 = 8.0;

/// Figures over the time of the same recording zoom together.
pub(super) const LINK: &str = "time";

/// Curves of one recording.
pub(super) struct Overlay<'a> {
    study: &'a Study,
    recording: &'a RecordingStudy,
    given: &'a Performance,
    completed: Option<&'a Performance>,
}

impl<'a> Overlay<'a> {
    /// The recording shown in detail under the models of the verdict; `None` without a fit.
    pub(super) fn of(study: &'a Study) -> Option<Self> {
        let (index, recording) = curves::shown(study)?;
        let of = |model: &'a ModelStudy| model.performance.get(index);
        let given = of(study.given.as_ref()?)?;
        let completed = study.completed.as_ref().and_then(of);
        (recording.t.len() > 1).then_some(Self { study, recording, given, completed })
    }

    /// The models with their names and styles, the last on top.
    fn models(&self) -> Vec<(&'a Performance, String, ColourRole, Dash)> {
        let given = words::given(self.study);
        match self.completed {
            None => vec![(self.given, given, ColourRole::Model, Dash::Solid)],
            Some(completed) => {
                let added = words::added(self.study);
                vec![
                    (self.given, given, ColourRole::Given, Dash::Dashed),
                    (completed, added, ColourRole::Model, Dash::Solid),
                ]
            }
        }
    }

    /// The first screen: both speeds in the interval with the largest error of the model as given.
    pub(super) fn stretch(&self) -> Figure {
        let (first, last) = self.worst();
        let title = match self.completed {
            Some(_) => {
                format!("Measured and simulated, without and {}", words::added(self.study))
            }
            None => "Measured and simulated".to_owned(),
        };
        let whole = last - first < STRETCH - 1e-6 || self.recording.duration_s <= STRETCH;
        let of_given = if self.completed.is_some() { " of the model as given" } else { "" };
        let place = match whole {
            true => String::new(),
            false => format!(", the {STRETCH:.0} s with the largest error{of_given}"),
        };
        let figure = Figure::new("overlay", title)
            .with_subtitle(format!("{} ({}){place}", self.recording.file, self.used()))
            .with_caption(format!(
                "Wheel speeds ω₁ (right) and ω₂ (left). Simulations start anew from the measured motion every 2 s, or once where it is shorter; \
                 the legend gives their RMS error over the whole recording{}.",
                self.among()
            ));
        let figure = (0..2).fold(figure, |figure, i| {
            let y = Axis::linear(words::OMEGA[i], "rad/s");
            figure.with_panel(self.speeds(y, i, (first, last), |p| &p.windows, with_error))
        });
        figure.linked(LINK).with_height(340.0)
    }

    /// The wheel with the larger error, without text, in the size of a table cell.
    pub(super) fn thumbnail(&self) -> Figure {
        let rows = || self.given.windows.iter().zip(&self.recording.omega);
        let square = |i: usize| rows().map(|(s, m)| (m[i] - s[i]).powi(2)).sum::<f64>();
        let mut figure = self.stretch();
        figure.panels.swap_remove(usize::from(square(0) > square(1)));
        (figure.title, figure.subtitle) = (String::new(), String::new());
        figure.panels.iter_mut().flat_map(|p| &mut p.layers).for_each(Layer::unlabel);
        figure.size = Size { width: 240.0, height: Some(130.0) };
        figure
    }

    /// Relation of its errors to those of the verdict, if it is one of several recordings.
    fn among(&self) -> String {
        match self.study.judged().len() {
            ..2 => String::new(),
            many => format!("; the verdict gives the RMS error over all {many} recordings"),
        }
    }

    fn used(&self) -> &'static str {
        match self.recording.role {
            crate::study::Role::Validation => "held out from the fit",
            crate::study::Role::Train => "training: no recording is held out",
        }
    }

    /// The whole recording: both speeds and their residuals, for simulations of 2 s and the free simulation.
    pub(super) fn whole(&self) -> Figure {
        let floor = format::digits(self.recording.floor.window_rms, 3);
        let error = |p: &Performance| format::digits(p.window_rms, 3);
        // the errors of the verdict are those of all judged recordings
        let here = if self.study.judged().len() > 1 { "On this recording the" } else { "The" };
        let named = words::simulation_error(self.study);
        let title = match self.completed {
            Some(completed) => format!(
                "{here} {named} falls from {} to {} rad/s; the noise floor is {floor}",
                error(self.given),
                error(completed),
            ),
            None => {
                format!("{here} {named} is {} rad/s; the noise floor is {floor}", error(self.given))
            }
        };
        let mut figure = Figure::new("fit", title)
            .with_subtitle(format!(
                "{}, {} s at {} Hz",
                self.recording.file,
                format::significant(self.recording.duration_s, 3),
                format::significant(self.recording.rate_hz, 3)
            ))
            .with_caption(
                "For each wheel: measurement and free simulation, and the residual (measured minus \
                 simulated) of the 2 s simulations.",
            )
            .linked(LINK)
            .with_height(590.0);
        let ends = (self.recording.t[0], self.recording.t[self.recording.t.len() - 1]);
        for i in 0..2 {
            let y = Axis::linear(words::OMEGA[i], "rad/s");
            let speeds = self.speeds(y, i, ends, |p| &p.free, |name, _| format!("{name}, free"));
            figure = figure.with_panel(speeds).with_panel(self.residuals(i));
        }
        figure
    }

    fn speeds(
        &self,
        y: Axis,
        i: usize,
        range: (f64, f64),
        of: impl Fn(&Performance) -> &[[f64; 2]],
        label: impl Fn(&str, &Performance) -> String,
    ) -> Panel {
        let x = Axis::linear("time", "s").with_range(range.0, range.1);
        let measured = wheel(&self.recording.t, &self.recording.omega, i);
        let inside = |p: &&(f64, f64)| (range.0..=range.1).contains(&p.0);
        let mut shown: Vec<(f64, f64)> = measured.iter().filter(inside).copied().collect();
        // a wide pale line: dots would hide the curves below them
        let mut panel = Panel::new(x, y).with(Layer::Line {
            points: broken_at_gaps(measured),
            label: "measured".to_owned(),
            role: ColourRole::Measured,
            width: 3.2,
            dash: Dash::Solid,
        });
        for (performance, name, role, dash) in self.models() {
            let (rows, label) = (of(performance), label(&name, performance));
            let points = self.broken(simulated(self.recording, rows, i), performance, rows);
            let points = broken_at_gaps(points);
            shown.extend(points.iter().filter(inside));
            let width = if role == ColourRole::Given { 1.6 } else { 1.4 };
            panel = panel.with(Layer::Line { points, label, role, width, dash });
        }
        panel.y.range = spread(&shown);
        if i > 0 {
            panel.layers.iter_mut().for_each(Layer::unlabel);
        }
        panel
    }

    fn residuals(&self, i: usize) -> Panel {
        let label = format!("residual {}", words::OMEGA[i]);
        let mut panel = Panel::new(Axis::linear("time", "s"), Axis::linear(label, "rad/s"))
            .with(curves::noise_band(self.recording, i));
        for (performance, name, role, _) in self.models() {
            let label = with_error(&name, performance);
            let points = residual(self.recording, &performance.windows, i);
            let points = broken_at_gaps(self.broken(points, performance, &performance.windows));
            let width = if role == ColourRole::Given { 0.9 } else { 1.1 };
            panel = panel.with(Layer::Line { points, label, role, width, dash: Dash::Solid });
        }
        if i > 0 {
            panel.layers.iter_mut().for_each(Layer::unlabel);
        }
        panel
    }

    /// A curve without the jumps where the 2 s simulations restart.
    fn broken(
        &self,
        points: Vec<(f64, f64)>,
        performance: &Performance,
        rows: &[[f64; 2]],
    ) -> Vec<(f64, f64)> {
        if !std::ptr::eq(rows, performance.windows.as_slice()) {
            return points;
        }
        let mut out = Vec::with_capacity(points.len() + performance.window_starts.len());
        let mut starts = performance.window_starts.iter().peekable();
        for (k, point) in points.into_iter().enumerate() {
            if starts.next_if(|start| **start == k).is_some() && k > 0 {
                out.push((point.0, f64::NAN));
            }
            out.push(point);
        }
        out
    }

    /// The four consecutive 2 s simulations with the largest error of the model as given.
    fn worst(&self) -> (f64, f64) {
        let t = &self.recording.t;
        let last = t.len() - 1;
        let rows = self.given.windows.iter().zip(&self.recording.omega);
        let mut sums = vec![0.0];
        for (s, m) in rows {
            let square = (m[0] - s[0]).powi(2) + (m[1] - s[1]).powi(2);
            sums.push(sums[sums.len() - 1] + if square.is_finite() { square } else { 0.0 });
        }
        let whole = (t[0], t[last]);
        let end_of = |k: usize| t.partition_point(|now| *now <= t[k] + STRETCH);
        let starts = self.given.window_starts.iter().copied();
        let full = starts.filter(|&k| k <= last && t[k] + STRETCH <= t[last] + 1e-9);
        let square = |k: usize| sums[end_of(k).min(sums.len() - 1)] - sums[k.min(sums.len() - 1)];
        let worst = full.max_by(|&a, &b| square(a).total_cmp(&square(b)));
        worst.map_or((whole.0, whole.1.min(whole.0 + STRETCH)), |k| (t[k], t[k] + STRETCH))
    }
}

/// The y range of points, with a margin.
fn spread(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let y = || points.iter().map(|p| p.1).filter(|y| y.is_finite());
    let (low, high) = (y().fold(f64::INFINITY, f64::min), y().fold(f64::NEG_INFINITY, f64::max));
    let room = 0.06 * (high - low);
    (high > low).then_some((low - room, high + room))
}

/// A legend with the RMS error of the 2 s simulations.
fn with_error(name: &str, performance: &Performance) -> String {
    format!("{name}: {} rad/s", format::digits(performance.window_rms, 3))
}
