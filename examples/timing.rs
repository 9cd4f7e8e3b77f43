use amigo_ident::identify::kalman::{Likelihood, prepare};
use amigo_ident::identify::{Task, start};
use amigo_ident::model::Model;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::*;
fn main() {
    let model = Model::base(Robot::amigobot());
    let truth = model.initial();
    let train: Vec<_> = (0..4)
        .map(|r| {
            let movement = Movement::rich(model.robot(), r, 25.0, 12.0);
            record(
                "m",
                &model,
                &truth,
                &movement,
                &Recorder {
                    rate: 100.0,
                    control_rate: 1000.0,
                    noise: NoiseLevel { dalpha: 0.05, alpha: 1e-3, moment: 0.005 },
                    ticks: None,
                    seed: r,
                },
            )
            .unwrap()
        })
        .collect();
    let n: usize = train.iter().map(|t| t.len()).sum();
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
    let p = start::start(&task, "x").unwrap();
    let l = Likelihood {
        prepared: train.iter().map(prepare).collect(),
        hold: Hold::Linear,
        slow_moment: true,
    };
    let noise = l.initial_noise();
    for d in [false, true] {
        let t = std::time::Instant::now();
        for _ in 0..20 {
            l.passes(&model, &p, &noise, d, &[]).unwrap();
        }
        println!(
            "derivatives {d}: {:.3} us/sample",
            t.elapsed().as_secs_f64() / 20.0 / n as f64 * 1e6
        );
    }
    let m = l.maximise(&model, &p, None, "x").unwrap();
    let recs: Vec<_> = train.iter().collect();
    let t = std::time::Instant::now();
    let all = amigo_ident::diagnose::candidates(&model, &[], &recs);
    println!("candidates {} {:?}", all.len(), t.elapsed());
    let t = std::time::Instant::now();
    let s = amigo_ident::diagnose::scan(&model, &m.p, &m.noise, &l, &all).unwrap();
    println!("scan {:?}", t.elapsed());
    let t = std::time::Instant::now();
    for (c, s) in all.iter().zip(&s).filter(|(c, _)| c.id == "viscous_friction") {
        let r = amigo_ident::diagnose::refit(&model, &m, c, s, &l).unwrap();
        println!("refit {:?} E* {} evals {}", t.elapsed(), r.evidence, r.maximum.evaluations);
    }
}
