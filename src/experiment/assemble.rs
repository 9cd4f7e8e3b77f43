//! A plan from a model, recordings and options.

use std::path::PathBuf;

use super::align::{self, Asked};
use super::copies::{check_copies, copies};
use super::custom::{Own, add};
use super::error::{ExperimentError, Meaning, words};
use super::plan::{DiagnosisPlan, MeasuredRecording, Plan, PlanOptions};
use super::remark::Remark;
use super::robot_table::has_no_track;
use crate::diagnose::Untimed;
use crate::effects;
use crate::model::Model;
use crate::model::base::{A1, A2, A3};
use crate::recording::{Lacking, Recording, lacking};
use crate::robot::Robot;
use crate::simulate::{Gain, WINDOW};
use crate::study::Role;

impl Plan {
    /// The experiment that fits `model` to the training recordings and evaluates it on the validation
    /// recordings. `name` is the name of the result folder. As for an experiment file, the time of the input
    /// and the effects of the logger are determined before identification.
    ///
    /// # Errors
    /// No training recording, none with an input, no method, recordings with different units of the input, unknown
    /// candidates.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::experiment::{MethodPlan, Plan, PlanOptions, Reading, compare, fits};
    /// use amigo_ident::identify::WeakForm;
    /// use amigo_ident::{model::Model, recording::DriveUnit, robot::Robot};
    /// let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
    /// let recordings = reading.files(&["recordings/simulated_3d/slope/train_1.csv"], &[])?;
    /// let model = Model::with_effects(Robot::amigobot(), &["slope"])?;
    /// let methods = vec![MethodPlan::new(WeakForm { half_width_s: Some(0.24), ..WeakForm::default() })];
    /// let plan = Plan::new("slope", model, recordings, PlanOptions { methods, ..PlanOptions::default() })?;
    /// let comparison = compare(&plan, &fits(&plan))?;
    /// let (judged, weak_form) = (comparison.judged(), &comparison.methods[0]);
    /// assert!(judged.window_rms(&weak_form.performance) < 2.0 * judged.floor());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        name: &str,
        model: Model,
        recordings: Vec<MeasuredRecording>,
        options: PlanOptions,
    ) -> Result<Self, ExperimentError> {
        let own = own_effects(&model, &options);
        check(&recordings, &options, &own).map_err(|e| e.of(name))?;
        check_track(&model, options.diagnosis.as_ref()).map_err(|e| e.of(name))?;
        Ok(Self { own, ..assembled(name, model, recordings, options) })
    }
}

/// User-defined effects: those of the model, and those of the diagnosis.
fn own_effects(model: &Model, options: &PlanOptions) -> Vec<Own> {
    let tried = options.diagnosis.iter().flat_map(|asked| &asked.settings.own);
    let all = model.effects().iter().chain(tried);
    all.filter(|effect| effects::find(&effect.id()).is_none()).cloned().collect()
}

fn check(
    recordings: &[MeasuredRecording],
    options: &PlanOptions,
    own: &[Own],
) -> Result<(), Meaning> {
    if !recordings.iter().any(|m| m.role == Role::Train) {
        return Err(words("no training recording is given".into()));
    }
    let train = || recordings.iter().filter(|m| m.role == Role::Train).map(|m| &m.recording);
    if let Some(none) = super::no_motion::NoMotion::of(train()) {
        return Err(words(none.to_string()));
    }
    if super::quality::without_input(train()) {
        return Err(words(
            "the inputs of all training recordings are zero throughout; without an input the parameters have no scale"
                .into(),
        ));
    }
    check_copies(recordings)?;
    let mut units = recordings.iter().map(|m| m.recording.drive_unit());
    let first = units.next();
    if let Some(other) = units.find(|unit| Some(*unit) != first) {
        let units = [first.unwrap_or_default(), other].map(|unit| unit.symbol());
        let [first, other] = units;
        return Err(words(format!(
            "the inputs of all recordings must have one unit; there are {first} and {other}"
        )));
    }
    if options.methods.is_empty() {
        return Err(words("no identification method is given".into()));
    }
    options.gain.map_or(Ok(()), |gain| gain.check())?;
    options
        .diagnosis
        .as_ref()
        .map_or(Ok(()), |asked| candidates_are_known(&asked.settings.candidates, own))
}

