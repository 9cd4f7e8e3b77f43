//! Sections on full and almost empty studies.

mod studies;

use std::collections::HashSet;

use super::all;
use crate::report::block::Block;
use crate::report::{render, results, sign_of_speed};
use crate::study::Study;

pub(super) use studies::{empty, full};

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
    for word in
        ["Missing: turning scrub (turning_scrub).", "experiment add turning_scrub runs/bare.toml"]
    {
        assert!(rendered.html.contains(word), "{word}");
    }
    assert!(!rendered.html.contains("<b>full</b>"));
    for text in [">NaN", "NaN<", ">inf<", ">-inf<"] {
        assert!(!rendered.html.contains(text), "{text}");
    }
}

#[test]
fn a_study_of_the_library_names_no_command() {
    let mut study = full();
    study.invocation.file = String::new();
    let without_diagnosis = Study { diagnosis: None, completed: None, ..study.clone() };
    for study in [study, without_diagnosis] {
        let html = render(&study).unwrap().html;
        assert!(html.contains("Next step: ") && !html.contains("experiment add"));
        assert!(!html.contains("To repeat the run"));
    }
}

#[test]
fn an_input_in_volts_is_never_shown_in_newton_metres() {
    let html = render(&full()).unwrap().html;
    // the one parameter of a candidate is given in N m by this test itself, and has no value
    assert!(!html.contains("[N m]"));
    assert!(html.contains("drive") && html.contains("V s²/rad"));
}

#[test]
fn an_empty_study_states_that_there_is_no_fit_and_leaves_the_rest_out() {
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
    assert!(render(&study).unwrap().html.contains("the start cannot be simulated"));
}

#[test]
fn a_robot_without_a_name_does_not_head_the_report_of_measured_data() {
    let mut study = full();
    // the words of the file do not decide
    (study.robot, study.file) = ("some_robot".into(), "title = \"my some_robot\"".into());
    for given in [true, false] {
        study.robot_is_given = given;
        let html = render(&study).unwrap().html;
        assert_eq!(html.contains("· some_robot ·"), given);
    }
}

#[test]
fn short_and_ragged_columns_are_drawn_as_far_as_they_go() {
    let mut study = full();
    for recording in &mut study.recordings {
        recording.path.truncate(1);
        recording.regimes.clear();
        recording.alpha.truncate(10);
        recording.torque.clear();
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
fn every_section_states_how_to_read_it_in_one_sentence_of_its_own() {
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
fn the_guide_explains_every_section_under_its_title() {
    let guide = include_str!("../../../docs/guide.md");
    for section in all() {
        let heading = format!("### {}\n", section.title());
        assert!(guide.contains(&heading), "{heading}");
    }
}

#[test]
fn the_seed_is_stated_where_it_made_the_data() {
    let seed = |sha256: Option<&str>| {
        let mut study = full();
        study.recordings.iter_mut().for_each(|r| r.sha256 = sha256.map(str::to_owned));
        render(&study).unwrap().html.contains("<td>Seed</td>")
    };
    assert!(seed(None));
    assert!(!seed(Some("1234")), "recorded data have no seed");
}

#[test]
fn notes_of_the_quality_check_are_in_the_results() {
    use crate::recording::{Finding, Issue, Severity};
    let mut study = full();
    let note = Finding { severity: Severity::Note, issue: Issue::SignUntested(1) };
    study.recordings[0].notes = vec![note];
    let findings = crate::report::results(&study)["recordings"][0]["findings"].clone();
    let said: Vec<&str> = findings.as_array().unwrap().iter().filter_map(|f| f.as_str()).collect();
    assert_eq!(said.len(), 1 + study.recordings[0].findings.len());
    assert!(said.last().unwrap().contains("the sign of M2 is not tested"), "{said:?}");
}

#[test]
fn a_sign_that_is_that_of_the_speed_is_a_caution_of_the_verdict() {
    use crate::conditioning::{Action, Channel, Finding, Kind};
    let mut study = full();
    assert_eq!(sign_of_speed(&study), None);
    let given = |i, action| Finding { channel: Channel::Input(i), kind: Kind::Magnitude, action };
    study.recordings[0].conditioning = vec![
        given(0, Action::Corrected("sign_from_speed")),
        given(1, Action::Corrected("sign_from_speed")),
    ];
    let caution = sign_of_speed(&study).unwrap();
    assert!(
        caution.starts_with(
            "The sign of M1 and M2 is that of the speed, which the model has to predict"
        )
    );
    assert!(render(&study).unwrap().html.contains(&caution));
    assert_eq!(results(&study)["diagnosis"]["sign_of_speed"], caution);
    study.recordings[0].conditioning = vec![given(0, Action::Noted)];
    assert_eq!(sign_of_speed(&study), None);
}
