//! Changed files in numbers: every reader is given samples that were damaged at random, and must
//! answer each with a value that holds what it promises, or with an error in words.
//!
//! ```sh
//! AMIGO_FUZZ=100000 cargo test --release --test it -- --ignored --nocapture --test-threads=1 fuzz
//! ```
//! runs that many inputs for each reader and prints how many were accepted and refused. The inputs
//! are the same for the same AMIGO_FUZZ_SEED (1 unless given). An input that ends the program lies in
//! `target/tmp/fuzz` afterwards, under the name of its reader.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use amigo_ident::experiment::ExperimentFile;
use amigo_ident::io::{ColumnMap, TableColumn, headers, read_recording, write_parquet_table};
use amigo_ident::math::expression;
use amigo_ident::recording::DriveUnit;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::support::{HEADER, Row, csv, motion, root, text};

/// Largest input [bytes]; splices must not let it grow without end.
const LARGEST: usize = 1 << 17;

/// An input that takes longer is kept [s].
const SLOW: f64 = 2.0;

/// Numbers at the edges, as text.
const NUMBERS: [&str; 18] = [
    "0",
    "-0",
    "1",
    "-1",
    "1e308",
    "-1e308",
    "1e309",
    "1e-320",
    "5e-324",
    "NaN",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "0x10",
    "1,5",
    "1_000",
];
/// Pieces of text that mean something to one reader or another.
const PIECES: [&str; 28] = [
    ",", ";", "\t", "\n", "\r\n", "\"", "'", "#", "\\", "{", "}", "[", "]", "[[", "]]", "(", ")",
    "=", ".", ":", "null", "true", "é", "\u{0}", "\u{feff}", "\"\"\"", "^", "*",
];
/// Whole numbers at the edges, for fields of 1, 2, 4 or 8 bytes.
const EDGES: [u64; 10] =
    [0, 1, 0x7f, 0x80, 0xff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 0x7fff_ffff_ffff_ffff, u64::MAX];

fn from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name}={v}")))
}

/// One to four changes of a sample.
fn damaged(samples: &[Vec<u8>], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = samples[rng.random_range(0..samples.len())].clone();
    for _ in 0..rng.random_range(1..=4) {
        change(&mut bytes, samples, rng);
    }
    bytes.truncate(LARGEST);
    bytes
}

fn change(bytes: &mut Vec<u8>, samples: &[Vec<u8>], rng: &mut ChaCha8Rng) {
    if bytes.is_empty() {
        bytes.push(rng.random());
    }
    let at = rng.random_range(0..bytes.len());
    let length = 1 << rng.random_range(0..8);
    let to = (at + rng.random_range(1..=length)).min(bytes.len());
    match rng.random_range(0..10) {
        0 | 1 => bytes[at] ^= 1 << rng.random_range(0..8),
        2 => bytes[at] = rng.random(),
        3 => bytes.truncate(at),
        4 => drop(bytes.drain(at..to)),
        5 => {
            let piece = bytes[at..to].to_vec();
            bytes.splice(at..at, piece);
        }
        6 => {
            let other = &samples[rng.random_range(0..samples.len())];
            let from = rng.random_range(0..other.len());
            let piece = other[from..(from + to - at).min(other.len())].to_vec();
            let replaced = if rng.random() { at..to } else { at..at };
            bytes.splice(replaced, piece);
        }
        7 => {
            let piece = NUMBERS[rng.random_range(0..NUMBERS.len())].bytes();
            let digits = |b: &u8| b.is_ascii_digit() || b".-+eE".contains(b);
            let end = at + bytes[at..].iter().take_while(|b| digits(b)).count();
            bytes.splice(at..end, piece);
        }
        8 => drop(bytes.splice(at..at, PIECES[rng.random_range(0..PIECES.len())].bytes())),
        _ => {
            let size = [1, 2, 4, 8][rng.random_range(0..4)];
            let number = EDGES[rng.random_range(0..EDGES.len())].to_le_bytes();
            let end = (at + size).min(bytes.len());
            bytes[at..end].copy_from_slice(&number[..end - at]);
        }
    }
}

