//! The methods as text for a terminal.

use std::fmt::Write as _;

/// One line a method.
#[must_use]
pub fn overview() -> String {
    let methods: Vec<_> = super::all().iter().map(|m| m.describe()).collect();
    let width = methods.iter().map(|m| m.name.len()).max().unwrap_or(0);
    let mut out = String::new();
    for m in methods {
        let _ = writeln!(out, "{:<width$}  {}", m.name, m.title);
    }
    out.push_str("\n`experiment methods METHOD` describes one.\n");
    out
}

/// Everything about one method; `None` if there is no such method.
#[must_use]
pub fn details(name: &str) -> Option<String> {
    let method = super::find(name)?;
    let (m, options) = (method.describe(), method.options());
    let mut out = format!("{}: {}\n\n  {}\n\n", m.name, m.title, m.equation);
    let _ = writeln!(out, "source      {}", m.source);
    let _ = writeln!(out, "use         {}", m.use_when);
    let _ = writeln!(out, "avoid if    {}", m.avoid_when);
    if method.intervals_cover() {
        out.push_str("intervals   cover the true value at their rate, at ordinary noise\n");
    }
    if !options.is_empty() {
        let _ = writeln!(out, "\noptions of its [[method]] block:");
        let width = options.iter().map(|o| o.key.len()).max().unwrap_or(0);
        for option in &options {
            let (key, meaning, default) = (&option.key, &option.meaning, &option.default);
            let _ = writeln!(out, "  {key:<width$}  {meaning} (default {default})");
        }
    }
    Some(out)
}
