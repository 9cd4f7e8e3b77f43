//! The words of a page, and the index.

use std::fmt::Write;

use amigo_ident::effects::{self, Description, Energy};
use amigo_ident::report::format;

use crate::Failure;
use crate::cases::Case;
use crate::work::{METHOD, NOISE, Outcome, is_base};

const COMMAND: &str = "cargo run --release --example effect_pages";

/// The table of all effects.
pub(crate) fn index() -> String {
    let mut out = format!(
        "# The effects of the catalogue\n\n\
         What each effect looks like in a recording, and what to drive to see it. A page shows the \
         torque that a model without the effect misses, in simulated recordings in which it is hidden. \
         `experiment effects ID` prints the short form. The pages are written by the program:\n\n\
         ```sh\n{COMMAND}\n```\n\n\
         | effect | | what it looks like | what to drive |\n|---|---|---|---|\n"
    );
    for effect in effects::all() {
        let Description { id, title, signature, excitation, .. } = effect.description();
        let _ = writeln!(out, "| [`{id}`]({id}.md) | {title} | {signature} | {excitation} |");
    }
    out
}

/// The page of one effect.
pub(crate) fn page(case: &Case, outcome: &Outcome) -> Result<String, Failure> {
    let effect = effects::find(case.id).ok_or("the case is of a registered effect")?;
    let d = effect.description();
    let mut out = format!("# {} (`{}`)\n\n```text\n{}\n```\n\n", d.title, d.id, d.equation);
    out += &kind(case.id, effect.energy(), effect.acts_on_input());
    out += &parameters(effect.as_ref(), outcome);
    let _ = writeln!(out, "![{}]({}.png)\n", alternative(case), d.id);
    out += &reading(case, outcome);
    for (heading, text) in [
        ("Cause", &d.cause),
        ("How it shows in data", &d.signature),
        ("What to drive to see it", &d.excitation),
    ] {
        let _ = writeln!(out, "## {heading}\n\n{}\n", sentence(text));
    }
    out += &confused(case, &d, outcome);
    out += &cure(case, outcome);
    out += &conditions(case);
    Ok(out)
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

fn kind(id: &str, energy: Energy, acts_on_input: bool) -> String {
    let side = if acts_on_input {
        "It changes the recorded torque before the equation of motion"
    } else {
        "It stands on the side of the resistances, against the torque of the input"
    };
    let energy = match energy {
        Energy::Stores => "stores energy and gives it back",
        Energy::DoesNoWork => "does no work",
        Energy::Dissipates => "takes energy out",
        Energy::Supplies => "may put energy in",
    };
    let base = if is_base(id) { "It is part of every model. " } else { "" };
    format!("{base}{side}, and {energy}.\n\n")
}

fn parameters(effect: &dyn effects::Effect, outcome: &Outcome) -> String {
    let mut out = "| parameter | meaning | unit | range | hidden here | found |\n\
                   |---|---|---|---|---|---|\n"
        .to_owned();
    for (spec, hidden) in effect.parameters().iter().zip(&outcome.hidden) {
        let found = outcome.fit.estimate(&spec.symbol);
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} to {} | {} | {} |",
            spec.symbol,
            spec.meaning,
            if spec.unit.is_empty() { "1" } else { &spec.unit },
            format::number(spec.range.0),
            format::number(spec.range.1),
            format::number(*hidden),
            found.map_or(String::new(), |e| format::estimate(e.value, e.std_error)),
        );
    }
    out + "\n"
}

fn alternative(case: &Case) -> String {
    match case.against {
        Some(variable) => format!("Residual torque against the {}", variable.words()),
        None => "Measured speed, and its error without and with the effect".into(),
    }
}

fn reading(case: &Case, outcome: &Outcome) -> String {
    let strongest: Vec<String> = outcome.dependences[..3]
        .iter()
        .map(|d| format!("{} ({:.0})", d.variable.words(), d.log_significance))
        .collect();
    let strongest = strongest.join(", ");
    let reading = case.reading;
    if case.against.is_some() {
        format!(
            "{reading}\n\nThe residual torque is what would have to be added to the recorded \
             torque, so that a resistance shows with the sign against the motion. What the fitted \
             parameters can absorb is not in it. It depends most clearly on (-ln p): \
             {strongest}.\n\n"
        )
    } else {
        format!(
            "{reading}\n\nThe upper panel is the measured speed, the lower one its error (mean \
             over nine samples) in a simulation from the start of the window, in the window of 2 s \
             in which the effect helps most. For comparison, the residual torque \
             depends most clearly on (-ln p): {strongest}.\n\n"
        )
    }
}

fn link(id: &str) -> String {
    format!("[`{id}`]({id}.md)")
}

fn links(ids: &[String]) -> String {
    ids.iter().map(|id| link(id)).collect::<Vec<_>>().join(", ")
}

