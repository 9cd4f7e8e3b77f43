//! Tables of the outcomes.

use amigo_ident::diagnose::Conclusion;

use super::cases::{Case, HIDDEN, SIZES, STRANGERS, WORLDS, same};
use super::judge::Outcome;

/// A case and what was said of it.
pub(crate) struct Row {
    pub(crate) case: Case,
    pub(crate) outcome: Outcome,
}

impl Row {
    pub(crate) const HEADER: &str = "hidden,size,noise,recorded,seed,found,verdict,first_three,equals,\
                              unexplained,excess,seconds";

    /// Whether everything was said right.
    pub(crate) fn good(&self) -> bool {
        match (self.case.stranger, self.outcome.conclusion) {
            (Some(_), said) => said == Conclusion::Unknown,
            (None, Conclusion::Unknown) => false,
            (None, _) => self.outcome.exact(&self.case),
        }
    }

    /// The row as CSV.
    pub(crate) fn line(&self) -> String {
        let o = &self.outcome;
        format!(
            "{},{},{:?},{},{},{:.3},{:.3},{:.1}",
            self.case,
            o.found.join("+"),
            o.conclusion,
            o.ranking.join(" "),
            o.equals.join(" "),
            o.unexplained,
            o.excess,
            o.seconds
        )
    }
}

/// Prints all tables for which there are rows.
pub(crate) fn print(rows: &[Row]) {
    let some = |of: &[&Row]| !of.is_empty();
    singles(rows);
    per_effect(rows);
    confused(rows);
    let pairs: Vec<&Row> = rows.iter().filter(|r| r.case.hidden.len() == 2).collect();
    if some(&pairs) {
        println!("\n## Two effects\n\n| said | sets |\n|---|---|");
        let exact = pairs.iter().filter(|r| r.outcome.exact(&r.case)).count();
        let first = pairs.iter().filter(|r| r.outcome.class(&r.case)).count();
        println!("| both, nothing else | {} |", share(exact, pairs.len()));
        println!("| one of them first | {} |", share(first, pairs.len()));
    }
    healthy(rows);
    strangers(rows);
}

fn singles(rows: &[Row]) {
    println!(
        "\n## One effect\n\n| noise | size | first | first, or said to be equal | among the first \
         three | exact | removed of the held-out excess, median |\n|---|---|---|---|---|---|---|"
    );
    for level in 1..=3 {
        for (name, size) in SIZES {
            let of: Vec<&Row> = rows
                .iter()
                .filter(|r| r.case.hidden.len() == 1 && r.case.level == level)
                .filter(|r| r.case.size == size)
                .collect();
            if of.is_empty() {
                continue;
            }
            let count = |good: fn(&Outcome, &Case) -> bool| {
                share(of.iter().filter(|r| good(&r.outcome, &r.case)).count(), of.len())
            };
            println!(
                "| N{level} | {name} | {} | {} | {} | {} | {} |",
                count(Outcome::first),
                count(Outcome::class),
                count(Outcome::top3),
                count(Outcome::exact),
                removed(&of)
            );
        }
    }
}

/// Median share of the explainable error that the diagnosis removed, over the sets where the model
/// without the effect is at least 4 % above the floor in variance.
fn removed(of: &[&Row]) -> String {
    let visible = of.iter().filter(|r| r.outcome.excess > 0.04);
    let mut shares: Vec<f64> = visible.map(|r| 1.0 - r.outcome.unexplained).collect();
    shares.sort_by(f64::total_cmp);
    match shares.get(shares.len() / 2) {
        Some(median) => format!("{:.0} % ({} sets)", 100.0 * median, shares.len()),
        None => "-".into(),
    }
}

