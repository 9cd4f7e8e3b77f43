//! The command line of an experiment.

/// The experiment in terms of the command line, for commands quoted in a report.
#[derive(Clone, Debug, Default)]
pub struct Invocation {
    /// Its file, or the file to be written by `experiment new`; empty if the library runs it without one.
    pub file: String,
    /// The recordings of a run without an experiment file; otherwise empty.
    pub recordings: Vec<String>,
    /// The folder of the results, if not the default.
    pub out: Option<String>,
}

impl Invocation {
    /// The command that writes the experiment file; `None` if there is one.
    #[must_use]
    pub fn new_file(&self) -> Option<String> {
        let recordings = (!self.recordings.is_empty()).then(|| words(&self.recordings))?;
        Some(format!("experiment new {recordings} -o {}", shell_word(&self.file)))
    }

    /// Whether the command line can run it: by its file, or by its recordings.
    #[must_use]
    pub fn has_file(&self) -> bool {
        !self.file.is_empty()
    }

    /// The command that adds an effect to the model.
    ///
    /// ```
    /// use amigo_ident::study::Invocation;
    /// let file = "floor run.toml".to_string();
    /// let run = Invocation { file, out: Some("out".to_string()), ..Invocation::default() };
    /// assert_eq!(run.add("slope"), "experiment add slope \"floor run.toml\" --out out");
    /// ```
    #[must_use]
    pub fn add(&self, effect: &str) -> String {
        let out =
            self.out.as_ref().map_or(String::new(), |out| format!(" --out {}", shell_word(out)));
        format!("experiment add {effect} {}{out}", shell_word(&self.file))
    }

    /// The command that runs the experiment again.
    #[must_use]
    pub fn run(&self) -> String {
        let files = if self.recordings.is_empty() {
            shell_word(&self.file)
        } else {
            words(&self.recordings)
        };
        format!("experiment {files}")
    }
}

fn words(all: &[String]) -> String {
    all.iter().map(|one| shell_word(one)).collect::<Vec<_>>().join(" ")
}

/// A word of a command, quoted if a shell would split it.
#[must_use]
pub fn shell_word(text: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./\\:+,=@%#".contains(c);
    if text.chars().all(is_plain) { text.to_owned() } else { format!("\"{text}\"") }
}
