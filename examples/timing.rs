use amigo_ident::diagnose::*;
use amigo_ident::identify::kalman::{Likelihood, prepare};
use amigo_ident::identify::{Task, start};
use amigo_ident::study::Role;
fn main() {
    let file = std::env::args().nth(1).unwrap();
    let plan = amigo_ident::experiment::load(std::path::Path::new(&file), &[]).unwrap();
    let train = plan.of(Role::Train);
    let mut model = plan.model.clone();
    for e in std::env::args().skip(2) {
        model = model.add(&e).unwrap();
    }
    let task = Task { model: &model, train: &train, hold: plan.hold, seed: 1 };
    let first = start::start(&task, "x").unwrap();
    let l = Likelihood {
        prepared: train.iter().map(prepare).collect(),
        hold: plan.hold,
        slow_moment: true,
    };
    let t = std::time::Instant::now();
    let d =
        diagnose(&model, &first, &l, &Settings { max_effects: 0, ..Settings::default() }).unwrap();
    println!(
        "{:?} base {:?} noise {:?} ll {} {:?} evals {}",
        t.elapsed(),
        d.base.1.p,
        d.base.1.noise,
        d.base.1.log_likelihood,
        d.base.1.status,
        d.base.1.evaluations
    );
    for r in d.ranking.iter().take(8) {
        println!(
            "{} E* {:.1} scanE {:.1} L {:.1} C {:.1} est {:?} {:?}",
            r.candidate.id,
            r.evidence(),
            r.score.evidence,
            r.score.log_significance,
            r.score.cross_gain,
            r.score.estimate,
            r.refit.as_ref().map(|f| (
                f.maximum.p[model.parameters().len()..].to_vec(),
                f.in_range,
                f.gain,
                f.maximum.noise,
                f.maximum.evaluations
            ))
        );
    }
}
