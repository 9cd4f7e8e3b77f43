//! Sections on studies with next to nothing in them; full ones are rendered by the tests from
//! outside.

use crate::compare::Floor;
use crate::identify::Work;
use crate::recording::{DriveUnit, Measured, Noise, Regime};
use crate::report::{render, section};
use crate::study::{MethodStudy, Performance, RecordingStudy, Role, Study};

fn empty() -> Study {
    Study {
        experiment: "empty".into(),
        title: "<b>Empty</b>".into(),
        version: "0".into(),
        seed: 1,
        file: String::new(),
        robot: "amigobot".into(),
        effects: vec![],
        drive_unit: DriveUnit::Volt,
        recordings: vec![],
        methods: vec![],
        reference: None,
        emulator_gain: 0.0,
        failures: vec![],
        missing_moment: None,
        diagnosis: None,
        versions: vec![],
        truth: vec![],
    }
}

/// One recording of ten samples and one method whose simulation diverged.
fn diverged() -> Study {
    let rows = vec![[0.1, -0.1]; 10];
    let recording = RecordingStudy {
        role: Role::Train,
        file: "a.csv".into(),
        sha256: None,
        samples: 10,
        duration_s: 0.9,
        rate_hz: 10.0,
        measured: Measured { alpha: true, omega: true },
        noise: Noise { alpha: [0.0; 2], omega: [0.0; 2], moment: [0.0; 2] },
        findings: vec!["a wheel never moves".into()],
        floor: Floor { ise: [0.0; 2], window_rms: 0.0 },
        t: (0..10).map(|k| 0.1 * f64::from(k)).collect(),
        alpha: rows.clone(),
        omega: rows.clone(),
        acceleration: rows.clone(),
        moment: rows.clone(),
        regimes: vec![Regime::Standstill; 10],
        path: vec![[0.0; 3]; 10],
    };
    let performance = Performance {
        ise: [f64::INFINITY; 2],
        window_rms: f64::INFINITY,
        ise_parallel: f64::NAN,
        ise_serial_parallel: f64::NAN,
        free: vec![[f64::NAN; 2]; 10],
        windows: vec![[f64::NAN; 2]; 10],
        emulator: vec![],
    };
    let method = |failure: Option<String>| MethodStudy {
        name: "output_error".into(),
        title: String::new(),
        options: String::new(),
        failure,
        status: None,
        seconds: 0.0,
        work: Work::default(),
        estimates: vec![],
        correlations: vec![],
        notes: vec![],
        traces: vec![],
        performance: vec![performance.clone()],
        fuzzy: None,
    };
    Study {
        recordings: vec![recording],
        methods: vec![method(None), method(Some("no start".into()))],
        reference: Some(0),
        ..empty()
    }
}

#[test]
fn a_study_without_anything_still_renders_and_its_title_is_escaped() {
    let page = render(&empty()).unwrap().html;
    assert!(page.contains("&lt;b&gt;Empty&lt;/b&gt;") && !page.contains("<b>Empty"));
    assert!(page.contains("No method has a fit."));
}

#[test]
fn a_diverged_and_a_failed_method_are_shown_as_such() {
    let page = render(&diverged()).unwrap().html;
    assert!(page.contains("diverges") && page.contains("no start"));
}

#[test]
fn every_section_has_an_anchor_of_its_own() {
    let mut ids: Vec<&str> = section::all().iter().map(|s| s.id()).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}