fn confused(case: &Case, d: &Description, outcome: &Outcome) -> String {
    let mut out = "## What it is confused with\n\n".to_owned();
    if !d.equivalent.is_empty() {
        let twins = links(&d.equivalent);
        let _ = writeln!(
            out,
            "By its equations it is {twins} over again: no recording of the \
                               wheels distinguishes them.\n"
        );
    }
    let found = outcome.diagnosis.found();
    let near: Vec<String> =
        outcome.diagnosis.steps.iter().flat_map(|step| step.equals.clone()).collect();
    let near: Vec<String> = near.into_iter().filter(|id| !d.equivalent.contains(id)).collect();
    let named = match found.first() {
        Some(id) => format!("names {}", link(id)),
        None => "names nothing".to_owned(),
    };
    let right = found.first().is_some_and(|id| *id == case.id || d.equivalent.contains(id));
    let tried = outcome.diagnosis.ranking.iter().any(|r| r.candidate.id == case.id);
    let _ = write!(out, "The diagnosis of these recordings {named}");
    let _ = match (near.is_empty(), found.is_empty()) {
        (false, _) => {
            writeln!(out, ", and does not distinguish it from {} (ΔBIC below 6).", links(&near))
        }
        (true, false) => writeln!(out, "; nothing else comes within a ΔBIC of 6."),
        (true, true) => writeln!(out, "."),
    };
    if is_base(case.id) {
        out += "It never tries parameters that the file holds, so this is not the cause here: \
                look at `[model] fixed` first.\n";
    } else if !tried && !right {
        let _ = writeln!(out, "It does not try `{}`, so this is not the cause here.", case.id);
    }
    let ranked = outcome.diagnosis.ranking.iter();
    let ranked: Vec<_> = ranked.filter(|r| r.refit.is_some() && r.bic < 0.0).take(4).collect();
    if !ranked.is_empty() {
        out += "\n| candidate | ΔBIC |\n|---|---|\n";
    }
    for ranked in ranked {
        let _ = writeln!(out, "| {} | {:.0} |", link(&ranked.candidate.id), -ranked.bic);
    }
    out + "\n"
}

fn cure(case: &Case, outcome: &Outcome) -> String {
    let id = case.id;
    let held: Vec<&str> = case.held.iter().map(|(symbol, _)| *symbol).collect();
    let mut out = "## The cure\n\n".to_owned();
    if is_base(id) {
        let held = held.join("` and `");
        let _ = writeln!(out, "Every model has it. Take `{held}` out of `[model] fixed`.\n");
    } else {
        let _ = writeln!(out, "```sh\nexperiment add {id} my.toml\n```\n");
    }
    if !is_base(id) && !held.is_empty() {
        out += "The file must hold the inertias, or it changes nothing:\n\n\
                ```toml\n[model]\nfixed = { a1 = \"construction\", a2 = \"construction\" }\n```\n\n";
    }
    let number = |value| format::significant(value, 3);
    let [before, after] = outcome.error;
    let _ = writeln!(
        out,
        "| 2 s simulation error on a recording held out | [rad/s] |\n|---|---|\n| without the effect | {} \
         |\n| with it | {} |\n| noise floor | {} |\n",
        number(before),
        number(after),
        number(outcome.floor)
    );
    for (spec, hidden) in own(case).iter().zip(&outcome.hidden) {
        let Some(found) = outcome.fit.estimate(&spec.symbol) else { continue };
        let away = (found.value - hidden).abs() / found.std_error;
        if away.is_finite() && away > 4.0 {
            let symbol = &spec.symbol;
            let _ = writeln!(
                out,
                "`{symbol}` lies {away:.0} of its standard errors from the \
                                   hidden value: do not trust its interval.\n"
            );
        }
    }
    out
}

fn own(case: &Case) -> Vec<effects::ParameterSpec> {
    effects::find(case.id).map_or_else(Vec::new, |effect| effect.parameters())
}

fn conditions(case: &Case) -> String {
    let hard = if case.hard { " with hard starts and brakes" } else { "" };
    let held: Vec<String> = case
        .held
        .iter()
        .map(|(symbol, share)| match share {
            0.0 => format!("`{symbol}` is held at zero"),
            _ => format!("`{symbol}` is held at its construction value"),
        })
        .collect();
    let held = if held.is_empty() { "".into() } else { format!("; {}", held.join(" and ")) };
    format!(
        "## Where the numbers come from\n\nFour recordings of 25 s at 100 Hz{hard}, made with the \
         effect at the sizes above under a speed controller, and a fifth to judge by; noise {} \
         rad/s in the speeds, {} rad in the angles, {} N m in the torques. Both models are fitted \
         by `{}`{held}; picture and diagnosis are of the model without the effect, by the filter. \
         Repeat:\n\n```sh\n{COMMAND} -- --only {}\n```\n\n[All effects](README.md)\n",
        NOISE.dalpha, NOISE.alpha, NOISE.torque, METHOD, case.id
    )
}
