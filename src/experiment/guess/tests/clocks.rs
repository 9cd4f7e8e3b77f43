//! Which column is the time.

use super::*;

fn counted(name: &str, of: impl Fn(usize) -> f64) -> PreviewColumn {
    PreviewColumn {
        name: name.into(),
        values: (0..400).map(of).collect(),
        ..PreviewColumn::default()
    }
}

fn time(columns: &[PreviewColumn]) -> Guessed {
    guess(columns).columns.into_iter().find(|c| c.key == "t").unwrap()
}

#[test]
fn a_column_that_counts_rows_has_its_step_asked() {
    let log = [counted("sample", |k| k as f64), counted("count_l", |k| (k * k % 7) as f64)];
    let found = time(&log);
    assert!(found.scale_open && found.unit.is_none(), "{found:?}");
    // a time that is there goes before it
    let log = [log[0].clone(), counted("column2", |k| 0.02 * k as f64)];
    assert_eq!((time(&log).name.as_str(), time(&log).scale_open), ("column2", false));
    // milliseconds by their name
    assert_eq!(time(&[counted("ms", |k| k as f64)]).unit.as_deref(), Some("ms"));
}

#[test]
fn a_column_whose_steps_are_not_those_of_a_time_is_asked_about() {
    let speed = counted("column2", |k| (0.1 * k as f64).sin());
    let open = |of: &dyn Fn(usize) -> f64| {
        let found = time(&[counted("column1", of), speed.clone()]);
        assert_eq!(found.name, "column1");
        found.unit_open
    };
    // the way of a wheel that starts, and of one that changes its speed
    assert!(open(&|k| 0.4 * k.max(4) as f64));
    assert!(open(&|k| 0.02 * k as f64 + 0.1 * (0.2 * k as f64).sin() / 1.1));
    // rows that are late by up to a third, and lost ones
    let late =
        |k: usize| 0.02 * (k + 7 * (k / 50)) as f64 + 0.003 * (k * 7919 % 101) as f64 / 101.0;
    assert!(!open(&|k| 0.02 * k as f64) && !open(&late));
}

#[test]
fn seconds_and_nanoseconds_without_names_belong_together() {
    let log = [
        counted("column1", |k| 1_718_000_000.0 + (k / 30) as f64),
        counted("column2", |k| 33_333_333.0 * (k % 30) as f64),
        counted("column3", |k| (0.1 * k as f64).sin()),
    ];
    let found = time(&log);
    assert_eq!((found.name.as_str(), found.nanoseconds.as_deref()), ("column1", Some("column2")));
}

#[test]
fn steps_between_rows_are_summed() {
    let log = [
        counted("dt_ms", |_| 50.0),
        counted("rpm_l", |k| k as f64),
        counted("rpm_r", |k| k as f64),
    ];
    let found = time(&log);
    assert!(found.sum && found.name == "dt_ms" && found.unit.as_deref() == Some("ms"), "{found:?}");
    assert_eq!(time(&[counted("dt", |_| 0.02), log[1].clone()]).unit, None);
    // a time in words that are not read is none
    let date = PreviewColumn {
        words: vec!["Mon Jun 10 13:03:00 2024".into()],
        ..counted("date", |_| f64::NAN)
    };
    assert!(time(&[date, log[0].clone()]).sum);
    // never where there is a time
    assert!(!time(&[log[0].clone(), counted("time", |k| 0.05 * k as f64)]).sum);
}

#[test]
fn the_period_that_a_file_states_stands_for_a_time_that_is_not_there() {
    let log =
        [counted("w_r", |k| (0.1 * k as f64).sin()), counted("w_l", |k| (0.1 * k as f64).sin())];
    let mut g = guess(&log);
    assert!(g.take_period(&log, 0.01) && g.period == Some(0.01));
    assert!(
        !g.questions.iter().any(|q| q.text.contains("what is the sampling period")),
        "{:?}",
        g.questions
    );
    let rows = [counted("sample", |k| k as f64), log[0].clone()];
    let mut g = guess(&rows);
    assert!(g.take_period(&rows, 0.02) && g.columns[0].scale == Some(0.02));
    assert!(!g.columns[0].scale_open);
    let time = [counted("t", |k| 0.01 * k as f64)];
    assert!(!guess(&time).take_period(&time, 0.02));
}

#[test]
fn ticks_in_even_steps_are_those_of_a_timer_and_their_length_is_asked() {
    let wave = |name: &str| counted(name, |k| (0.1 * k as f64).sin());
    let ticks = counted("tick", |k| 77.0 + (327.68 * k as f64).round());
    let log = [ticks, wave("w_r"), wave("w_l")];
    let mut g = guess(&log);
    let t = &g.columns[0];
    assert_eq!((t.key, t.name.as_str(), t.scale_open), ("t", "tick", true));
    assert!(
        g.asked().contains("counts the ticks of a timer, 328 from row to row"),
        "{}",
        g.asked()
    );
    assert!(g.take_period(&log, 0.01) && g.columns[0].scale == Some(0.01 / 328.0));
    // the counts of a wheel, which turns at a speed that changes
    let wheel = counted("tick", |k| (300.0 * k as f64 - 4000.0 * (k as f64 / 40.0).cos()).round());
    assert!(!guess(&[wheel, wave("w_r"), wave("w_l")]).columns.iter().any(|c| c.key == "t"));
}

#[test]
fn seconds_of_a_coarse_clock_are_no_milliseconds() {
    let of_day = counted("timestamp", |k| 43_380.0 + (k / 4) as f64);
    assert_eq!(time(&[of_day]).unit, None);
}

#[test]
fn a_time_rises_in_every_row_and_by_more_even_steps_than_counts() {
    // stamps of a loop of 6 to 14 ms; counts repeat at low speed
    let stamp = |k: usize| 0.01 * k as f64 + 0.004 * ((k * 37 % 11) as f64 / 11.0);
    let count = |k: usize| -67_305.0 + (3.0 * k as f64 - 40.0 * (k as f64 / 40.0).sin()).floor();
    let log = [counted("column1", count), counted("column2", stamp)];
    let found = time(&log);
    assert_eq!(found.name, "column2");
    assert!(found.evidence[0].contains("most even steps"), "{:?}", found.evidence);
    // also beside an angle that rises in every row
    let angle = |k: usize| 0.05 * k as f64 + 1.5 * (1.0 - (k as f64 / 30.0).cos());
    assert_eq!(time(&[counted("column1", angle), log[1].clone()]).name, "column2");
    let words = guess(&[log[0].clone(), counted("column2", |k| 1e3 * stamp(k))]).words();
    assert!(words.contains("no unit is stated: t in ms"), "{words}");
}
