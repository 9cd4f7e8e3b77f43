use super::super::torque_regression::{TorqueRegression, Weighting};
use super::super::{Fit, Identifier};
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::model::Model;
use crate::model::base::A1;
use crate::recording::{DriveUnit, RowsError};
use crate::robot::Robot;
use crate::simulate::Hold;

const MODEL: [f64; 5] = [0.0319, 0.0143, 2.9e-4, 0.05, 0.06];

/// 160 s at 1 kHz of the base model by its formula, with noise: rests, reversals, two gaps, one
/// piece that is too short for the filter. Longer than two stretches that are filtered at a time.
fn recording(speeds: bool) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
    let [a1, a2, a3, a4, a5] = MODEL;
    let mut c = Channels { omega: speeds.then(Vec::new), ..Channels::default() };
    let mut alpha = Vec::new();
    for k in 0..160_000 {
        let t = 1e-3 * f64::from(k);
        // still for a second in eight, both directions
        let phase = (t % 8.0).min(7.0) / 7.0 * std::f64::consts::TAU;
        let swing = std::f64::consts::TAU / 7.0;
        let still = t % 8.0 >= 7.0;
        let wave = |f: f64, size: f64| {
            if still {
                return [0.0; 3];
            }
            let x = f * phase;
            let r = f * swing;
            [size * (1.0 - x.cos()) / r, size * x.sin(), size * r * x.cos()]
        };
        let (one, two) = (wave(1.0, 5.0), wave(2.0, 4.0));
        let w = [one[1] + 0.5 * two[1], two[1] - 0.3 * one[1]];
        let a = [one[2] + 0.5 * two[2], two[2] - 0.3 * one[2]];
        let turn = w[1] - w[0];
        let sign = |w: f64| if w == 0.0 { 0.0 } else { w.signum() };
        let m = [
            a1 * a[0] + a2 * a[1] + a3 * w[1] * turn + a4 * sign(w[0]),
            a2 * a[0] + a1 * a[1] - a3 * w[0] * turn + a5 * sign(w[1]),
        ];
        let gap = if k < 70_000 { 0.0 } else { 0.4 } + if k < 70_050 { 0.0 } else { 0.7 };
        c.t.push(t + gap + 1e-4 * noise());
        alpha.push([one[0] + 0.5 * two[0], two[0] - 0.3 * one[0]].map(|x| x + 1e-4 * noise()));
        c.torque.push(m.map(|m| m + 5e-3 * noise()));
        if let Some(omega) = &mut c.omega {
            omega.push(w.map(|w| w + 0.05 * noise()));
        }
    }
    c.alpha = (!speeds).then_some(alpha);
    Recording::new("made", c, DriveUnit::NewtonMetre).unwrap()
}

/// Rows that are read in blocks of an odd size, as they stand in a file.
struct Blocks(Channels);

impl Rows for Blocks {
    fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_> {
        const BLOCK: usize = 777;
        let c = &self.0;
        Box::new((0..c.t.len()).step_by(BLOCK).map(move |from| {
            let range = from..(from + BLOCK).min(c.t.len());
            let of = |rows: &Vec<[f64; 2]>| rows[range.clone()].to_vec();
            Ok(Channels {
                t: c.t[range.clone()].to_vec(),
                alpha: c.alpha.as_ref().map(of),
                omega: c.omega.as_ref().map(of),
                torque: of(&c.torque),
            })
        }))
    }
}

fn as_in_file(r: &Recording) -> LongRecording {
    let channels = Channels {
        t: r.t().to_vec(),
        alpha: r.measured().alpha.then(|| r.alpha().to_vec()),
        omega: r.measured().omega.then(|| r.omega().to_vec()),
        torque: r.torque().to_vec(),
    };
    LongRecording {
        rows: Box::new(Blocks(channels)),
        samples: r.len(),
        duration: r.duration(),
        windows: 1,
    }
}

#[track_caller]
fn assert_same(streamed: &Fit, held: &Fit, tolerance: f64) {
    for (s, h) in streamed.estimates.iter().zip(&held.estimates) {
        assert!(h.std_error > 0.0 && h.std_error.is_finite(), "{h:?}");
        let apart = (s.value - h.value).abs() / h.std_error;
        assert!(apart < tolerance, "{} is {apart:e} standard errors off", s.symbol);
        let ratio = s.std_error / h.std_error - 1.0;
        assert!(ratio.abs() < tolerance, "{}: {ratio:e}", s.symbol);
    }
    assert_eq!(streamed.notes.len(), held.notes.len(), "{:?}\n{:?}", streamed.notes, held.notes);
}