/// Gives a reader its inputs; `read` says whether it accepted one.
fn fuzz(reader: &str, samples: &[Vec<u8>], read: impl Fn(&[u8], &Path) -> bool + Sync) {
    let count = from_environment("AMIGO_FUZZ", 100_000);
    let seed = from_environment("AMIGO_FUZZ_SEED", 1);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    fs::create_dir_all(&folder).unwrap();
    for sample in samples {
        let path = folder.join(format!("sample.{reader}"));
        fs::write(&path, sample).unwrap();
        assert!(read(sample, &path), "a sample of {reader} is not read");
        fs::remove_file(path).unwrap();
    }
    let start = Instant::now();
    // threads of our own: a worker of rayon that waits for polars begins another input meanwhile
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let work = &|worker: u64| {
        let path = folder.join(format!("{worker}.{reader}"));
        let (mut accepted, mut slowest) = (0_u64, 0.0_f64);
        for k in (worker..count).step_by(workers as usize) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9).wrapping_add(k));
            let input = damaged(samples, &mut rng);
            fs::write(&path, &input).unwrap();
            let begun = Instant::now();
            accepted += u64::from(read(&input, &path));
            let seconds = begun.elapsed().as_secs_f64();
            slowest = slowest.max(seconds);
            if seconds > SLOW {
                fs::write(folder.join(format!("slow-{k}.{reader}")), &input).unwrap();
            }
        }
        fs::remove_file(path).unwrap();
        (accepted, slowest)
    };
    let (accepted, slowest) = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|w| scope.spawn(move || work(w))).collect();
        let done = threads.into_iter().map(|t| t.join().expect("an input made a reader panic"));
        done.fold((0, 0.0_f64), |a, b| (a.0 + b.0, a.1.max(b.1)))
    });
    println!(
        "{reader}: {count} inputs, {accepted} accepted, {} refused, {:.1} s in all, {:.1} ms the \
         slowest",
        count - accepted,
        start.elapsed().as_secs_f64(),
        1e3 * slowest
    );
}

/// An error is in words, and not in too many.
fn in_words(message: &str) {
    assert!(!message.is_empty() && message.len() < 20_000, "{} bytes", message.len());
}

/// Panics of the Parquet reader are caught in the program; a thousand of their messages say nothing.
fn without_messages_of_the_parquet_reader() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let place = panic.location().map_or("", |location| location.file());
        if !place.contains("polars") {
            usual(panic);
        }
    }));
}

/// Reads a recording; one that is accepted keeps the promises of its type.
fn recording(path: &Path, map: &ColumnMap, unit: DriveUnit) -> bool {
    match headers(path).and_then(|_| read_recording(path, map, unit)) {
        Err(e) => {
            in_words(&e.to_string());
            false
        }
        Ok((r, sha256)) => {
            assert_eq!(sha256.len(), 64);
            assert_eq!([r.alpha().len(), r.omega().len(), r.torque().len()], [r.len(); 3]);
            assert!(r.t().windows(2).all(|t| t[0] < t[1]), "time must increase");
            let all = r.omega().iter().chain(r.torque()).flatten().chain(r.t());
            assert!(all.copied().all(f64::is_finite), "values must be finite");
            true
        }
    }
}

fn sample(name: &str) -> Vec<u8> {
    fs::read(root().join("tests/data").join(name)).unwrap()
}

/// A map from the names of a sample, in the order of the contract without t.
fn columns(unit: DriveUnit, names: [&str; 6]) -> ColumnMap {
    let mut map = ColumnMap::new(unit, Some(0.1));
    for (key, name) in ["alpha1", "alpha2", "dalpha1", "dalpha2", "M1", "M2"].iter().zip(names) {
        map.set(key, name, None, 1.0).unwrap();
    }
    map
}

