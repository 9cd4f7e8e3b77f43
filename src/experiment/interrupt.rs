//! Message on Ctrl-C.

use std::path::Path;

use super::plan::Plan;

/// After this call, Ctrl-C prints which results of `plans` are kept in the folder `out` and ends the program
/// with the exit code of an interrupted command. No other action is needed: files are renamed only when they
/// are complete, and lines of a journal are written at once. On systems without signals the program ends
/// without a message.
pub fn say_on_interrupt(plans: &[Plan], out: &Path) {
    let words = words(plans, out);
    #[cfg(unix)]
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([signal_hook::consts::SIGINT]) {
        std::thread::spawn(move || {
            if signals.forever().next().is_some() {
                use std::io::Write as _;
                // the terminal may be closed
                let _ = writeln!(std::io::stderr(), "{words}");
                std::process::exit(INTERRUPTED);
            }
        });
    }
    #[cfg(not(unix))]
    drop(words);
}

/// Exit code of shells for a command ended by Ctrl-C: 128 plus the number of the signal.
#[cfg(unix)]
const INTERRUPTED: i32 = 128 + signal_hook::consts::SIGINT;

fn words(plans: &[Plan], out: &Path) -> String {
    let out = out.display();
    if plans.iter().any(|plan| plan.grid.is_some()) {
        format!(
            "interrupted: {out} keeps the finished combinations; the same command runs the others"
        )
    } else if plans.len() > 1 {
        format!(
            "interrupted: {out} keeps the finished experiments; run the files of the others again"
        )
    } else {
        format!("interrupted: nothing was written to {out}; the same command starts anew")
    }
}
