//! Residual analysis of the one-step prediction errors.

use super::{Section, words};
use crate::compare::Whiteness;
use crate::report::block::Block;
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{ModelStudy, Study};

/// Residual analysis.
#[derive(Default)]
pub struct Residuals;

impl Section for Residuals {
    fn id(&self) -> &'static str {
        "residuals"
    }

    fn title(&self) -> &'static str {
        "Residual analysis"
    }

    fn how_to_read(&self) -> &'static str {
        "If model and noise are correct, prediction errors are white and independent of the input: all but \
         one in a hundred of the correlations lie within the bounds, the histogram follows the normal density, \
         and the spectrum is flat."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let analysed = |m: &ModelStudy| m.whiteness.clone();
        let Some(given) = study.given.as_ref().and_then(analysed) else { return vec![] };
        let completed = study.completed.as_ref().and_then(analysed);
        vec![figure(study, &given, completed.as_ref()).into()]
    }
}

/// The largest correlation, of the errors with themselves or with the inputs.
fn largest(w: &Whiteness) -> f64 {
    let all = (0..2).flat_map(|i| w.auto[i][1..].iter().chain(&w.cross[i]));
    all.fold(0.0, |most: f64, r| most.max(r.abs()))
}

/// The widest of the 99 % bounds.
fn widest_bound(w: &Whiteness) -> f64 {
    w.auto_bound.iter().chain(&w.cross_bound).fold(0.0, |most: f64, b| most.max(*b))
}

/// Number of correlations outside their bounds, and of all.
fn outside(w: &Whiteness) -> (usize, usize) {
    let (mut count, mut all) = (0, 0);
    for i in 0..2 {
        let auto = w.auto[i][1..].iter().map(|r| r.abs() > w.auto_bound[i]);
        let cross = w.cross[i].iter().map(|r| r.abs() > w.cross_bound[i]);
        for is_outside in auto.chain(cross) {
            count += usize::from(is_outside);
            all += 1;
        }
    }
    (count, all)
}

fn title(study: &Study, given: &Whiteness, completed: Option<&Whiteness>) -> String {
    let bound = format::digits(widest_bound(completed.unwrap_or(given)), 2);
    let largest = |w: &Whiteness| format::digits(largest(w), 2);
    match completed {
        Some(completed) => format!(
            "The largest correlation of the prediction errors is {}, and {} with {} (99 % bound {bound})",
            largest(given),
            largest(completed),
            words::found(study)
        ),
        None => format!(
            "The largest correlation of the prediction errors is {} (99 % bound {bound})",
            largest(given)
        ),
    }
}

/// How many correlations are outside their bounds, and how the errors are computed.
fn caption(study: &Study, given: &Whiteness, completed: Option<&Whiteness>) -> String {
    let (last, all) = outside(completed.unwrap_or(given));
    let expected = (0.01 * all as f64).ceil();
    let (name, added) = (words::given(study), words::added(study));
    let outside_of = match completed {
        Some(_) => format!("{} ({name}) and {last} ({added}) are", outside(given).0),
        None if last == 1 => "one is".to_owned(),
        None => format!("{last} are"),
    };
    let of_last = if completed.is_some() { format!("{added}, ") } else { String::new() };
    format!(
        "Right wheel solid, left wheel dotted; shaded: 99 % bounds. With white errors {expected:.0} of {all} \
         correlations are expected outside; here {outside_of}. Errors over one sample show noise and sampling of the \
         input as correlation, which the noise floor of a simulation of 2 s contains: a model at its floor may \
         leave small ones. The noise of the filter is computed from the channels themselves, \
         so that it cannot absorb missing effects. Errors are divided by the standard deviation that \
         the filter predicts (RMS here: {of_last}{}).",
        rms(completed.unwrap_or(given))
    )
}

