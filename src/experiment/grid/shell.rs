//! Quoting of shell commands.

use crate::experiment::combinations::GridPlan;
use crate::experiment::options::RunOptions;

/// The command line for `what` with the file of a grid, quoted for a shell.
pub(super) fn command(what: &str, grid: &GridPlan, options: &RunOptions) -> String {
    let out = quoted(&options.out.display().to_string());
    let set: String = options.set.iter().map(|s| format!(" --set {}", quoted(s))).collect();
    let file = quoted(&grid.path.display().to_string());
    format!("experiment {what} --out {out}{set} {file}")
}

/// A word, quoted if a shell requires it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-+./=,:@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.into();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_command_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("out/a-1.toml"), "out/a-1.toml");
        assert_eq!(quoted("title=\"it's\""), "'title=\"it'\\''s\"'");
    }
}
