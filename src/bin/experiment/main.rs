//! The command line: parses arguments, calls the library and prints; it computes nothing.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod arguments;

use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;

use amigo_ident::catalogue::nearest;
use amigo_ident::experiment::{self, Done, Outcome, Plan, RunOptions};
use amigo_ident::{effects, identify};
use clap::{CommandFactory, Parser};
use clap_mangen::Man;
use rayon::prelude::*;

use self::arguments::{Cli, Command, EXIT, Run, START, Threads};

/// Wrong usage, file or data.
const WRONG: u8 = 2;
/// An experiment failed.
const FAILED: u8 = 1;

fn main() -> ExitCode {
    silence_the_parquet_reader();
    let cli = Cli::parse();
    if let Err(wrong) = cli.threads().map_or(Ok(()), Threads::limit) {
        eprintln!("error: {wrong}");
        return ExitCode::from(WRONG);
    }
    match cli.command {
        None => run(&cli.run),
        Some(Command::Run(arguments)) => run(&arguments),
        Some(Command::New { recordings, output }) => {
            print_or_complain(experiment::new_file(&recordings, output.as_deref()))
        }
        Some(Command::Add { effect, file, out, .. }) => {
            print_or_complain(experiment::add_effect(&effect, &file, &out))
        }
        Some(Command::Export { file, to, out, set }) => {
            print_or_complain(experiment::export(&file, &to, &out, &set))
        }
        Some(Command::Merge { files, out, set, quiet, .. }) => merge(
            &files,
            &RunOptions { out, set, resume: true, shard: None, progress: false },
            quiet,
        ),
        Some(Command::Check { files, set, .. }) => check(&files, &set),
        Some(Command::Effects { effect: None }) => print(&effects::overview()),
        Some(Command::Effects { effect: Some(id) }) => {
            let ids = effects::all().iter().map(|e| e.id()).collect();
            print_or_unknown(effects::details(&id), "effect", &id, ids)
        }
        Some(Command::Methods { method: None }) => print(&identify::overview()),
        Some(Command::Methods { method: Some(name) }) => {
            let names = identify::all().iter().map(|m| m.describe().name).collect();
            print_or_unknown(identify::details(&name), "method", &name, names)
        }
        Some(Command::Schema) => print(&experiment::json_schema()),
        Some(Command::Man) => manual(),
        Some(Command::Completions { shell }) => {
            let mut command = Cli::command();
            clap_complete::generate(shell, &mut command, "experiment", &mut std::io::stdout());
            ExitCode::SUCCESS
        }
    }
}

/// Text for a terminal: names come from files, and control characters in them must not be executed.
fn printable(text: &str) -> String {
    let strange = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.replace(strange, "\u{fffd}")
}

/// A damaged Parquet file can make its reader panic in its own threads; the panic is caught and returned as
/// an error, so its own message is suppressed.
fn silence_the_parquet_reader() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let place = panic.location().map_or("", |location| location.file());
        let thread = std::thread::current();
        if !place.contains("polars") && !thread.name().is_some_and(|n| n.starts_with("polars")) {
            usual(panic);
        }
    }));
}

fn print(text: &str) -> ExitCode {
    // a closed pipe (| head) is not an error
    let _ = std::io::Write::write_all(&mut std::io::stdout(), printable(text).as_bytes());
    ExitCode::SUCCESS
}

/// The manual page, with a section for every command.
fn manual() -> ExitCode {
    let text = |write: &dyn Fn(&mut Vec<u8>) -> std::io::Result<()>| {
        let mut out = vec![];
        let _ = write(&mut out); // a vector takes all that is written
        String::from_utf8_lossy(&out).into_owned()
    };
    let sections = |of: &Man| {
        text(&|out| of.render_synopsis_section(out).and_then(|()| of.render_options_section(out)))
    };
    let headed = |head: &str, body: &str| format!(".SH \"{head}\"\n{body}\n").replace('-', "\\-");
    let main = Cli::command();
    let whole = Man::new(main.clone());
    let mut page =
        text(&|out| whole.render_title(out).and_then(|()| whole.render_name_section(out)));
    page += &(sections(&whole) + &headed("EXAMPLE", START) + &headed("EXIT STATUS", EXIT));
    for command in main.get_subcommands().filter(|c| c.get_name() != "help") {
        let name = format!("experiment {}", command.get_name());
        page += &headed(&name, &command.get_about().map(ToString::to_string).unwrap_or_default());
        page += &sections(&Man::new(command.clone().bin_name(name))).replace(".SH ", ".SS ");
    }
    print(&page)
}

fn print_or_complain(result: Result<String, experiment::ExperimentError>) -> ExitCode {
    match result {
        Ok(text) => print(&text),
        Err(e) => complain(&e),
    }
}

fn complain(e: &experiment::ExperimentError) -> ExitCode {
    eprintln!("error: {}", printable(&e.to_string()));
    ExitCode::from(if e.is_wrong_input() { WRONG } else { FAILED })
}

