//! What a user reads is written in the field's words: the table of CONTRIBUTING.md, "Language".

use std::fs;
use std::path::{Path, PathBuf};

use amigo_ident::{effects, identify};

use crate::prose::prose;

/// Phrases that are refused, in lower case, and what is written instead. Words count as a whole.
const REFUSED: [(&str, &str); 83] = [
    ("missing moment", "residual torque"),
    ("missing moments", "residual torques"),
    ("motor moment", "motor torque"),
    ("recorded moment", "recorded torque"),
    ("recorded moments", "recorded torques"),
    ("noisy moments", "noisy torques"),
    ("exact moments", "exact torques"),
    ("made data", "synthetic data"),
    ("made recording", "simulated recording"),
    ("made recordings", "simulated recordings"),
    ("window error", "2 s simulation error"),
    ("window errors", "2 s simulation errors"),
    ("staircase", "error by model version"),
    ("holds the truth", "covers the true value"),
    ("hold the truth", "cover the true value"),
    ("known truth", "known parameters"),
    ("errs by", "has an RMS error of"),
    ("told apart", "distinguished"),
    ("tell them apart", "distinguish them"),
    ("strongest tie", "strongest correlation"),
    ("share their trail", "are correlated"),
    ("measuring noise", "measurement noise"),
    ("swallows", "absorbs"),
    ("takes up", "absorbs"),
    ("body behind the wheels", "two-mass drivetrain"),
    ("says nothing of", "… is not identifiable"),
    ("say nothing of", "… are not identifiable"),
    ("goes round once", "varies sinusoidally"),
    ("mend", "correct"),
    ("mended", "corrected"),
    ("lets nothing be found", "allows no effects"),
    ("are said in", "are declared in"),
    ("runs go on", "can be resumed"),
    ("is not settled", "did not converge"),
    ("has no remark", "no issues found"),
    ("wanders", "drifts"),
    ("stranger", "effect outside the catalogue"),
    ("twin", "equivalent effect"),
    ("hunch", "…"),
    ("recorded drive", "recorded input"),
    ("acting drive", "acting input"),
    ("of the drive", "of the input"),
    ("slow moment", "slow torque"),
    ("unknown moment", "unknown torque"),
    ("resisting moment", "resisting torque"),
    ("resisting moments", "resisting torques"),
    ("moment balance", "torque balance"),
    ("go round once", "vary sinusoidally"),
    ("this data cannot tell", "indistinguishable from these data"),
    ("the data cannot tell", "indistinguishable from these data"),
    ("drive unit", "unit of the input"),
    ("asleep", "negligible"),
    ("way of the robot", "robot path"),
    ("takes all out", "is efficient"),
    ("fall of bic", "ΔBIC"),
    ("explains all but", "removes … of the mean square error above the noise floor"),
    ("so many degrees of freedom", "the degrees of freedom listed"),
    ("by itself and starts from", "uses its own fit (initial error …)"),
    ("cannot give", "… is not identifiable"),
    ("beyond doubt", "significant"),
    ("speaks of", "mentions"),
    ("learned the hard way", "…"),
    ("said to be", "is ..., is reported as ..."),
    ("was said", "was reported"),
    ("over again", "again, from the start"),
    ("robot goes", "robot drives"),
    ("ride along", "are computed in the same pass"),
    ("taken for noise", "mistaken for noise"),
    ("in vain", "without result"),
    ("the cure", "the remedy"),
    ("hidden here", "hidden effects"),
    ("judge by", "held-out"),
    ("what the channels show", "the noise of the channels"),
    ("worth a word", "(leave out)"),
    ("hangs on", "depends on"),
    ("speak of", "mention"),
    ("what a reader must know", "(leave out)"),
    ("what is odd", "warnings"),
    ("made-up", "generated"),
    ("takes energy out", "dissipates energy"),
    ("single look", "single test"),
    ("single looks", "single tests"),
    ("asked of", "requested from"),
];

/// Words of persons, which methods, effects and parameters are not.
const PERSONAL: [(&str, &str); 21] = [
    ("know what", "cover, contain"),
    ("know it", "cover it"),
    ("does not know", "does not contain"),
    ("knows", "assumes"),
    ("believes", "assumes"),
    ("tells it from", "distinguishes it from"),
    ("tell it from", "distinguish it from"),
    ("tells the two", "distinguishes the two"),
    ("told from", "distinguished from"),
    ("tell apart", "distinguish"),
    ("pull of the noise", "bias by the noise"),
    ("sleeps", "has no effect"),
    ("wakes", "has an effect"),
    ("honest", "right"),
    ("nobody", "(passive)"),
    ("remembers", "stores, depends on the history of"),
    ("looks at", "evaluates"),
    ("wants", "requires"),
    ("gives way", "is replaced by"),
    ("believed", "assumed"),
    ("trusts", "uses"),
];

/// Files and folders whose text is checked; code is not, nor are keys.
const CHECKED: [&str; 18] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs",
    "experiments",
    "measured",
    "recordings",
    "benchmarks",
    "src",
    "examples",
    "benches",
    "tests",
    "python/src",
    "python/amigo_ident",
    "python/README.md",
    "schemas",
    "CITATION.cff",
];