fn per_effect(rows: &[Row]) {
    println!("\n| hidden | first | exact | removed, median |\n|---|---|---|---|");
    for (id, _) in HIDDEN {
        let of: Vec<&Row> = rows.iter().filter(|r| r.case.hidden == [id]).collect();
        if of.is_empty() {
            continue;
        }
        let first = of.iter().filter(|r| r.outcome.first(&r.case)).count();
        let exact = of.iter().filter(|r| r.outcome.exact(&r.case)).count();
        let n = of.len();
        println!("| {id} | {first} / {n} | {exact} / {n} | {} |", removed(&of));
    }
}

/// The confusion matrix without its diagonal: what was named first in place of the hidden effect.
fn confused(rows: &[Row]) {
    println!("\n| hidden | named first in its place | sets |\n|---|---|---|");
    for (id, _) in HIDDEN {
        let of = || rows.iter().filter(|r| r.case.hidden == [id]);
        let first = |r: &Row| r.outcome.found.first().cloned().unwrap_or("nothing".into());
        let mut wrong: Vec<String> = of().map(first).filter(|f| !same(f, id)).collect();
        wrong.sort();
        for name in wrong.chunk_by(|a, b| a == b) {
            println!("| {id} | {} | {} |", name[0], name.len());
        }
    }
}

fn healthy(rows: &[Row]) {
    println!(
        "\n## Nothing hidden\n\n| noise | recorded | an effect named | unknown effect said | rate \
         of both, 95 % |\n|---|---|---|---|---|"
    );
    for (level, world) in (1..=3).flat_map(|level| WORLDS.map(|w| (level, w))) {
        let of: Vec<&Row> = rows
            .iter()
            .filter(|r| r.case.hidden.is_empty() && r.case.stranger.is_none())
            .filter(|r| r.case.level == level && r.case.world == world)
            .collect();
        if of.is_empty() {
            continue;
        }
        let named = of.iter().filter(|r| !r.outcome.found.is_empty()).count();
        let unknown = of.iter().filter(|r| r.outcome.conclusion == Conclusion::Unknown).count();
        let alarms = of.iter().filter(|r| r.outcome.conclusion != Conclusion::Sufficient).count();
        let (low, high) = wilson(alarms, of.len());
        let n = of.len();
        println!(
            "| N{level} | {} | {named} / {n} | {unknown} / {n} | {:.1} to {:.1} % |",
            format!("{world:?}").to_lowercase(),
            100.0 * low,
            100.0 * high
        );
    }
}

fn strangers(rows: &[Row]) {
    if rows.iter().all(|r| r.case.stranger.is_none()) {
        return;
    }
    println!(
        "\n## Outside the catalogue\n\n| what | unknown effect said | nothing missing said | \
         effects named instead |\n|---|---|---|---|"
    );
    for kind in STRANGERS {
        let of: Vec<&Row> = rows.iter().filter(|r| r.case.stranger == Some(kind)).collect();
        let said = |c: Conclusion| of.iter().filter(|r| r.outcome.conclusion == c).count();
        let wrong = of.iter().filter(|r| r.outcome.conclusion == Conclusion::Missing);
        let mut names: Vec<String> = wrong.map(|r| r.outcome.found.join("+")).collect();
        names.sort();
        names.dedup();
        println!(
            "| {} | {} / {} | {} | {}: {} |",
            format!("{kind:?}").to_lowercase(),
            said(Conclusion::Unknown),
            of.len(),
            said(Conclusion::Sufficient),
            said(Conclusion::Missing),
            names.join(", ")
        );
    }
}

fn share(count: usize, of: usize) -> String {
    let (low, _) = wilson(count, of);
    format!("{count} / {of} (> {:.0} %)", 100.0 * low)
}

/// Wilson's 95 % interval of a share.
fn wilson(count: usize, of: usize) -> (f64, f64) {
    let (n, z2) = (of as f64, 1.96_f64 * 1.96);
    let share = count as f64 / n;
    let middle = share + z2 / (2.0 * n);
    let half = (z2 * (share * (1.0 - share) / n + z2 / (4.0 * n * n))).sqrt();
    ((middle - half) / (1.0 + z2 / n), (middle + half) / (1.0 + z2 / n))
}