fn figure(study: &Study, given: &Whiteness, completed: Option<&Whiteness>) -> Figure {
    let predicted = if given.speeds { "wheel speeds" } else { "wheel angles" };
    let mut figure = Figure::new("residuals", title(study, given, completed))
        .with_subtitle(format!(
            "Prediction errors of the {predicted} by the Kalman filter over one sample, on {} data",
            study.judged_words()
        ))
        .with_caption(caption(study, given, completed))
        .with_columns(2)
        .interactive()
        .with_height(470.0);
    let models = match completed {
        Some(completed) => vec![
            (given, words::given(study), ColourRole::Given),
            (completed, words::added(study), ColourRole::Model),
        ],
        None => vec![(given, words::given(study), ColourRole::Model)],
    };
    figure.panels = vec![
        correlation(
            &models,
            "lag",
            "autocorrelation",
            |w, i| (1, &w.auto[i][1..]),
            |w| w.auto_bound,
        ),
        correlation(
            &models,
            "lag (error later than input)",
            "correlation with the input",
            |w, i| (-((w.cross[i].len() / 2) as i64), &w.cross[i]),
            |w| w.cross_bound,
        ),
        histogram(&models),
        spectrum(&models),
    ];
    figure
}

fn rms(w: &Whiteness) -> String {
    let [right, left] = w.mean_square.map(|m| format::digits(m.sqrt(), 2));
    format!("right {right}, left {left}")
}

type Models<'a> = [(&'a Whiteness, String, ColourRole)];

/// One curve a wheel and model.
fn lines(models: &Models<'_>, points: impl Fn(&Whiteness, usize) -> Vec<(f64, f64)>) -> Vec<Layer> {
    let mut out = Vec::new();
    for (w, name, role) in models {
        for i in 0..2 {
            let label = if i == 0 { name.clone() } else { String::new() };
            let dash = if i == 0 { Dash::Solid } else { Dash::Dotted };
            let (points, role) = (points(w, i), *role);
            out.push(Layer::Line { points, label, role, width: 1.4, dash });
        }
    }
    out
}

fn correlation(
    models: &Models<'_>,
    x: &str,
    y: &str,
    values: impl Fn(&Whiteness, usize) -> (i64, &[f64]),
    bound: impl Fn(&Whiteness) -> [f64; 2],
) -> Panel {
    let curves = lines(models, |w, i| {
        let (first, values) = values(w, i);
        let at = |n: usize| (first + n as i64) as f64 * w.step_s;
        values.iter().enumerate().map(|(n, v)| (at(n), *v)).collect()
    });
    let last = models[models.len() - 1].0;
    let (first, all) = values(last, 0);
    let ends = [first as f64, (first + all.len() as i64 - 1) as f64].map(|n| n * last.step_s);
    let half = bound(last).into_iter().fold(0.0, f64::max);
    let band = Layer::Band {
        x: ends.to_vec(),
        lower: vec![-half; 2],
        upper: vec![half; 2],
        label: "99 %".to_owned(),
        role: ColourRole::NoiseFloor,
    };
    let mut panel = Panel::new(Axis::linear(x, "s"), Axis::linear(y, "")).with(band);
    panel.layers.extend(curves);
    panel
}

fn histogram(models: &Models<'_>) -> Panel {
    let at = |n: usize, count: usize| 8.0 * (n as f64 + 0.5) / count as f64 - 4.0;
    let curves = lines(models, |w, i| {
        let count = w.density[i].len();
        w.density[i].iter().enumerate().map(|(n, v)| (at(n, count), *v)).collect()
    });
    let normal = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let points = (0..=80).map(|n| -4.0 + 0.1 * f64::from(n)).map(|x| (x, normal(x))).collect();
    let label = "normal density".to_owned();
    let (role, dash) = (ColourRole::NoiseFloor, Dash::Solid);
    let mut panel = Panel::new(
        Axis::linear("error over predicted std. deviation", ""),
        Axis::linear("density", ""),
    )
    .with(Layer::Line { points, label, role, width: 5.0, dash });
    panel.layers.extend(curves);
    panel
}

fn spectrum(models: &Models<'_>) -> Panel {
    let curves = lines(models, |w, i| {
        w.frequency_hz.iter().copied().zip(w.spectrum[i].iter().copied()).collect()
    });
    let x = Axis::linear("frequency", "Hz");
    let mut panel = Panel::new(x, Axis::log("spectrum over white noise", "")).with(Layer::hline(
        1.0,
        "white noise as assumed",
        ColourRole::NoiseFloor,
    ));
    panel.layers.extend(curves);
    panel
}
