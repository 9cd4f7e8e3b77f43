//! The exported model in Modelica, compiled and simulated where a compiler is at hand.

use std::process::Command;

use amigo_ident::model::Model;
use amigo_ident::robot::Robot;

use crate::exported::{
    Exported, agrees, input, is_here, model, models, prepared, run, states, written,
};
use crate::support::Folder;

/// States and input of this test in Modelica, which reads no plain table of numbers by itself.
fn modelica() -> String {
    let numbers = |row: &[f64; 7]| row.map(|v| format!("{v:?}")).join(", ");
    let table: Vec<String> = states().iter().map(numbers).collect();
    format!(
        "package Test
  constant Real table[{rows}, 7] = {{{{{table}}}}};
  function point
    input Real t;
    output Real a[2];
  protected
    Integer k;
  algorithm
    k := integer(floor(t + 1.5));
    a := TwoWheelRobot.acceleration(table[k, 1], table[k, 2:3], table[k, 4:5], table[k, 6:7]);
  end point;
  function sampled
    input Real k;
    output Real M[2];
  protected
    Real t;
    Real on;
  algorithm
    t := 0.002 * k;
    on := if k >= 1500 and k < 2000 then 0.2 else 1.0;
    M := {{on * 0.35 * sin(2.1 * t) + 0.03, on * 0.33 * sin(1.7 * t + 0.4)}};
  end sampled;
  function moment
    input Real t;
    output Real M[2];
  protected
    Real k;
    Real share;
  algorithm
    k := floor(500 * t + 1e-6);
    share := max(500 * t - k, 0);
    M := (1 - share) * sampled(k) + share * sampled(k + 1);
  end moment;
  model Point
    Real a[2];
  equation
    a = point(time);
  end Point;
  model Drive
    TwoWheelRobot.Robot robot;
  equation
    robot.M = moment(time);
  end Drive;
end Test;
",
        rows = states().len(),
        table = table.join("}, {")
    )
}

const OMC: &str = r#"
loadFile("model.mo"); getErrorString();
loadFile("test.mo"); getErrorString();
simulate(Test.Point, stopTime=199, numberOfIntervals=199, outputFormat="csv"); getErrorString();
simulate(Test.Drive, stopTime=6, numberOfIntervals=3000, outputFormat="csv"); getErrorString();
"#;

const RUMOCA: &str = r#"
import rumoca
source = open("model.mo").read() + open("test.mo").read()
for name, end, dt in (("Test.Point", 199, 1), ("Test.Drive", 6, 0.002)):
    motion = rumoca.Session().loads(source, model=name).simulate(t=(0, end), dt=dt)
    names = [n for n in motion.names if n != "time"]
    with open(name + "_res.csv", "w") as out:
        print(*(f'"{n}"' for n in ["time"] + names), sep=",", file=out)
        for row in zip(motion.time, *(motion[n] for n in names)):
            print(*(repr(float(v)) for v in row), sep=",", file=out)
"#;

/// The last row at each multiple of `step`: a solver writes two where a sample falls.
fn picked(folder: &Folder, file: &str, columns: &[&str], step: f64, rows: usize) -> String {
    let text = folder.read(file);
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').map(|n| n.trim_matches('"')).collect();
    let place = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let (time, wanted): (_, Vec<usize>) =
        (place("time"), columns.iter().map(|c| place(c)).collect());
    let mut out = vec![String::new(); rows];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let at = cells[time].parse::<f64>().unwrap() / step;
        if (at - at.round()).abs() < 1e-6 {
            out[at.round() as usize] =
                wanted.iter().map(|&c| cells[c]).collect::<Vec<_>>().join(" ");
        }
    }
    out.join("\n") + "\n"
}

/// Compares what a Modelica compiler left in the folder.
fn modelica_agrees(compiler: &str, model: &Exported, folder: &Folder) {
    let point = picked(folder, "Test.Point_res.csv", &["a[1]", "a[2]"], 1.0, states().len());
    let names = ["robot.alpha[1]", "robot.alpha[2]", "robot.omega[1]", "robot.omega[2]"];
    let input = picked(folder, "Test.Drive_res.csv", &names, 0.002, input().len());
    agrees(compiler, model, &(point + &input));
}

#[test]
fn the_modelica_model_moves_in_openmodelica_as_the_program_does() {
    for model in models().iter().filter(|_| is_here("omc")) {
        let folder = prepared(model, "test.mo", &modelica());
        folder.write("run.mos", OMC);
        println!("{}", run(&folder, "omc", &["run.mos"]));
        modelica_agrees("omc", model, &folder);
    }
}

#[test]
fn the_modelica_model_moves_in_rumoca_as_the_program_does() {
    let import = Command::new("python3").args(["-c", "import rumoca"]).output();
    if !import.is_ok_and(|o| o.status.success()) {
        println!("skipped: python3 has no package rumoca on this machine");
        return;
    }
    // it interprets: the slip, which takes several parts a step, and affine rules would take minutes
    let models = models();
    for model in [&models[0], &models[2], &models[3], &models[5]] {
        let folder = prepared(model, "test.mo", &modelica());
        folder.write("main.py", RUMOCA);
        run(&folder, "python3", &["main.py"]);
        modelica_agrees("rumoca", model, &folder);
    }
}

/// The statements of a function of the model, without indentation, between two lines.
fn body(text: &str, from: &str, to: &str) -> Vec<String> {
    let lines = text.lines().map(|line| line.trim().to_owned());
    lines.skip_while(|l| !l.starts_with(from)).skip(1).take_while(|l| !l.starts_with(to)).collect()
}

#[test]
fn the_modelica_formulas_are_those_that_octave_ran_in_another_spelling() {
    // where no Modelica compiler is at hand, this remains
    let written = written(&model());
    let of = |name: &str| &written.iter().find(|(file, _)| file == name).unwrap().1;
    let octave = body(of("model.m"), "mass = zeros", "end");
    let modelica: Vec<String> = body(of("model.mo"), "Real x[", "end terms")
        .into_iter()
        .skip(1)
        .map(|line| {
            let named = (0..99)
                .rev()
                .fold(line, |line, k| line.replace(&format!("x[{}]", k + 1), &format!("x{k}")));
            named.replace(":=", "=").replace('[', "(").replace(']', ")")
        })
        .collect();
    assert!(octave.len() > 20 && octave.last().unwrap().starts_with("level(4) = "));
    assert_eq!(modelica, octave);
}

#[test]
fn the_modelica_file_of_a_small_model_is_as_it_was_read_through() {
    let model = Model::with_effects(Robot::amigobot(), &["viscous_friction", "stribeck"]).unwrap();
    let (_, text) = written(&model).into_iter().find(|(name, _)| name == "model.mo").unwrap();
    let generated: Vec<&str> =
        text.lines().take_while(|line| !line.contains("function solve")).collect();
    insta::assert_snapshot!(generated.join("\n"));
}
