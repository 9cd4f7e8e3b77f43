//! Sections on full and almost empty studies.

use std::collections::HashSet;

use super::all;
use crate::compare::{
    Curve, CurveBin, Failure, Floor, Horizon, Innovations, Mean, Variable, Whiteness, analysed,
};
use crate::identify::{Estimate, Status, Trace, Work};
use crate::recording::{DriveUnit, Measured, Noise, Regime};
use crate::report::block::Block;
use crate::report::render;
use crate::study::{
    Candidate, DiagnosisStudy, FoundEffect, FuzzyStudy, Invocation, MethodStudy, ModelStudy,
    ParameterStudy, Performance, RecordingStudy, Role, Step, Study, Verdict, Version,
};

/// Samples of a made recording.
const SAMPLES: usize = 400;

fn recording(role: Role) -> RecordingStudy {
    let t: Vec<f64> = (0..SAMPLES).map(|k| 0.01 * k as f64).collect();
    let omega: Vec<[f64; 2]> = t.iter().map(|t| [4.0 * t.sin(), 3.0 * t.cos()]).collect();
    let regime = |k: usize| if k < 200 { Regime::PivotLeft } else { Regime::StraightSteady };
    RecordingStudy {
        role,
        file: format!("{}<1>.csv", role.name()),
        sha256: Some("ab".repeat(32)),
        samples: SAMPLES,
        duration_s: 3.99,
        rate_hz: 100.0,
        measured: Measured { alpha: true, omega: true },
        noise: Noise { alpha: [1e-3; 2], omega: [0.05; 2], moment: [0.005; 2] },
        conditioning: vec![],
        findings: vec!["a gap of 0.2 s at 1.0 s".to_owned()],
        floor: Floor { ise: [0.01; 2], window_rms: 0.05 },
        alpha: t.iter().map(|t| [4.0 - 4.0 * t.cos(), 3.0 * t.sin()]).collect(),
        acceleration: t.iter().map(|t| [4.0 * t.cos(), -3.0 * t.sin()]).collect(),
        moment: omega.iter().map(|w| [0.1 * w[0], 0.1 * w[1]]).collect(),
        regimes: (0..SAMPLES).map(regime).collect(),
        path: t.iter().map(|t| [0.1 * t, 0.05 * t.sin(), 0.2 * t]).collect(),
        omega,
        t,
    }
}

fn performance(r: &RecordingStudy, error: f64) -> Performance {
    let off = |w: &[f64; 2]| [w[0] + error, w[1] - error];
    let state = |(a, w): (&[f64; 2], &[f64; 2])| [a[0], a[1], w[0] + error, w[1]];
    Performance {
        angle_rms: 0.01,
        ise: [error; 2],
        window_rms: error.abs(),
        ise_parallel: error,
        ise_serial_parallel: f64::INFINITY,
        free: r.omega.iter().map(off).collect(),
        windows: r.omega.iter().map(off).collect(),
        window_starts: vec![0, SAMPLES / 2],
        window_states: vec![[0.0; 4]; 2],
        emulator: r.alpha.iter().zip(&r.omega).map(state).collect(),
    }
}

fn method(name: &str) -> MethodStudy {
    MethodStudy {
        name: name.to_owned(),
        title: format!("The method {name}"),
        options: String::new(),
        failure: None,
        status: Some(Status::Converged),
        seconds: 0.1,
        work: Work { iterations: 3, evaluations: 12 },
        estimates: vec![],
        correlations: vec![],
        notes: vec![],
        traces: vec![],
        performance: vec![],
        fuzzy: None,
    }
}

fn empty() -> Study {
    Study {
        timing: None,
        experiment: "bare".to_owned(),
        invocation: Invocation { file: "runs/bare.toml".to_owned(), ..Invocation::default() },
        title: "Bare".to_owned(),
        version: "0".to_owned(),
        seed: 1,
        file: String::new(),
        robot: "robot".to_owned(),
        effects: vec![],
        drive_unit: DriveUnit::Volt,
        recordings: vec![],
        methods: vec![],
        reference: None,
        emulator_gain: 0.0,
        given: None,
        completed: None,
        curves: vec![],
        emulated: false,
        of_paper: false,
        diagnosis: None,
        versions: vec![],
        truth: vec![],
        model_out: None,
        what_if: None,
    }
}

