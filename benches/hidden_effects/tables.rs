//! Tables of the outcomes, by robot and by simulator.

use std::collections::BTreeSet;

use hidden_effects::case::{Case, SIZES, Simulator};
use hidden_effects::hidden::EFFECTS;
use hidden_effects::judge::{Outcome, Said};
use hidden_effects::robots::Machine;
use hidden_effects::scenario::DURATION;

type Row = (Case, Outcome);

/// One case per line.
pub(crate) fn line(case: &Case, outcome: &Outcome) -> String {
    let Some(said) = outcome.said.last() else {
        return format!("{case} -> failed: {}", outcome.failure.as_deref().unwrap_or("?"));
    };
    let named: Vec<String> =
        outcome.said.iter().map(|s| format!("{}:{:?}", s.false_alarm, s.found)).collect();
    let errors: Vec<String> = said.versions.iter().map(|v| format!("{v:.2}")).collect();
    let likely = if said.likely.is_empty() { String::new() } else { format!(" {:?}", said.likely) };
    let named = named.join(" ");
    let (verdict, errors, seconds) = (&said.verdict, errors.join(" "), outcome.seconds);
    format!("{case} -> {verdict}{likely} {named} {errors} x floor, {seconds:.1} s")
}

/// Prints all tables for which there are cases.
pub(crate) fn print(rows: &[Row], rates: &[f64]) {
    let failed: Vec<&Row> = rows.iter().filter(|(_, o)| o.failure.is_some()).collect();
    let rows: Vec<&Row> = rows.iter().filter(|(_, o)| o.failure.is_none()).collect();
    println!(
        "\n{} cases with a result, {} without; {DURATION} s a recording",
        rows.len(),
        failed.len()
    );
    let of = |kind: &str| -> Vec<&Row> {
        rows.iter().copied().filter(|(case, _)| case.kind() == kind).collect()
    };
    healthy(&of("healthy"), rates);
    coverage(&of("healthy"));
    calibration(&of("healthy"), rates);
    singles(&of("single"));
    effects(&of("single"));
    two(&of("two"));
    outside(&of("outside"));
    staircases(&rows);
}

/// The simulators of the cases, each with its rows.
fn by_simulator<'a>(rows: &[&'a Row]) -> Vec<(Simulator, Vec<&'a Row>)> {
    let of = |simulator| {
        let own = rows.iter().copied().filter(|(case, _)| case.simulator == simulator).collect();
        (simulator, own)
    };
    let all = [Simulator::Own, Simulator::Second].map(of);
    all.into_iter().filter(|(_, own): &(_, Vec<&Row>)| !own.is_empty()).collect()
}

/// Robots in the order of the cases, each with a group of rows; the last group holds all.
fn by_robot<'a>(rows: &[&'a Row]) -> Vec<(String, Vec<&'a Row>)> {
    let mut names: Vec<String> = Vec::new();
    for (case, _) in rows {
        if !names.contains(&case.robot) {
            names.push(case.robot.clone());
        }
    }
    let mut out: Vec<(String, Vec<&Row>)> = Vec::new();
    for name in names {
        let own = rows.iter().copied().filter(|(case, _)| case.robot == name).collect();
        out.push((name, own));
    }
    out.push(("all".into(), rows.to_vec()));
    out
}

/// Mass and deceleration of a robot.
fn facts(name: &str) -> String {
    Machine::of(name).map_or(" | ".into(), |m| format!("{:.2} | {:.1}", m.mass(), m.deceleration()))
}

fn name(simulator: Simulator) -> &'static str {
    if simulator == Simulator::Own { "own" } else { "second" }
}

fn healthy(rows: &[&Row], rates: &[f64]) {
    if rows.is_empty() {
        return;
    }
    let logs: BTreeSet<String> = rows.iter().map(|(case, _)| case.log.name()).collect();
    let rated: Vec<String> = rates.iter().map(|r| format!("named at {r}")).collect();
    for simulator in [Simulator::Own, Simulator::Second] {
        for log in &logs {
            let of = |(case, _): &&&Row| case.simulator == simulator && case.log.name() == *log;
            let own: Vec<&Row> = rows.iter().filter(of).copied().collect();
            if own.is_empty() {
                continue;
            }
            println!("\n## Nothing hidden, simulator {}, log {log}\n", name(simulator));
            println!(
                "| robot | kg | a4/(a1+a2) rad/s^2 | sets | {} | unknown said | above 1.5 floors | error / floor, median, largest |\n|---|---|---|---|{}---|---|---|",
                rated.join(" | "),
                "---|".repeat(rates.len())
            );
            for (robot, group) in by_robot(&own) {
                println!("| {robot} | {} | {} |", facts(&robot), healthy_row(&group, rates));
            }
        }
    }
}

