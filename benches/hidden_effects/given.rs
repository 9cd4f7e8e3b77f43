//! Confidence intervals of models that contain the hidden effects.

use hidden_effects::case::Case;
use hidden_effects::hidden::EFFECTS;
use hidden_effects::judge::{BASE, Covered, Outcome};

use super::tables::share;

/// One case per line: the parameters whose intervals miss, and by how many standard errors.
pub(crate) fn line(case: &Case, outcome: &Outcome) -> String {
    if let Some(reason) = &outcome.failure {
        return format!("{case} -> failed: {reason}");
    }
    let missed = outcome.estimates.iter().filter(|e| !e.covered);
    let missed: Vec<String> =
        missed.map(|e| format!("{} {:+.1}", e.symbol, (e.value - e.truth) / e.std_error)).collect();
    format!("{case} -> missed: [{}], {:.1} s", missed.join(", "), outcome.seconds)
}

/// Coverage by effect: of a1..a5, of the effect's own parameters, and their scatter in standard errors.
pub(crate) fn print(rows: &[(Case, Outcome)]) {
    println!("\n## Coverage of the 95 % intervals with the effect in the model\n");
    println!(
        "| effect | sets | a1 | a2 | a3 | a4 | a5 | rms z | its own parameters | rms z |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    let groups = EFFECTS.map(|id| (id, vec![id])).into_iter().chain([("all", EFFECTS.to_vec())]);
    for (name, ids) in groups {
        let of = |case: &Case| matches!(&case.hidden[..], [one] if ids.contains(&one.as_str()));
        let own: Vec<&Outcome> =
            rows.iter().filter(|(c, o)| of(c) && o.failure.is_none()).map(|(_, o)| o).collect();
        if !own.is_empty() {
            println!("| {name} | {} | {} |", own.len(), cells(&own).join(" | "));
        }
    }
}

fn cells(group: &[&Outcome]) -> Vec<String> {
    let all: Vec<&Covered> = group.iter().flat_map(|o| &o.estimates).collect();
    let (base, own): (Vec<&Covered>, Vec<&Covered>) =
        all.iter().partition(|e| BASE.contains(&e.symbol.as_str()));
    let covered = |of: &[&Covered]| share(of.iter().filter(|e| e.covered).count(), of.len());
    let of_symbol = |symbol: &str| {
        let of: Vec<&Covered> = base.iter().filter(|e| e.symbol == symbol).copied().collect();
        covered(&of)
    };
    let mut out: Vec<String> = BASE.into_iter().map(of_symbol).collect();
    out.extend([scatter(&base), covered(&own), scatter(&own)]);
    out
}

/// Root mean square of (estimate - true value)/standard error.
fn scatter(estimates: &[&Covered]) -> String {
    let z: Vec<f64> = estimates
        .iter()
        .filter(|e| e.std_error > 0.0)
        .map(|e| (e.value - e.truth) / e.std_error)
        .collect();
    if z.is_empty() {
        return "-".into();
    }
    format!("{:.2}", (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt())
}