fn curve(variable: Variable, share: f64) -> Curve {
    let mean = |value: f64| Mean { value, std_error: 0.001, blocks: 9 };
    let bin = |k: usize| CurveBin {
        at: k as f64,
        joined: k != 0 && k != 6,
        before: [mean(0.02 * (k as f64 - 5.5).signum()), mean(f64::NAN)],
        after: Some([mean(0.0), mean(f64::NAN)]),
    };
    let bins = (0..12).map(bin).collect();
    let (share_before, share_after) = (share, Some(0.01));
    Curve { variable, bins, share_before, share_after, log_significance: 900.0 * share }
}

fn whiteness() -> Whiteness {
    let wave = |turn: f64| vec![(0..400).map(|k| (turn * f64::from(k)).sin()).collect()];
    let wheel = |turn: f64| Innovations { scaled: wave(turn), input: wave(0.3 * turn) };
    analysed(&[wheel(2.1), wheel(1.7)], 0.01)
}

/// A model whose error on every recording is `error`.
fn model(recordings: &[RecordingStudy], error: f64, effects: &[&str]) -> ModelStudy {
    let failure = |regime, wheel, significant| Failure {
        regime,
        wheel,
        share_of_ise: 0.4,
        ratio_to_noise: 3.0,
        p_value: 0.0,
        moment: f64::NAN,
        std_error: f64::INFINITY,
        samples: 200,
        significant,
    };
    let is_bad = error > 0.1;
    let parameter = |effect: &str, symbol: &str, value: f64, std_error: f64| ParameterStudy {
        effect: effect.to_owned(),
        meaning: "a meaning".to_owned(),
        estimate: Estimate::new(symbol, "V".to_owned(), value, std_error),
    };
    let mut parameters = vec![
        parameter("inertia", "a1", 0.03, 1e-4),
        parameter("inertia", "a2", -0.002, f64::INFINITY),
    ];
    parameters.extend(effects.iter().map(|id| parameter(id, "f_t", 0.02, 1e-4)));
    ModelStudy {
        effects: effects.iter().map(|e| (*e).to_owned()).collect(),
        parameters,
        performance: recordings.iter().map(|r| performance(r, error)).collect(),
        residual_torque: recordings.iter().map(|r| r.moment.clone()).collect(),
        failures: vec![
            failure(Regime::PivotLeft, 1, is_bad),
            failure(Regime::StraightSteady, 2, false),
        ],
        horizons: vec![Horizon { seconds: f64::INFINITY, rms: error, fit_percent: [90.0, -5.0] }],
        whiteness: Some(whiteness()),
    }
}

fn candidate(effect: &str, probability: f64, window_after: f64) -> Candidate {
    Candidate {
        effect: effect.to_owned(),
        probability,
        indistinguishable: vec!["back_emf".to_owned()],
        p_value: 0.0,
        log_significance: 900.0,
        evidence: 700.0 * probability,
        delta_bic: f64::NAN,
        ise_validation_before: f64::INFINITY,
        ise_validation_after: 0.1,
        window_before: 0.4,
        window_after,
        parameters: vec![Estimate::new("f_t", "N m".to_owned(), 0.02, f64::INFINITY)],
        torque_rms: 0.01,
        words: "22 sigma".to_owned(),
    }
}

fn diagnosis() -> DiagnosisStudy {
    let step = |added: Option<&str>, window_rms_validation| Step {
        added: added.map(str::to_owned),
        ise_validation: f64::INFINITY,
        window_rms_validation,
    };
    DiagnosisStudy {
        likely: vec![],
        estimates: vec![],
        verdict: Verdict::EffectsMissing,
        sentence: "Missing: turning_scrub.".to_owned(),
        found: vec!["turning_scrub".to_owned()],
        ranking: vec![
            candidate("turning_scrub", 1.0, 0.05),
            candidate("my_own_formula", 0.0, f64::NAN),
        ],
        staircase: vec![step(None, 0.4), step(Some("turning_scrub"), 0.05)],
        unexplained_fraction: f64::NAN,
        next_run: Some("Record a turn.".to_owned()),
        proposal: None,
        false_alarm: 0.05,
        effects: vec![FoundEffect {
            id: "turning_scrub".to_owned(),
            title: "Turning scrub".to_owned(),
            cause: "tyres scrub".to_owned(),
            indistinguishable: vec![],
        }],
    }
}

fn fuzzy() -> FuzzyStudy {
    let grid: Vec<f64> = (0..30).map(f64::from).collect();
    let bell = |centre: f64| grid.iter().map(|w| (-((w - centre) / 6.0).powi(2)).exp()).collect();
    let memberships: Vec<Vec<f64>> = (0..6).map(|n| bell(6.0 * f64::from(n))).collect();
    let surface: Vec<Vec<f64>> =
        grid.iter().map(|a| grid.iter().map(|b| 0.1 * (a - b)).collect()).collect();
    FuzzyStudy {
        memberships: [memberships.clone(), memberships],
        consequents: [vec![1.5; 36], vec![-1.5; 36]],
        surface: [surface.clone(), surface],
        grid: [grid.clone(), grid],
        functions: vec![],
    }
}

