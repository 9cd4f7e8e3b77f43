//! Commands and options.

use std::path::PathBuf;

use amigo_ident::experiment::{ExportFormat, Shard};
use clap::{Parser, Subcommand};

/// What a user types first.
pub(crate) const START: &str = "experiment new LOG.csv -o my.toml; experiment my.toml";
/// What the exit codes mean.
pub(crate) const EXIT: &str = "0 done, 1 an experiment failed, 2 wrong usage, file or data";

/// Identify a two-wheel robot from its logs, see where the model fails, and learn which physical
/// effect is missing.
#[derive(Parser)]
#[command(name = "experiment", version, args_conflicts_with_subcommands = true)]
#[command(after_help = format!("Start with: {START}\nExit codes: {EXIT}"))]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) run: Run,
}

#[derive(clap::Args)]
pub(crate) struct Run {
    /// Experiment files to run, or recordings, which are run as one experiment with the settings that `new` writes.
    #[arg(value_name = "FILE.toml | RECORDING")]
    pub(crate) files: Vec<PathBuf>,
    /// With recordings: write the experiment file that is run.
    #[arg(short, long, value_name = "FILE.toml")]
    pub(crate) output: Option<PathBuf>,
    /// Folder that receives one result folder per experiment.
    #[arg(long, default_value = "reports", value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) threads: Threads,
    /// Override a key of the files, TOML syntax: --set simulation.seed=7
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print nothing but errors.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Resume an interrupted grid: keep its finished cells.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Run only part I of N of the combinations of a grid; `experiment merge` joins the parts.
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
}

#[derive(clap::Args)]
pub(crate) struct Threads {
    /// Threads to use; all cores unless given.
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<usize>,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Run experiment files or recordings (the default command).
    Run(Run),
    /// Detect columns and units of recordings, and write a commented experiment file.
    New {
        /// Recordings (CSV, Parquet, WPILOG, MCAP, MAT, SysId); of each kind of movement every third is kept for
        /// validation.
        #[arg(required = true, value_name = "RECORDING")]
        recordings: Vec<PathBuf>,
        /// The file to write; the name of the first recording unless given.
        #[arg(short, long, value_name = "FILE.toml")]
        output: Option<PathBuf>,
    },
    /// Add a physical effect to the model of a file, run it, and print the error before and after.
    Add {
        /// Id of the effect; `experiment effects` lists them.
        effect: String,
        /// The experiment file.
        #[arg(value_name = "FILE.toml")]
        file: PathBuf,
        /// Folder of the result folders.
        #[arg(long, default_value = "reports", value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        threads: Threads,
    },
    /// Export the results of the last run to other formats.
    Export {
        /// The experiment file.
        #[arg(value_name = "FILE.toml")]
        file: PathBuf,
        /// What to write, separated by commas: csv, parquet, mcap (measured and simulated motion,
        /// residual torque, torque of the effects found), mjcf, urdf (the robot for simulators), gains.
        #[arg(long, value_name = "FORMATS", value_delimiter = ',', default_value = "csv")]
        to: Vec<ExportFormat>,
        /// Folder of the result folders.
        #[arg(long, default_value = "reports", value_name = "DIR")]
        out: PathBuf,
        /// Keys that were overridden in the run.
        #[arg(long, value_name = "KEY=VALUE")]
        set: Vec<String>,
    },
    /// Join the parts of grids that were run with --shard, and write their reports.
    Merge {
        /// Experiment files.
        #[arg(required = true, value_name = "FILE.toml")]
        files: Vec<PathBuf>,
        /// Folder of the result folders, which hold the parts.
        #[arg(long, default_value = "reports", value_name = "DIR")]
        out: PathBuf,
        /// Keys that were overridden in the parts.
        #[arg(long, value_name = "KEY=VALUE")]
        set: Vec<String>,
        /// Print nothing but errors.
        #[arg(long)]
        quiet: bool,
        #[command(flatten)]
        threads: Threads,
    },
    /// Check files and recordings without fitting, and show the settings.
    Check {
        /// Experiment files, or recordings.
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Override a key of the files.
        #[arg(long, value_name = "KEY=VALUE")]
        set: Vec<String>,
        #[command(flatten)]
        threads: Threads,
    },
    /// List the physical effects, or describe one of them.
    Effects {
        /// Id of an effect.
        effect: Option<String>,
    },
    /// List the identification methods, or describe one of them.
    Methods {
        /// Name of a method.
        method: Option<String>,
    },
    /// Write the JSON schema of experiment files to standard output, for editors.
    Schema,
    /// Write the manual page to standard output: experiment man | man -l -
    Man,
    /// Write a completion script for a shell to standard output.
    Completions {
        /// Shell for which the script is written.
        shell: clap_complete::Shell,
    },
}

impl Cli {
    /// The limit on threads of the command, if it has one.
    pub(crate) fn threads(&self) -> Option<&Threads> {
        match &self.command {
            None => Some(&self.run.threads),
            Some(Command::Run(run)) => Some(&run.threads),
            Some(
                Command::Add { threads, .. }
                | Command::Merge { threads, .. }
                | Command::Check { threads, .. },
            ) => Some(threads),
            Some(_) => None,
        }
    }
}

impl Threads {
    /// Limits the number of threads of all parallel computations.
    pub(crate) fn limit(&self) -> Result<(), String> {
        let pool = rayon::ThreadPoolBuilder::new();
        match self.jobs {
            None => Ok(()),
            Some(0) => Err("--jobs 0: at least one thread is needed".into()),
            Some(n) => pool.num_threads(n).build_global().map_err(|e| format!("--jobs {n}: {e}")),
        }
    }
}