fn healthy_row(group: &[&Row], rates: &[f64]) -> String {
    let n = group.len();
    let said = |good: &dyn Fn(&Said) -> bool, rate: f64| {
        share(group.iter().filter(|(_, o)| o.at(rate).is_some_and(good)).count(), n)
    };
    let mut cells = vec![n.to_string()];
    for &rate in rates {
        cells.push(said(&|s| !s.found.is_empty(), rate));
    }
    let middle = rates.get(rates.len() / 2).copied().unwrap_or(0.05);
    cells.push(said(&|s| s.verdict == "unknown_effect", middle));
    let mut base: Vec<f64> = group
        .iter()
        .filter_map(|(_, o)| o.said.last().and_then(|s| s.versions.first().copied()))
        .collect();
    base.sort_by(f64::total_cmp);
    cells.push(base.iter().filter(|v| **v > 1.5).count().to_string());
    let of = |k: usize| base.get(k).copied().unwrap_or(f64::NAN);
    cells.push(format!("{:.2}, {:.2}", of(base.len() / 2), of(base.len().saturating_sub(1))));
    cells.join(" | ")
}

/// Share of the 95 % intervals of the default estimate that cover the true values.
fn coverage(rows: &[&Row]) {
    for (simulator, own) in by_simulator(rows) {
        println!("\n## Coverage of the 95 % intervals, simulator {}\n", name(simulator));
        println!(
            "| robot | a1 | a2 | a3 | a4 | a5 | all | rms z | relative error of a1, median |\n|---|---|---|---|---|---|---|---|---|"
        );
        for (robot, group) in by_robot(&own) {
            println!("| {robot} | {} |", coverage_row(&group));
        }
    }
}

fn coverage_row(group: &[&Row]) -> String {
    let all = || group.iter().flat_map(|(_, o)| &o.estimates);
    let mut cells = Vec::new();
    for symbol in ["a1", "a2", "a3", "a4", "a5", ""] {
        let own = || all().filter(|e| symbol.is_empty() || e.symbol == symbol);
        cells.push(share(own().filter(|e| e.covered).count(), own().count()));
    }
    let z: Vec<f64> =
        all().filter(|e| e.std_error > 0.0).map(|e| (e.value - e.truth) / e.std_error).collect();
    let square: f64 = z.iter().map(|z| z * z).sum();
    cells.push(format!("{:.2}", (square / z.len() as f64).sqrt()));
    let mut a1: Vec<f64> =
        all().filter(|e| e.symbol == "a1").map(|e| e.value / e.truth - 1.0).collect();
    a1.sort_by(f64::total_cmp);
    cells.push(a1.get(a1.len() / 2).map_or("-".into(), |e| format!("{:+.2} %", 100.0 * e)));
    cells.join(" | ")
}

/// Share of the p-values of healthy sets below a rate. The p-value of a refitted candidate is that of a single test;
/// the first of the ranking has been selected, so that its p-value is not.
fn calibration(rows: &[&Row], rates: &[f64]) {
    if rows.is_empty() {
        return;
    }
    println!("\n## Calibration of the reported p-values, nothing hidden\n");
    let heads: Vec<String> = rates.iter().map(|r| format!("p < {r}")).collect();
    println!(
        "| simulator | p-values | of | {} |\n|---|---|---|{}",
        heads.join(" | "),
        "---|".repeat(rates.len())
    );
    for simulator in [Simulator::Own, Simulator::Second] {
        let own = || rows.iter().filter(|(c, _)| c.simulator == simulator);
        let every: Vec<f64> =
            own().flat_map(|(_, o)| o.ranking.iter().map(|l| l.p_value)).collect();
        let first: Vec<f64> =
            own().filter_map(|(_, o)| o.ranking.first().map(|l| l.p_value)).collect();
        for (what, values) in
            [("every refitted candidate", every), ("the first of the ranking", first)]
        {
            let below =
                |rate: &f64| share(values.iter().filter(|p| *p < rate).count(), values.len());
            let cells: Vec<String> = rates.iter().map(below).collect();
            println!("| {} | {what} | {} | {} |", name(simulator), values.len(), cells.join(" | "));
        }
    }
}

/// Results at the program's default rate.
fn default(outcome: &Outcome) -> Option<&Said> {
    outcome.at(super::DEFAULT_RATE)
}