/// A study that has everything: methods of every kind, one failed, one diverging, what cannot be
/// identified, numbers that are none.
pub(super) fn full() -> Study {
    let recordings = vec![recording(Role::Train), recording(Role::Validation)];
    let performed = |name: &str, error: f64| MethodStudy {
        performance: recordings.iter().map(|r| performance(r, error)).collect(),
        ..method(name)
    };
    let unit = || "V s^2/rad".to_owned();
    let mut physical = performed("prediction_error", 0.2);
    physical.estimates = vec![
        Estimate::new("a1", unit(), 0.03, 1e-4),
        Estimate::new("a2", unit(), -0.002, f64::INFINITY),
        Estimate { fixed: true, ..Estimate::new("a3", unit(), 3e-4, 0.0) },
        Estimate::new("a4", "V".to_owned(), 0.12, 0.01),
    ];
    physical.correlations = vec![vec![1.0, f64::NAN, 0.0, 0.5]; 4];
    physical.notes = vec!["a2 is not identifiable".to_owned()];
    physical.traces = vec![Trace {
        axis: "time [s]".to_owned(),
        at: (0..50).map(f64::from).collect(),
        names: vec!["a1".to_owned(), "cost [rad^2/s]".to_owned()],
        values: (0..50).map(|k| vec![0.03, (-0.2 * f64::from(k)).exp()]).collect(),
    }];
    let mut failed = method("output_error");
    failed.failure = Some("the data cannot give a2".to_owned());
    failed.status = None;
    let fuzzy = MethodStudy { fuzzy: Some(fuzzy()), ..performed("fuzzy_genetic", f64::NAN) };
    let version = |effects: &[&str], window_rms| Version {
        effects: effects.iter().map(|e| (*e).to_owned()).collect(),
        data: "sum".to_owned(),
        window_rms,
        ise: 0.2,
        floor: 0.05,
    };
    Study {
        file: "title = \"<b>full</b>\"".to_owned(),
        methods: vec![physical, failed, fuzzy, performed("diverging", f64::INFINITY)],
        reference: Some(0),
        emulator_gain: 2.0,
        given: Some(model(&recordings, 0.2, &[])),
        completed: Some(model(&recordings, 0.05, &["turning_scrub"])),
        curves: vec![curve(Variable::TurnRate, 0.7), curve(Variable::Heading, 0.1)],
        emulated: true,
        of_paper: true,
        diagnosis: Some(diagnosis()),
        versions: vec![version(&[], 0.4), version(&["turning_scrub"], 0.05)],
        truth: vec![("a1".to_owned(), 0.0305), ("a2".to_owned(), 0.0)],
        model_out: Some("model.json, model.py".to_owned()),
        recordings,
        ..empty()
    }
}

fn ids(study: &Study) -> Vec<&'static str> {
    let with_blocks = all().into_iter().filter(|s| !s.blocks(study).is_empty());
    with_blocks.map(|s| s.id()).collect()
}

#[test]
fn a_full_study_has_every_section_and_every_figure_is_drawn_once() {
    let study = full();
    assert_eq!(ids(&study).len(), all().len());
    let rendered = render(&study).unwrap();
    let figures: HashSet<&str> = rendered.figures.iter().map(|f| f.0.as_str()).collect();
    assert_eq!(figures.len(), rendered.figures.len());
    for name in ["overlay", "fit", "drive", "speeds", "path", "staircase", "staircase-versions"]
        .into_iter()
        .chain(["regimes", "dependence", "residuals", "ranking", "estimates", "correlations"])
        .chain(["methods", "memberships", "rules", "surface", "emulator-states", "emulator-errors"])
        .chain(["trace-prediction_error"])
    {
        assert!(figures.contains(format!("{name}.png").as_str()), "{name}");
    }
    for files in rendered.figures.chunks(2) {
        let [(png_name, png), (svg_name, svg)] = files else { panic!("a figure has two files") };
        assert_eq!(png_name.trim_end_matches(".png"), svg_name.trim_end_matches(".svg"));
        assert!(png.starts_with(b"\x89PNG"));
        assert!(String::from_utf8_lossy(svg).contains("<svg"));
    }
    for word in ["Missing: turning_scrub.", "experiment add turning_scrub runs/bare.toml"] {
        assert!(rendered.html.contains(word), "{word}");
    }
    assert!(!rendered.html.contains("<b>full</b>"));
    for text in [">NaN", "NaN<", ">inf<", ">-inf<"] {
        assert!(!rendered.html.contains(text), "{text}");
    }
}