fn both(method: &TorqueRegression, model: &Model, r: &Recording, hold: Hold) -> (Fit, Fit) {
    let train = [r.clone(), r.cut(10_000..40_000).unwrap()];
    let task = Task { model, train: &train, hold, seed: 1 };
    // one that is read and one that is held
    let long = as_in_file(r);
    let streamed = method.identify_long(&task, &[Some(&long), None]).unwrap().unwrap();
    (streamed, method.identify(&task).unwrap())
}

/// What remains is what the ends of the stretches leave, 1e-9 of the signals by design, here in
/// standard errors, which are some 1e-4 of the values.
const SAME: f64 = 1e-6;

#[test]
fn rows_read_in_blocks_give_what_rows_in_memory_give() {
    let model = Model::base(Robot::amigobot());
    let r = recording(true);
    assert!(r.pieces().len() == 3);
    for weighting in [Weighting::Ordinary, Weighting::Weighted] {
        let method = TorqueRegression { weighting, ..TorqueRegression::default() };
        let (streamed, held) = both(&method, &model, &r, Hold::Linear);
        assert_same(&streamed, &held, SAME);
        // and they are right, up to the attenuation that the method is known for
        let a1 = streamed.estimates[A1].value;
        assert!((a1 / MODEL[0] - 1.0).abs() < 0.05, "{a1}");
    }
}

#[test]
fn speeds_that_are_not_measured_and_inputs_with_memory_stream_too() {
    let model = Model::with_effects(Robot::amigobot(), &["viscous_friction", "actuator_lag"]);
    let method = TorqueRegression { cutoff_hz: Some(6.0), ..TorqueRegression::default() };
    let (streamed, held) = both(&method, &model.unwrap(), &recording(false), Hold::Constant);
    let linear: Vec<usize> =
        (0..held.estimates.len()).filter(|&j| !held.estimates[j].fixed).collect();
    let of = |fit: &Fit| Fit {
        estimates: linear.iter().map(|&j| fit.estimates[j].clone()).collect(),
        ..fit.clone()
    };
    // in blocks a lag begins anew after a gap, which the filter's length around gaps leaves 1e-5 of
    assert_same(&of(&streamed), &of(&held), 1e-4);
}

#[test]
fn memory_holds_a_triangle_a_block_and_wheel() {
    let model = Model::base(Robot::amigobot());
    let train = [recording(true)];
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 1 };
    let long = as_in_file(&train[0]);
    let rows = regression(&task, &[Some(&long)], (None, None), 0.035, "torque_regression").unwrap();
    // 160 s are 33 blocks and one more at the gap; 6 rows of each for either wheel
    assert!(rows.x.nrows() <= 34 * 2 * 6, "{}", rows.x.nrows());
    assert!(rows.count > 2000);
}

#[test]
fn noise_of_some_stretches_is_that_of_all() {
    let model = Model::base(Robot::amigobot());
    let train = [recording(true)];
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 1 };
    let of = |times: usize| {
        let long = as_in_file(&train[0]);
        // the number of rows decides in how many stretches
        let long = LongRecording { samples: times * long.samples, ..long };
        regression(&task, &[Some(&long)], (None, None), 0.035, "torque_regression").unwrap()
    };
    let (all, some) = (of(1), of(14));
    assert_eq!((&all.x, &all.y), (&some.x, &some.y));
    for c in 0..all.noise.ncols() {
        let ratio = some.noise[(c, c)] / all.noise[(c, c)];
        // half of some 1000 independent rows: √(2/500), 6 %, five times
        assert!(all.noise[(c, c)] == 0.0 || (ratio - 1.0).abs() < 0.3, "{c}: {ratio}");
    }
}

#[test]
fn rows_that_cannot_be_read_again_are_an_error_in_words() {
    struct Gone;
    impl Rows for Gone {
        fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_> {
            let error = std::io::Error::other("run.csv: No such file");
            Box::new(std::iter::once(Err(RowsError::new(error))))
        }
    }
    let model = Model::base(Robot::amigobot());
    let train = [recording(true)];
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 1 };
    let long = LongRecording { rows: Box::new(Gone), samples: 9, duration: 9.0, windows: 1 };
    let e = TorqueRegression::default().identify_long(&task, &[Some(&long)]).unwrap();
    let e = e.err().unwrap().to_string();
    assert!(e.contains("cannot be read again: run.csv: No such file"), "{e}");
}