fn singles(rows: &[&Row]) {
    for (simulator, own) in by_simulator(rows) {
        println!(
            "\n## One effect, simulator {}: named first | exact, nothing beside it\n",
            name(simulator)
        );
        println!(
            "| robot | kg | a4/(a1+a2) rad/s^2 | strong | | moderate | | weak | |\n|---|---|---|---|---|---|---|---|---|"
        );
        for (robot, group) in by_robot(&own) {
            let cells: Vec<String> = SIZES
                .iter()
                .map(|size| {
                    pair(
                        &group.iter().filter(|(c, _)| c.size == *size).copied().collect::<Vec<_>>(),
                    )
                })
                .collect();
            println!("| {robot} | {} | {} |", facts(&robot), cells.join(" | "));
        }
    }
}

/// Counts of a group: effect named, and exactly the hidden effects named.
fn pair(group: &[&Row]) -> String {
    let count = |good: fn(&Said, &[String]) -> bool| {
        let right = |(c, o): &&&Row| default(o).is_some_and(|s| good(s, &c.hidden));
        share(group.iter().filter(right).count(), group.len())
    };
    format!("{} | {}", count(Said::named), count(Said::exact))
}

fn effects(rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    println!(
        "\n## By effect\n\n| hidden | named | exact | named first in its place |\n|---|---|---|---|"
    );
    for effect in EFFECTS {
        let own: Vec<&Row> = rows.iter().filter(|(c, _)| c.hidden == [effect]).copied().collect();
        if own.is_empty() {
            continue;
        }
        let mut instead: Vec<String> = own
            .iter()
            .filter_map(|(c, o)| default(o).filter(|s| !s.named(&c.hidden)))
            .map(|s| s.found.first().cloned().unwrap_or(s.verdict.clone()))
            .collect();
        instead.sort();
        let instead: Vec<String> =
            instead.chunk_by(|a, b| a == b).map(|c| format!("{} {}", c.len(), c[0])).collect();
        println!("| {effect} | {} | {} |", pair(&own), instead.join(", "));
    }
}

fn two(rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    println!(
        "\n## Two effects\n\n| simulator | one of them first | both, nothing beside them |\n|---|---|---|"
    );
    for simulator in [Simulator::Own, Simulator::Second] {
        let own: Vec<&Row> =
            rows.iter().filter(|(c, _)| c.simulator == simulator).copied().collect();
        println!("| {} | {} |", name(simulator), pair(&own));
    }
}

fn outside(rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    println!(
        "\n## Outside the catalogue\n\n| what | unknown said | an effect named and no more | likely | nothing said |\n|---|---|---|---|---|"
    );
    for kind in hidden_effects::hidden::OUTSIDE {
        let own: Vec<&Row> = rows.iter().filter(|(c, _)| c.hidden == [kind]).copied().collect();
        let said = |verdict: &str| {
            let right = |(_, o): &&&Row| default(o).is_some_and(|s| s.verdict == verdict);
            share(own.iter().filter(right).count(), own.len())
        };
        let verdicts = ["unknown_effect", "effects_missing", "effect_likely", "model_sufficient"];
        println!("| {kind} | {} |", verdicts.map(said).join(" | "));
    }
}

/// Errors that rise with a version, and verdicts without an effect above the floor.
fn staircases(rows: &[&Row]) {
    let hiding: Vec<&Row> = rows.iter().filter(|(c, _)| !c.hidden.is_empty()).copied().collect();
    let count = |rows: &[&Row], good: fn(&Said) -> bool| {
        let cases: Vec<&str> = rows
            .iter()
            .filter(|(_, o)| o.said.iter().any(good))
            .map(|(_, o)| o.case.as_str())
            .collect();
        format!("{} | {}", share(cases.len(), rows.len()), cases.join(", "))
    };
    println!("\n## Everywhere\n\n| what | sets | cases |\n|---|---|---|");
    println!("| error by model version rises | {} |", count(rows, Said::rises));
    println!(
        "| \"nothing is missing\" above 1.5 floors, something hidden | {} |",
        count(&hiding, Said::silent)
    );
}

/// A share with Wilson's 95 % interval.
pub(crate) fn share(count: usize, of: usize) -> String {
    if of == 0 {
        return "-".into();
    }
    let (low, high) = wilson(count, of);
    format!("{count}/{of} ({:.0}-{:.0} %)", 100.0 * low, 100.0 * high)
}

/// Wilson's 95 % interval of a share.
fn wilson(count: usize, of: usize) -> (f64, f64) {
    let (n, z2) = (of as f64, 1.96_f64 * 1.96);
    let share = count as f64 / n;
    let middle = share + z2 / (2.0 * n);
    let half = (z2 * (share * (1.0 - share) / n + z2 / (4.0 * n * n))).sqrt();
    (((middle - half) / (1.0 + z2 / n)).max(0.0), (middle + half) / (1.0 + z2 / n))
}
