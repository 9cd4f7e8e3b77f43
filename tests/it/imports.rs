//! Which files import which, read from the sources, and the rings among them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Every source file with its path from the root, and its text before the tests.
pub(crate) fn files() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    sources(&root.join("src"), &mut paths);
    paths
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            let text = fs::read_to_string(&path).unwrap();
            (name, without_tests(&text))
        })
        .filter(|(name, _)| !is_test(name))
        .collect()
}

/// Files that are compiled for tests only.
fn is_test(name: &str) -> bool {
    let ends = ["/tests.rs", "/contract.rs", "/independent.rs", "_tests.rs"];
    ends.iter().any(|end| name.ends_with(end)) || name.contains("/tests/")
}

/// The code without the items that are compiled for tests only. An item ends with the first line of its own depth
/// that closes it.
fn without_tests(text: &str) -> String {
    let depth = |line: &str| line.len() - line.trim_start().len();
    let mut skipped = None;
    let mut out = String::new();
    for line in text.lines() {
        match skipped {
            None if line.trim() == "#[cfg(test)]" => skipped = Some(depth(line)),
            None => {
                out.push_str(line);
                out.push('\n');
            }
            Some(own) if depth(line) == own && line.ends_with([';', '}']) => skipped = None,
            Some(_) => {}
        }
    }
    out
}

/// The files of the crate by module path (`a::b`), and which names a module re-exports from where.
struct Tree {
    files: BTreeMap<String, String>,
    reexports: BTreeMap<(String, String), String>,
}

impl Tree {
    fn new(files: &[(String, String)]) -> Self {
        let mut out = Self { files: BTreeMap::new(), reexports: BTreeMap::new() };
        for (name, _) in files {
            out.files.insert(path_of(name), name.clone());
        }
        for (name, code) in files {
            let own = path_of(name);
            for (public, path) in uses(code) {
                let full = absolute(&own, &path);
                if public && let Some((_, item)) = full.rsplit_once("::") {
                    out.reexports.insert((own.clone(), item.to_owned()), full.clone());
                }
            }
            // `catalogue!` declares and re-exports `module::Item`
            let lines = code.split("catalogue! {").nth(1).and_then(|l| l.split('}').next());
            for entry in lines.unwrap_or_default().split(',').map(str::trim) {
                if let Some((module, item)) = entry.split_once("::") {
                    let key = (own.clone(), item.to_owned());
                    out.reexports.insert(key, format!("{own}::{module}::{item}"));
                }
            }
        }
        out
    }

    /// The file in which the last name of a path is defined, re-exports followed.
    fn file(&self, path: &str) -> Option<&String> {
        if let Some(file) = self.files.get(path) {
            return Some(file);
        }
        let (module, item) = path.rsplit_once("::")?;
        match self.reexports.get(&(module.to_owned(), item.to_owned())) {
            Some(further) if further != path => self.file(further),
            _ => self.file(module),
        }
    }
}

/// `a::b` of `src/a/b.rs` and of `src/a/b/mod.rs`.
fn path_of(name: &str) -> String {
    let inner = name.trim_start_matches("src/").trim_end_matches(".rs");
    inner.trim_end_matches("/mod").replace('/', "::")
}

/// Every path of the `use` lines of a file, groups taken apart; whether it is public.
fn uses(code: &str) -> Vec<(bool, String)> {
    let mut out = Vec::new();
    for line in code.split(';') {
        let line = line.rsplit_once("\n\n").map_or(line, |(_, last)| last);
        let line: Vec<&str> =
            line.lines().filter(|l| !l.trim_start().starts_with("//")).map(str::trim).collect();
        let joined = line.join(" ");
        let line = joined.trim();
        for (start, public) in [
            ("pub use ", true),
            ("pub(super) use ", true),
            ("pub(crate) use ", true),
            ("use ", false),
        ] {
            if let Some(rest) = line.strip_prefix(start) {
                expand("", rest.trim(), &mut |path| out.push((public, path)));
            }
        }
        out.extend(written_out(line).into_iter().map(|path| (false, path)));
    }
    out
}

/// Paths through `super` or `crate` within the code of a statement.
fn written_out(line: &str) -> Vec<String> {
    let is_path = |c: &char| c.is_alphanumeric() || matches!(c, '_' | ':');
    let starts = ["super::", "crate::"].into_iter().flat_map(|word| line.match_indices(word));
    // `pub(in crate::a)` says who may see an item
    let starts = starts.filter(|(at, _)| !line[..*at].ends_with("pub(in "));
    let starts = starts.filter(|(at, _)| *at == 0 || !line[..*at].ends_with(|c: char| is_path(&c)));
    starts.map(|(at, _)| line[at..].chars().take_while(is_path).collect()).collect()
}