/// Checks that the track is known where an effect of the model, or a candidate by its name, depends on it.
///
/// # Errors
/// The effect, and the keys to be written.
pub(super) fn check_track(model: &Model, asked: Option<&DiagnosisPlan>) -> Result<(), Meaning> {
    if !has_no_track(model.robot()) {
        return Ok(());
    }
    let named = |id: &String| asked.is_some_and(|asked| asked.settings.candidates.contains(id));
    let of_model =
        || model.effects().iter().find(|e| e.needs_track()).map(|e| ("model.effects", e.id()));
    let of_diagnosis =
        || of_track(asked).into_iter().find(named).map(|id| ("diagnosis.candidates", id));
    of_model().or_else(of_diagnosis).map_or(Ok(()), |(key, id)| {
        Err(words(format!(
            "{key}: `{id}` depends on the distance between the wheels, which is not known: write l1_m (half that \
             distance [m]) and r_m (radius of the wheels [m]) under [robot], or a preset; otherwise remove `{id}`"
        )))
    })
}

/// Checks that every candidate is an effect of the catalogue or of `own`.
///
/// # Errors
/// An unknown candidate, with the most similar id.
pub(super) fn candidates_are_known(ids: &[String], own: &[Own]) -> Result<(), Meaning> {
    let base = Model::base(Robot::amigobot());
    // the error of the model names the most similar effect
    ids.iter().try_for_each(|id| add(&base, id, own).map(drop).map_err(Meaning::from))
}

/// The model with a2 and a3 fixed at zero if every recording is of a single axis, mapped to both wheels: it does not
/// turn, and a1 is its inertia. With two inertias of which only the sum is identifiable, the difference of the wheels,
/// which no recording contains, would have an arbitrary time constant in simulations.
fn of_one_axis(model: Model, recordings: &[MeasuredRecording]) -> Model {
    let free = [A1, A2, A3].iter().all(|&j| model.parameters()[j].fixed.is_none());
    let single = |m: &MeasuredRecording| m.recording.is_single_axis();
    if !free || recordings.is_empty() || !recordings.iter().all(single) {
        return model;
    }
    let fix = |model: Model, j: usize| {
        let symbol = model.parameters()[j].spec.symbol.clone();
        model.fix(&symbol, 0.0)
    };
    fix(model.clone(), A2).and_then(|model| fix(model, A3)).unwrap_or(model)
}

/// The plan without an experiment file and without user-defined effects.
pub(super) fn assembled(
    name: &str,
    model: Model,
    recordings: Vec<MeasuredRecording>,
    options: PlanOptions,
) -> Plan {
    let PlanOptions { title, methods, diagnosis, hold, gain, conditioning, robot_is_built, seed } =
        options;
    let speeds = recordings.iter().flat_map(|m| m.recording.omega().iter().copied());
    let findings = recordings.iter().flat_map(|m| &m.conditioning);
    let opposed = super::remarks::opposed_wheels(&speeds.collect::<Vec<_>>(), findings);
    let no_track = has_no_track(model.robot())
        .then(|| Remark::NoTrack { effects: of_track(diagnosis.as_ref()) });
    let input = recordings.first().map(|m| m.recording.drive_unit());
    let without = input.map_or(vec![], |input| super::remarks::without_effects(&model, input));
    let name_of = |k: usize| recordings[k].recording.name().to_owned();
    let twice = copies(&recordings).into_iter();
    let twice = twice.map(|(j, k)| Remark::Twice { name: name_of(k), other: name_of(j) });
    let proportions = proportions(&model, &recordings);
    let short = short_windows(&recordings);
    let remarks = no_track
        .into_iter()
        .chain(proportions)
        .chain(opposed)
        .chain(without)
        .chain(twice)
        .chain(short)
        .collect();
    let model = of_one_axis(model, &recordings);
    let mut plan = Plan {
        name: name.to_owned(),
        title: title.unwrap_or_else(|| name.replace(['_', '-'], " ")),
        file: String::new(),
        source: PathBuf::new(),
        typed: vec![],
        robot_is_given: true,
        own: vec![],
        sums: vec![],
        assumed: None,
        remarks,
        model,
        recordings: super::quality::of_the_set(recordings),
        hold: hold.unwrap_or_default(),
        timing: Err(Untimed::default()),
        emulated: gain.is_some() || methods.iter().any(|m| m.method.fits_emulator()),
        methods,
        gain: gain.unwrap_or(Gain::ZERO),
        of_paper: false,
        diagnosis,
        seed,
        truth: vec![],
        grid: None,
    };
    align::place(&mut plan);
    align::weigh(&mut plan, robot_is_built);
    align::align(&mut plan, &Asked { hold, settings: conditioning });
    plan
}