fn short() -> Vec<Row> {
    motion().into_iter().take(40).collect()
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_csv() {
    let rows = short();
    let comma = |x: f64| x.to_string().replace('.', ",");
    let samples = [
        csv(&rows),
        text(&rows, "t;dalpha1;dalpha2;M1;M2", ";", comma, "\r\n"),
        format!(
            "# a note\n\n{}",
            text(
                &rows,
                "\"t\"\tdalpha1 [rad/s]\tdalpha2\tM1\tM2",
                "\t",
                |x| format!("{x:e}"),
                "\n"
            )
        ),
    ];
    let samples = samples.map(String::into_bytes);
    let map = ColumnMap::default();
    fuzz("csv", &samples, |_, path| recording(path, &map, DriveUnit::NewtonMetre));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_parquet() {
    let rows = short();
    let column = |(k, name): (usize, &str)| {
        TableColumn::Number(name.into(), rows.iter().map(|row| row[k]).collect())
    };
    let numbers: Vec<_> = HEADER.split(',').enumerate().map(column).collect();
    let texts = TableColumn::Text("note".into(), rows.iter().map(|r| r[0].to_string()).collect());
    let with_text: Vec<_> = numbers.iter().cloned().chain([texts]).collect();
    without_messages_of_the_parquet_reader();
    let bytes = |columns: &[TableColumn]| write_parquet_table(Path::new("x"), columns).unwrap();
    let samples = [bytes(&numbers), bytes(&with_text)];
    let map = ColumnMap::default();
    fuzz("parquet", &samples, |_, path| recording(path, &map, DriveUnit::NewtonMetre));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_wpilog() {
    let names = [
        "/drive/position[0]",
        "/drive/position[1]",
        "/drive/right/velocity",
        "/drive/left/velocity",
        "/drive/right/torque_128th",
        "/drive/left/torque_128th",
    ];
    let map = columns(DriveUnit::NewtonMetre, names);
    let samples = [sample("drive.wpilog")];
    fuzz("wpilog", &samples, |_, path| recording(path, &map, DriveUnit::NewtonMetre));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_mcap() {
    let wheel = |wheel: &str, what: &str| format!("{wheel}.{what}");
    let names: Vec<String> = ["position", "velocity", "effort"]
        .iter()
        .flat_map(|what| [wheel("right_wheel", what), wheel("left_wheel", what)])
        .collect();
    let names: [&str; 6] = std::array::from_fn(|i| names[i].as_str());
    let map = columns(DriveUnit::NewtonMetre, names);
    let samples = [sample("joint_states.mcap")];
    fuzz("mcap", &samples, |_, path| recording(path, &map, DriveUnit::NewtonMetre));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_mat() {
    let names = ["q(:,1)", "q(:,2)", "dq(1,:)", "dq(2,:)", "tau_128th(:,1)", "tau_128th(:,2)"];
    let map = columns(DriveUnit::NewtonMetre, names);
    let samples = [sample("v6.mat"), sample("v7.mat")];
    fuzz("mat", &samples, |_, path| recording(path, &map, DriveUnit::NewtonMetre));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_sysid() {
    let names = [
        "right_position",
        "left_position",
        "right_velocity",
        "left_velocity",
        "right_voltage",
        "left_voltage",
    ];
    let map = columns(DriveUnit::Volt, names);
    let samples = [sample("sysid.json")];
    fuzz("json", &samples, |_, path| recording(path, &map, DriveUnit::Volt));
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_experiment_file() {
    let mut samples = vec![];
    for folder in ["experiments", "measured", "benchmarks"] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                samples.push(fs::read(path).unwrap());
            }
        }
    }
    samples.sort();
    let sets = ["simulation.seed=7", "model.effects=[\"slope\"]", "title=a", "emulator.gain=1.0"];
    fuzz("toml", &samples, |bytes, _| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        // the last line of the input is an override as well
        let last = text.lines().last().unwrap_or_default().to_string();
        for set in [last, sets[bytes.len() % sets.len()].to_string()] {
            if let Err(e) = ExperimentFile::parse("e.toml", text, &[set]) {
                in_words(&e.to_string());
            }
        }
        let read = ExperimentFile::parse("e.toml", text, &[]);
        read.map_err(|e| in_words(&e.to_string())).is_ok()
    });
}

#[test]
#[ignore = "runs for minutes; prints its count"]
fn fuzz_expression() {
    let samples = [
        "k3 * w1^3",
        "f_t * sgn(beta_dot) - 0.5 * (w1 - w2) / 2",
        "b * tanh(w1 / w_s) + c * exp(-abs(w1))",
        "k * sin(alpha1 + phi) * cos(t) + sqrt(abs(w2)) - -1e-3",
    ];
    let samples = samples.map(|s| s.as_bytes().to_vec());
    fuzz("expression", &samples, |bytes, _| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        match expression::parse(text) {
            Err(e) => {
                in_words(&e.to_string());
                false
            }
            Ok(expression) => {
                let names: Vec<String> =
                    expression.variables().into_iter().map(str::to_string).collect();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let values: Vec<f64> = (0..names.len()).map(|k| 0.5 + k as f64).collect();
                let bound = expression.bind(&names).unwrap();
                // any value may come out, the same each time
                let value = bound.evaluate(&values);
                assert_eq!(value.to_bits(), bound.evaluate(&values).to_bits());
                true
            }
        }
    });
}