fn expand(before: &str, rest: &str, found: &mut impl FnMut(String)) {
    let Some((head, group)) = rest.split_once('{') else {
        let name = rest.split(" as ").next().unwrap_or_default().trim();
        return found(format!(
            "{before}{}",
            name.trim_end_matches("::self").trim_end_matches("::*")
        ));
    };
    let group = group.trim_end().trim_end_matches('}');
    let (mut depth, mut part) = (0, String::new());
    let mut parts = Vec::new();
    for c in group.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            parts.push(std::mem::take(&mut part));
        } else {
            part.push(c);
        }
    }
    parts.push(part);
    for part in parts.iter().map(|p| p.trim()).filter(|p| !p.is_empty()) {
        let before = format!("{before}{head}");
        match part {
            "self" => found(before.trim_end_matches("::").to_owned()),
            _ => expand(&before, part, found),
        }
    }
}

/// `super` and `crate` resolved from the module `own`; what is neither is a child of it.
fn absolute(own: &str, path: &str) -> String {
    let (mut base, mut rest) = (own.to_owned(), path);
    if let Some(inner) = rest.strip_prefix("crate::") {
        return inner.to_owned();
    }
    rest = rest.strip_prefix("self::").unwrap_or(rest);
    while let Some(inner) = rest.strip_prefix("super::") {
        base = base.rsplit_once("::").map_or(String::new(), |(parent, _)| parent.to_owned());
        rest = inner;
    }
    if base.is_empty() { rest.to_owned() } else { format!("{base}::{rest}") }
}

/// Files that each file imports from. What a file re-exports of its own children is not an import.
pub(crate) fn edges(files: &[(String, String)]) -> BTreeMap<String, BTreeSet<String>> {
    let tree = Tree::new(files);
    let mut out = BTreeMap::new();
    for (name, code) in files {
        let own = path_of(name);
        let targets = uses(code)
            .into_iter()
            .filter_map(|(public, path)| Some((public, tree.file(&absolute(&own, &path))?)))
            .filter(|(public, target)| {
                let is_child = path_of(target).starts_with(&format!("{own}::"));
                *target != name && !(*public && is_child)
            })
            .map(|(_, target)| target.clone())
            .collect();
        out.insert(name.clone(), targets);
    }
    out
}

/// Groups of files that reach each other, in alphabetical order.
pub(crate) fn rings(edges: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let reach = |from: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(file) = open.pop() {
            for next in edges.get(file).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    open.push(next);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&String, BTreeSet<String>> =
        edges.keys().map(|file| (file, reach(file))).collect();
    let ring = |file: &String| -> Option<String> {
        let mates: Vec<&str> = reached[file]
            .iter()
            .filter(|other| reached.get(other).is_some_and(|back| back.contains(file)))
            .map(String::as_str)
            .collect();
        (mates.len() > 1).then(|| mates.join(" "))
    };
    edges.keys().filter_map(ring).collect::<BTreeSet<_>>().into_iter().collect()
}

#[test]
fn a_ring_of_files_is_seen_through_a_re_export() {
    let file = |name: &str, code: &str| (name.to_owned(), code.to_owned());
    let files = [
        file("src/a/mod.rs", "mod b;\nmod c;\npub use c::{C, Other};\n"),
        file("src/a/b.rs", "use super::{C};\nuse crate::math::x;\n"),
        file("src/a/c.rs", "use super::b::{self, f};\n"),
        file("src/math.rs", ""),
    ];
    assert_eq!(rings(&edges(&files)), ["src/a/b.rs src/a/c.rs"]);
}

#[test]
fn a_ring_of_files_is_seen_through_a_path_within_the_code() {
    let file = |name: &str, code: &str| (name.to_owned(), code.to_owned());
    let files = [
        file("src/a/mod.rs", "mod b;\nmod c;\n"),
        file("src/a/b.rs", "use super::c::C;\n"),
        file(
            "src/a/c.rs",
            "fn f() {\n    let x = Some(super::b::LIMIT);\n    g(crate::d::X);\n}\n",
        ),
        file("src/d.rs", "use crate::a::b::B;\n"),
    ];
    assert_eq!(rings(&edges(&files)), ["src/a/b.rs src/a/c.rs src/d.rs"]);
}

#[test]
fn a_parent_that_uses_a_child_which_uses_it_is_a_ring_and_one_that_re_exports_it_is_none() {
    let file = |name: &str, code: &str| (name.to_owned(), code.to_owned());
    let child = || file("src/a/b.rs", "use super::{Limit};\npub(in crate::a) struct B;\n");
    let uses = [file("src/a.rs", "mod b;\nuse self::b::B;\nstruct Limit;\n"), child()];
    assert_eq!(rings(&edges(&uses)), ["src/a.rs src/a/b.rs"]);
    let lists = [file("src/a.rs", "mod b;\npub use self::b::B;\nstruct Limit;\n"), child()];
    assert!(rings(&edges(&lists)).is_empty());
}

#[test]
fn items_for_tests_alone_are_left_out_and_what_follows_them_is_not() {
    let code = "#[cfg(test)]\nmod reference;\nmod a;\nimpl A {\n    #[cfg(test)]\n    fn f() {\n        g();\n    }\n    \
                fn h() {}\n}\n#[cfg(test)]\n#[path = \"b_tests.rs\"]\nmod tests;\n";
    assert_eq!(without_tests(code), "mod a;\nimpl A {\n    fn h() {}\n}\n");
}