fn print_or_unknown(text: Option<String>, kind: &str, name: &str, known: Vec<String>) -> ExitCode {
    if let Some(text) = text {
        return print(&text);
    }
    let hint = nearest(name, known.iter().map(String::as_str));
    let hint = hint.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
    eprintln!("error: no {kind} is called `{name}`{hint}\n`experiment {kind}s` lists them");
    ExitCode::from(WRONG)
}

fn check(files: &[PathBuf], set: &[String]) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for checked in experiment::check(files, set) {
        match checked {
            Ok(text) => drop(print(&text)),
            Err(e) => code = complain(&e),
        }
    }
    code
}

fn merge(files: &[PathBuf], options: &RunOptions, quiet: bool) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in files {
        let joined = experiment::load(file, &options.set).and_then(|plan| {
            let name = plan.name.clone();
            let done = experiment::merge(plan, options).result?;
            experiment::write_index(&[], &options.out)?;
            Ok((name, done))
        });
        match joined {
            Ok((name, done)) if !quiet => say(&name, &done),
            Ok(_) => {}
            Err(e) => code = complain(&e),
        }
    }
    code
}

fn say(name: &str, done: &Done) {
    let contradictions: String = done.contradictions.iter().map(|c| format!("    {c}\n")).collect();
    print(&format!("{name}: {}\n{contradictions}    {}\n", done.verdict, done.report.display()));
}

fn run(run: &Run) -> ExitCode {
    if run.files.is_empty() {
        let _ = Cli::command().print_help();
        return ExitCode::from(WRONG);
    }
    if let Some(hint) = misspelt(&run.files) {
        eprintln!("error: {}", printable(&hint));
        return ExitCode::from(WRONG);
    }
    let mut files = run.files.clone();
    if let Some(output) = &run.output {
        // the file is written first, so that it is the one that runs
        if let Err(e) = experiment::new_file(&files, Some(output)) {
            return complain(&e);
        }
        files = vec![output.clone()];
    }
    let options = RunOptions {
        out: run.out.clone(),
        set: run.set.clone(),
        resume: run.resume,
        shard: run.shard,
        progress: !run.quiet && std::io::stderr().is_terminal(),
    };
    let plans = match experiment::load_all(&files, &options) {
        Ok(plans) => plans,
        Err(errors) => {
            for e in &errors {
                complain(e);
            }
            return ExitCode::from(WRONG);
        }
    };
    execute(plans, run, &options)
}

fn execute(plans: Vec<Plan>, run: &Run, options: &RunOptions) -> ExitCode {
    warn(&plans, run.quiet);
    experiment::say_on_interrupt(&plans, &options.out);
    let outcomes: Vec<Outcome> =
        plans.into_par_iter().map(|plan| experiment::execute(plan, options)).collect();
    let index = run.shard.is_none().then(|| experiment::write_index(&outcomes, &options.out));
    report(&outcomes, run.quiet);
    if let Some(Err(e)) = index {
        return complain(&e);
    }
    let failed = outcomes.iter().filter(|o| o.result.is_err()).count();
    ExitCode::from(if failed > 0 { FAILED } else { 0 })
}

/// A command that was probably meant by a first argument that is not an existing file.
fn misspelt(files: &[PathBuf]) -> Option<String> {
    let first = files.first().filter(|f| !f.exists() && f.extension().is_none())?;
    let word = first.to_str()?;
    let commands: Vec<String> =
        Cli::command().get_subcommands().map(|c| c.get_name().to_string()).collect();
    if commands.iter().any(|command| command == word) {
        return Some(command_behind_options(word));
    }
    let near = nearest(word, commands.iter().map(String::as_str));
    let hint = near.map_or(String::new(), |n| format!("; did you mean `experiment {n}`?"));
    Some(format!(
        "`{word}` is neither a command nor a file{hint} (`experiment --help` lists the commands)"
    ))
}

/// The error for options before a command, with the same arguments in their order.
fn command_behind_options(command: &str) -> String {
    let mut others: Vec<String> = std::env::args().skip(1).collect();
    if let Some(place) = others.iter().position(|argument| argument == command) {
        others.remove(place);
    }
    let line = others.join(" ");
    format!("options follow their command: write `experiment {command} {line}`")
}

/// Prints warnings on the files and their recordings.
fn warn(plans: &[Plan], quiet: bool) {
    for plan in plans.iter().filter(|_| !quiet) {
        for words in plan.warnings() {
            eprintln!("warning: {}", printable(&format!("{}: {words}", plan.name)));
        }
    }
}

/// Prints one short verdict per experiment, and the failures.
fn report(outcomes: &[Outcome], quiet: bool) {
    for outcome in outcomes {
        match &outcome.result {
            Ok(done) if !quiet => say(&outcome.name, done),
            Ok(_) => {}
            Err(e) => eprintln!("error: {}", printable(&format!("{}: {e}", outcome.name))),
        }
    }
    let failed: Vec<&str> =
        outcomes.iter().filter(|o| o.result.is_err()).map(|o| o.name.as_str()).collect();
    if !failed.is_empty() {
        eprintln!(
            "{} of {} experiments failed: {}",
            failed.len(),
            outcomes.len(),
            printable(&failed.join(", "))
        );
    }
}