#[test]
fn a_drive_in_volts_is_never_shown_in_newton_metres() {
    let html = render(&full()).unwrap().html;
    // the one parameter of a candidate is given in N m by this test itself, and has no value
    assert!(!html.contains("[N m]"));
    assert!(html.contains("drive") && html.contains("V s²/rad"));
}

#[test]
fn an_empty_study_says_that_there_is_no_fit_and_leaves_the_rest_out() {
    assert_eq!(ids(&empty()), ["verdict", "provenance"]);
    assert!(render(&empty()).unwrap().html.contains("No method has a fit"));
}

#[test]
fn a_study_without_validation_warns_and_judges_on_training_data() {
    let mut study = full();
    study.recordings.truncate(1);
    (study.diagnosis, study.completed) = (None, None);
    let html = render(&study).unwrap().html;
    assert!(html.contains("No validation recording is given"));
    assert!(html.contains("The error is 4 times the noise floor"));
    assert!(html.contains("pivot to the left"));
}

#[test]
fn a_study_whose_methods_all_failed_still_shows_why_and_what_was_recorded() {
    let mut study = full();
    study.methods.truncate(2);
    study.methods.remove(0);
    study.reference = None;
    (study.diagnosis, study.given, study.completed) = (None, None, None);
    (study.curves, study.versions) = (vec![], vec![]);
    assert_eq!(
        ids(&study),
        ["verdict", "methods", "explorer", "signals", "recordings", "provenance"]
    );
    assert!(render(&study).unwrap().html.contains("the data cannot give a2"));
}

#[test]
fn short_and_ragged_columns_are_drawn_as_far_as_they_go() {
    let mut study = full();
    for recording in &mut study.recordings {
        recording.acceleration.clear();
        recording.path.truncate(1);
        recording.regimes.clear();
        recording.alpha.truncate(10);
        recording.moment.clear();
    }
    for method in &mut study.methods {
        method.performance.truncate(1);
        method.correlations.truncate(1);
    }
    render(&study).unwrap();
    let models = [&mut study.given, &mut study.completed].into_iter().flatten();
    let of_models = models.flat_map(|m| &mut m.performance);
    for performance in study.methods.iter_mut().flat_map(|m| &mut m.performance).chain(of_models) {
        performance.windows.truncate(3);
        performance.emulator.clear();
    }
    study.recordings[0].t.clear();
    study.recordings[1].omega.clear();
    render(&study).unwrap();
}

#[test]
fn every_section_says_how_to_read_it_in_one_sentence_of_its_own() {
    let ids: HashSet<&str> = all().iter().map(|s| s.id()).collect();
    assert_eq!(ids.len(), all().len());
    for section in all() {
        let aid = section.how_to_read();
        assert!(aid.ends_with('.') && !aid.trim_end_matches('.').contains(". "), "{aid}");
        assert!(!section.title().is_empty());
    }
}

#[test]
fn the_paper_and_the_emulator_are_shown_only_where_they_are_asked_for() {
    let mut study = full();
    assert!(render(&study).unwrap().html.contains("The paper shows this as Fig. 3"));
    (study.emulated, study.of_paper) = (false, false);
    let html = render(&study).unwrap().html;
    assert!(!html.contains("The paper") && !html.contains("emulator-states"));
}

#[test]
fn error_floor_and_ratio_are_those_of_one_fit() {
    let study = full();
    let Block::Numbers(numbers) = &all()[0].blocks(&study)[1] else {
        panic!("numbers come second")
    };
    let values: Vec<&str> = numbers.iter().map(|n| n.value.as_str()).collect();
    // the completed model has 0.05, the floor is 0.05
    assert_eq!(values, ["0.0500", "0.0500", "1.00", "at the noise floor"]);
    assert_eq!(numbers[0].note, "0.200 without turning scrub");
}

#[test]
fn the_verdict_is_the_first_block_of_the_report() {
    for study in [empty(), full()] {
        let blocks = all()[0].blocks(&study);
        assert!(matches!(blocks[0], Block::Verdict { .. }));
    }
}

#[test]
fn the_guide_says_more_of_every_section_under_its_title() {
    let guide = include_str!("../../../docs/guide.md");
    for section in all() {
        let heading = format!("### {}\n", section.title());
        assert!(guide.contains(&heading), "{heading}");
    }
}