/// Where the refused phrases themselves stand.
const EXEMPT: &str = "tests/it/language.rs";

fn texts(path: &Path, out: &mut Vec<PathBuf>) {
    if path.is_dir() {
        let mut entries: Vec<_> = fs::read_dir(path).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        entries.iter().for_each(|entry| texts(entry, out));
    } else if path.extension().is_some_and(|e| {
        ["md", "toml", "rs", "py", "pyi", "json", "c", "m", "mo", "js", "java", "cff"]
            .iter()
            .any(|known| e == *known)
    }) {
        out.push(path.to_path_buf());
    }
}

/// The refused phrases of a text, with their replacements.
fn refused(text: &str) -> Vec<String> {
    refused_of(&REFUSED, text)
}

/// The same with words of persons.
fn refused_with_personal(text: &str) -> Vec<String> {
    [refused(text), refused_of(&PERSONAL, text)].concat()
}

fn refused_of(phrases: &[(&str, &str)], text: &str) -> Vec<String> {
    let text = text.to_lowercase();
    let letter = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    let whole = |(at, word): (usize, &str)| {
        !letter(text[..at].chars().last()) && !letter(text[at + word.len()..].chars().next())
    };
    let found = phrases.iter().filter(|(phrase, _)| text.match_indices(phrase).any(whole));
    found.map(|(phrase, instead)| format!("\"{phrase}\": write \"{instead}\"")).collect()
}

#[test]
fn pages_experiment_files_and_sources_use_the_words_of_the_field() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    CHECKED.iter().for_each(|name| texts(&root.join(name), &mut paths));
    let mut wrong = Vec::new();
    for path in paths.iter().filter(|path| !path.ends_with(EXEMPT)) {
        let text = fs::read_to_string(path).unwrap();
        for (number, line) in prose(path, &text) {
            let shown = path.strip_prefix(root).unwrap().display();
            wrong.extend(
                refused_with_personal(&line).into_iter().map(|r| format!("{shown}:{number}: {r}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_catalogues_use_the_words_of_the_field() {
    let mut wrong = Vec::new();
    for effect in effects::all() {
        let text = effects::details(&effect.id()).unwrap();
        wrong.extend(
            refused_with_personal(&text).into_iter().map(|r| format!("{}: {r}", effect.id())),
        );
    }
    for method in identify::all() {
        let name = method.describe().name;
        let text = identify::details(&name).unwrap();
        wrong.extend(refused_with_personal(&text).into_iter().map(|r| format!("{name}: {r}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_refused_phrase_is_seen_as_a_whole_word_only() {
    assert_eq!(refused("The Missing moment").len(), 1);
    assert!(refused("a recommendation, twinned").is_empty());
}

/// The name of the item that a line of code declares, word by word.
fn name_of(line: &str) -> Vec<String> {
    const KEYWORDS: [&str; 8] = ["const", "fn", "struct", "enum", "trait", "type", "mod", "static"];
    let visible = line.trim().trim_start_matches("pub(crate) ").trim_start_matches("pub(super) ");
    let mut words =
        visible.trim_start_matches("pub ").split(|c: char| !c.is_alphanumeric() && c != '_');
    let name = words.find(|word| !KEYWORDS.contains(word)).unwrap_or_default();
    let mut out = vec![String::new()];
    for c in name.chars() {
        if c == '_' || c.is_uppercase() {
            out.push(String::new());
        }
        if let Some(word) = out.last_mut().filter(|_| c != '_') {
            word.extend(c.to_lowercase());
        }
    }
    out
}

#[test]
fn doc_comments_say_more_than_the_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    texts(&root.join("src"), &mut paths);
    let mut wrong = Vec::new();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|e| e == "rs")) {
        let text = fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let doc = |n: usize| lines.get(n).and_then(|line| line.trim().strip_prefix("/// "));
        for n in 0..lines.len() {
            let Some(one) =
                doc(n).filter(|_| doc(n + 1).is_none() && (n == 0 || doc(n - 1).is_none()))
            else {
                continue;
            };
            // a unit or a formula is no repetition
            if one.contains(['[', '`']) {
                continue;
            }
            let code = lines[n + 1..].iter().find(|line| !line.trim_start().starts_with("#["));
            let name = code.map_or(vec![], |line| name_of(line));
            let said: Vec<String> = one
                .split(|c: char| !c.is_alphanumeric())
                .map(str::to_lowercase)
                .filter(|word| !["", "a", "an", "the", "its"].contains(&word.as_str()))
                .collect();
            let is_in_name = |word: &String| {
                name.iter().any(|w| {
                    w == word || word.trim_end_matches('s') == w || w.trim_end_matches('s') == word
                })
            };
            if !said.is_empty() && said.iter().all(is_in_name) {
                wrong.push(format!(
                    "{}:{}: {one}",
                    path.strip_prefix(root).unwrap().display(),
                    n + 1
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{} comments:\n{}", wrong.len(), wrong.join("\n"));
}
