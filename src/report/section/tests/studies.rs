//! Studies as tests want them: full, and almost empty.

use crate::compare::{
    Acting, Curve, CurveBin, Failure, Floor, Horizon, Innovations, Mean, Variable, Whiteness,
    analysed,
};
use crate::diagnose::{Errors, Judgement};
use crate::export::ModelFiles;
use crate::identify::{
    Estimate, IdentifyError, NoStart, Note, Status, Trace, TraceAxis, TraceKind, Work,
};
use crate::recording::{DriveUnit, Finding, Issue, Measured, Noise, Regime, Severity};
use crate::study::{
    Advice, CandidateStudy, DiagnosisStudy, FoundEffect, FuzzyStudy, Invocation, Logging,
    MethodStudy, ModelStudy, ParameterStudy, Performance, RecordingStudy, Role, StepStudy, Study,
    Verdict, Version,
};

/// Samples of a recording.
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
        noise: Noise { alpha: [1e-3; 2], omega: [0.05; 2], torque: [0.005; 2] },
        conditioning: vec![],
        findings: vec![Finding { severity: Severity::Warning, issue: Issue::Still(1) }],
        notes: vec![],
        floor: Floor { ise: [0.01; 2], window_rms: 0.05, window_most: 0.05, window_slow: 0.0 },
        alpha: t.iter().map(|t| [4.0 - 4.0 * t.cos(), 3.0 * t.sin()]).collect(),
        torque: omega.iter().map(|w| [0.1 * w[0], 0.1 * w[1]]).collect(),
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
        status: Some(Status::Converged),
        work: Work { iterations: 3, evaluations: 12 },
        ..MethodStudy::new(name, &format!("The method {name}"), "", 0.1)
    }
}

pub(in crate::report::section) fn empty() -> Study {
    Study {
        timing: Err(crate::diagnose::Untimed::default()),
        timing_as_given: None,
        experiment: "bare".to_owned(),
        invocation: Invocation { file: "runs/bare.toml".to_owned(), ..Invocation::default() },
        title: "Bare".to_owned(),
        version: "0".to_owned(),
        seed: 1,
        file: String::new(),
        robot: "robot".to_owned(),
        robot_is_given: true,
        track_is_known: true,
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
    Curve {
        variable,
        acting: Acting::Torque,
        bins,
        share_before,
        share_after,
        log_significance: 900.0 * share,
    }
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
        torque: f64::NAN,
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
        residual_torque: recordings.iter().map(|r| r.torque.clone()).collect(),
        failures: vec![
            failure(Regime::PivotLeft, 1, is_bad),
            failure(Regime::StraightSteady, 2, false),
        ],
        horizons: vec![Horizon { seconds: f64::INFINITY, rms: error, fit_percent: [90.0, -5.0] }],
        whiteness: Some(whiteness()),
    }
}

fn candidate(effect: &str, probability: f64, window_after: f64) -> CandidateStudy {
    CandidateStudy {
        effect: effect.to_owned(),
        probability,
        no_better: false,
        indistinguishable: vec!["back_emf".to_owned()],
        p_value: 0.0,
        log_significance: 900.0,
        evidence: 700.0 * probability,
        delta_bic: if probability > 0.0 { 1400.0 * probability } else { f64::NAN },
        before: Judgement { ise: f64::INFINITY, window_rms: 0.4 },
        after: Some(Judgement { ise: 0.1, window_rms: window_after }),
        by_regression: 22.0,
        by_windows: 21.0,
        parameters: vec![Estimate::new("f_t", "N m".to_owned(), 0.02, f64::INFINITY)],
        torque_rms: 0.01,
    }
}

fn diagnosis() -> DiagnosisStudy {
    let step = |added: Option<&str>, window_rms_validation| StepStudy {
        added: added.map(str::to_owned),
        ise_validation: f64::INFINITY,
        window_rms_validation,
    };
    DiagnosisStudy {
        verdict: Verdict::EffectsMissing,
        errors: Errors {
            before: 0.16,
            after: f64::NAN,
            floor: 0.0025,
            most: 0.0025,
            uncertain: 0.0,
            slow_floor: false,
            speed: 100.0,
        },
        unproven: None,
        withheld: None,
        logging: Logging {
            unit: DriveUnit::Volt,
            if_held: None,
            speeds_alone: false,
            longest_s: 60.0,
        },
        at_floor: None,
        differs: None,
        dependence: None,
        parameters: vec![],
        correlations: vec![],
        found: vec!["turning_scrub".to_owned()],
        ranking: vec![
            candidate("turning_scrub", 1.0, 0.05),
            candidate("my_own_formula", 0.0, f64::NAN),
        ],
        staircase: vec![step(None, 0.4), step(Some("turning_scrub"), 0.05)],
        next: vec![Advice::Closest(["turning_scrub".to_owned(), "yaw_viscous".to_owned()])],
        proposal: None,
        false_alarm: 0.05,
        effects: vec![FoundEffect {
            id: "turning_scrub".to_owned(),
            title: "Turning scrub".to_owned(),
            cause: "tyres scrub".to_owned(),
            indistinguishable: vec![],
        }],
        formula: None,
        undetermined: None,
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
pub(in crate::report::section) fn full() -> Study {
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
    physical.notes = vec![Note::MassNotPositive];
    let trace = |kind, axis, value: fn(f64) -> f64| Trace {
        kind,
        axis,
        at: (0..50).map(f64::from).collect(),
        values: (0..50).map(|k| vec![value(f64::from(k))]).collect(),
    };
    let symbols = TraceKind::Estimates(vec!["a1".to_owned()]);
    physical.traces = vec![trace(symbols, TraceAxis::Time, |_| 0.03)];
    let mut failed = method("output_error");
    failed.failure = Some(IdentifyError::NoStart {
        method: "output_error".to_owned(),
        reason: NoStart::Simulation,
    });
    failed.status = None;
    let cost = trace(TraceKind::Cost, TraceAxis::Evaluation, |k| (-0.2 * k).exp());
    let fuzzy = MethodStudy {
        fuzzy: Some(fuzzy()),
        traces: vec![cost],
        ..performed("fuzzy_genetic", f64::NAN)
    };
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
        model_out: Some(ModelFiles {
            files: ["model.json", "model.py"].map(|name| (name.to_owned(), String::new())).into(),
            obstacles: vec![],
        }),
        recordings,
        ..empty()
    }
}