/// The remark on recordings that are shorter than the windows of the simulation error: those of validation, else all.
fn short_windows(recordings: &[MeasuredRecording]) -> Option<Remark> {
    let longest = |role: Role| {
        let of = recordings.iter().filter(|m| m.role == role);
        of.map(MeasuredRecording::duration).max_by(f64::total_cmp)
    };
    let longest_s = longest(Role::Validation).or_else(|| longest(Role::Train))?;
    (longest_s < WINDOW).then_some(Remark::ShortWindows { longest_s })
}

/// The remark on the inertias of a robot of unknown construction that the recordings do not determine.
fn proportions(model: &Model, recordings: &[MeasuredRecording]) -> Option<Remark> {
    model.robot().assumed.as_ref()?;
    let train = recordings.iter().filter(|m| m.role == Role::Train);
    let train: Vec<Recording> = train.map(|m| m.recording.clone()).collect();
    let lacking = if train.is_empty() { None } else { lacking(&train) }?;
    Some(Remark::Proportions { straight: lacking == Lacking::Turns })
}

/// Ids of the effects that depend on the track of the robot: of the catalogue, and user-defined candidates.
fn of_track(asked: Option<&DiagnosisPlan>) -> Vec<String> {
    let catalogue = effects::all().into_iter().map(Own::from);
    let own = asked.into_iter().flat_map(|asked| asked.settings.own.iter().cloned());
    catalogue.chain(own).filter(|e| e.needs_track()).map(|e| e.id()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Settings;
    use crate::experiment::{MethodPlan, Reading, fits, plan_of};
    use crate::identify::WeakForm;
    use crate::recording::DriveUnit;
    use crate::simulate::Hold;

    fn recordings(train: &[&str], validation: &[&str]) -> Vec<MeasuredRecording> {
        let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
        let file = |name: &&str| format!("recordings/simulated_3d/slope/{name}.csv");
        let of = |names: &[&str]| names.iter().map(file).collect::<Vec<_>>();
        reading.files(&of(train), &of(validation)).unwrap()
    }

    fn refused(recordings: Vec<MeasuredRecording>, options: PlanOptions) -> String {
        let model = Model::base(Robot::amigobot());
        Plan::new("mine", model, recordings, options).err().expect("it is refused").to_string()
    }

    #[test]
    fn typed_options_are_the_keys_of_an_experiment_file() {
        let keys = "model.effects = [\"slope\"]\nmethod = [{ name = \"weak_form\", half_width_s = 0.24 }]\n\
                    [diagnosis]\nmax_effects = 1";
        let read = || recordings(&["train_1"], &["validation"]);
        let by_keys =
            plan_of("mine", &toml::from_str(keys).unwrap(), read(), Some(Hold::Linear)).unwrap();
        let method = WeakForm { half_width_s: Some(0.24), ..WeakForm::default() };
        let options = PlanOptions {
            methods: vec![MethodPlan::new(method)],
            diagnosis: Some(Settings { max_effects: 1, ..Settings::default() }.into()),
            hold: Some(Hold::Linear),
            ..PlanOptions::default()
        };
        let model = Model::with_effects(Robot::amigobot(), &["slope"]).unwrap();
        let typed = Plan::new("mine", model, read(), options).unwrap();
        let asked = |plan: &Plan| {
            let asked = plan.diagnosis.as_ref().unwrap();
            let Settings { candidates, false_alarm, max_effects, .. } = &asked.settings;
            (candidates.clone(), *false_alarm, *max_effects, asked.slow_moment)
        };
        assert_eq!(asked(&typed), asked(&by_keys));
        let of = |plan: &Plan| {
            let fit = fits(plan).swap_remove(0).fit.unwrap();
            fit.estimates.iter().map(|e| (e.value, e.std_error)).collect::<Vec<_>>()
        };
        assert_eq!(of(&typed), of(&by_keys));
        let stated = |plan: &Plan| {
            (plan.title.clone(), plan.seed, plan.hold, plan.emulated, plan.methods[0].title.clone())
        };
        assert_eq!(stated(&typed), stated(&by_keys));
    }

    #[test]
    fn effects_that_depend_on_an_unknown_track_are_refused_with_the_keys() {
        let keys = |text: &str| {
            let table = toml::from_str(&format!("robot.preset = \"unknown\"\n{text}")).unwrap();
            plan_of("mine", &table, recordings(&["train_1"], &[]), None)
        };
        for (text, key, id) in [
            ("model.effects = [\"slope\"]", "model.effects", "slope"),
            ("model.effects = [\"payload\"]", "model.effects", "payload"),
            (
                "diagnosis.candidates = [\"turning_scrub\", \"slope\"]",
                "diagnosis.candidates",
                "slope",
            ),
        ] {
            let error = keys(text).err().unwrap().to_string();
            assert!(error.contains(&format!("{key}: `{id}` depends on the distance")), "{error}");
            assert!(error.contains("write l1_m") && error.contains("under [robot]"), "{error}");
        }
        let plan = keys("diagnosis.candidates = \"all\"").unwrap();
        let remarks: Vec<String> = plan.remarks.iter().map(ToString::to_string).collect();
        assert!(remarks[0].contains("(slope, payload) are not tested"), "{remarks:?}");
        let known = "model.effects = [\"slope\"]\nrobot.l1_m = 0.15\nrobot.r_m = 0.08";
        assert!(keys(known).is_ok());
    }

    #[test]
    fn a_copy_of_a_training_recording_is_no_validation() {
        let error = refused(recordings(&["train_1"], &["train_1"]), PlanOptions::default());
        assert!(
            error.contains("recordings.validation: train_1.csv has the same samples"),
            "{error}"
        );
        // counted twice in training
        let plan = |names: &[&str]| {
            let model = Model::base(Robot::amigobot());
            Plan::new("mine", model, recordings(names, &["validation"]), PlanOptions::default())
        };
        let remarks = |names: &[&str]| plan(names).unwrap().remarks;
        assert!(matches!(remarks(&["train_1", "train_1"])[..], [Remark::Twice { .. }]));
        assert!(remarks(&["train_1"]).is_empty());
    }

    #[test]
    fn windows_that_are_shorter_than_two_seconds_are_remarked() {
        let recordings = recordings(&["train_1"], &["validation"]);
        assert_eq!(short_windows(&recordings), None);
        let short: Vec<MeasuredRecording> = recordings
            .into_iter()
            .map(|mut m| {
                m.recording = m.recording.cut(0..101).unwrap(); // rows of 5 ms
                m
            })
            .collect();
        let remark = short_windows(&short).unwrap().to_string();
        assert!(remark.contains("as long as its recording, 0.50 s at most"), "{remark}");
    }

    #[test]
    fn a_voltage_without_back_emf_is_remarked() {
        let reading = Reading::new(Robot::amigobot(), DriveUnit::Volt);
        let read =
            || reading.file(Role::Train, "recordings/simulated_3d/slope/train_1.csv".as_ref());
        let remarks = |effects: &[&str]| {
            let model = Model::with_effects(Robot::amigobot(), effects).unwrap();
            let plan = Plan::new("mine", model, vec![read().unwrap()], PlanOptions::default());
            plan.unwrap().remarks
        };
        let words = remarks(&[]).iter().map(ToString::to_string).collect::<Vec<_>>().join("");
        assert!(words.contains("the model has no back_emf"), "{words}");
        assert!(words.contains("effects = [\"back_emf\"] under [model]"), "{words}");
        // the two have one form
        for effect in ["back_emf", "viscous_friction"] {
            assert!(remarks(&[effect]).is_empty(), "{effect}");
        }
    }

    #[test]
    fn recordings_at_rest_are_refused_as_such() {
        let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
        let column = |name: &str, f: &dyn Fn(f64) -> f64| {
            (name.to_owned(), (0..1000).map(|k| f(0.01 * f64::from(k))).collect::<Vec<_>>())
        };
        let noise = |t: f64| 0.02 * (1e4 * t * t).sin();
        let columns = [
            column("t", &|t| t),
            column("dalpha1", &noise),
            column("dalpha2", &|t| -noise(t)),
            column("M1", &|t| 0.5 + 0.1 * t.sin()),
            column("M2", &|t| 0.5 + 0.1 * t.cos()),
        ];
        let still = reading.table(Role::Train, "still", &columns).unwrap();
        let refused = refused(vec![still], PlanOptions::default());
        assert!(refused.contains("the wheels do not move in any training recording"), "{refused}");
    }

    #[test]
    fn a_plan_that_cannot_run_is_refused_with_the_reason() {
        let none = refused(recordings(&[], &["validation"]), PlanOptions::default());
        assert_eq!(none, "mine: no training recording is given");
        let methods = PlanOptions { methods: vec![], ..PlanOptions::default() };
        let none = refused(recordings(&["train_1"], &[]), methods);
        assert_eq!(none, "mine: no identification method is given");
        let candidates = Settings { candidates: vec!["slop".into()], ..Settings::default() };
        let options = PlanOptions { diagnosis: Some(candidates.into()), ..PlanOptions::default() };
        let unknown = refused(recordings(&["train_1"], &[]), options);
        assert!(unknown.contains("did you mean `slope`"), "{unknown}");
    }
}
