//! Draws one figure of every kind, and a page of all blocks, into the folder given as argument, to
//! inspect changes of the drawing code.

use std::path::PathBuf;

use amigo_ident::report::block::{Block, Cell, Column, Table, Text, Tone};
use amigo_ident::report::figure::{
    Axis, BarSeries, Bars, ColorMap, ColourRole, Dash, ErrorBar, Figure, HeatMap, Layer, Panel,
};
use amigo_ident::report::{PageContent, SectionContent, figure_to_png, figure_to_svg, page};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "sheet".to_owned()));
    std::fs::create_dir_all(&folder)?;
    for figure in
        [time_series(), residuals(), convergence(), intervals(), evidence(), groups(), map()]
    {
        std::fs::write(
            folder.join(format!("{}.png", figure.file_stem())),
            figure_to_png(&figure)?,
        )?;
        std::fs::write(
            folder.join(format!("{}.svg", figure.file_stem())),
            figure_to_svg(&figure)?,
        )?;
    }
    std::fs::write(folder.join("page.html"), page(&content())?)?;
    Ok(())
}

/// A reproducible disturbance between −1 and 1.
fn noise(i: usize) -> f64 {
    let hash = (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(31);
    (hash.wrapping_mul(0xD1B5_4A32_D192_ED03) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn time_series() -> Figure {
    let time = |i: usize| i as f64 * 0.005;
    let speed = |t: f64, wheel: f64| 4.0 * (0.8 * t).sin() + wheel * (1.0 - (-t).exp());
    let panel = |wheel: f64, name: &str| {
        let measured = (0..2401).map(|i| (time(i), speed(time(i), wheel) + 0.15 * noise(i)));
        let model = (0..2401).map(|i| (time(i), speed(time(i), wheel) * 0.97));
        Panel::new(Axis::linear("time", "s"), Axis::linear(name, "rad/s"))
            .with(Layer::Shade {
                ranges: vec![(2.0, 3.4), (6.0, 7.1)],
                label: "turning".to_owned(),
                role: ColourRole::NoiseFloor,
            })
            .with(Layer::points(measured.collect(), "measured", ColourRole::Measured))
            .with(Layer::line(model.collect(), "model", ColourRole::Model))
    };
    let residual = (0..2401).map(|i| (time(i), 0.15 * noise(i) + 0.03 * speed(time(i), 1.0)));
    Figure::new("time-series", "The model follows both wheels within the noise except in turns")
        .with_subtitle("AmigoBot, 12 s at 200 Hz, simulated from the first sample")
        .with_caption("Measured and simulated angular speed of the wheels.")
        .with_panel(panel(1.0, "ω₁"))
        .with_panel(panel(-1.0, "ω₂"))
        .with_panel(
            Panel::new(Axis::linear("time", "s"), Axis::linear("residual of ω̇₁", "rad/s"))
                .with(Layer::Band {
                    x: vec![0.0, 12.0],
                    lower: vec![-0.1; 2],
                    upper: vec![0.1; 2],
                    label: "noise floor (95 %)".to_owned(),
                    role: ColourRole::NoiseFloor,
                })
                .with(Layer::line(residual.collect(), "", ColourRole::Wheel1)),
        )
        .interactive()
}

fn residuals() -> Figure {
    let dots = |role, wheel: usize| {
        let dot = |i: usize| (6.0 * noise(i + 5000 * wheel), 0.4 * noise(3 * i + wheel));
        Layer::points((0..3000).map(dot).collect(), format!("wheel {wheel}"), role)
    };
    let curve: Vec<_> =
        (-60..=60).map(|i| 0.1 * f64::from(i)).map(|v| (v, 0.25 * (3.0 * v).tanh())).collect();
    let panel = |title: &str| {
        Panel::new(Axis::linear("speed ω", "rad/s"), Axis::linear("residual torque", "N m"))
            .with_title(title)
    };
    Figure::new(
        "residuals",
        "What the model leaves over jumps at standstill: a friction term is missing",
    )
    .with_columns(2)
    .with_panel(
        panel("Before").with(dots(ColourRole::Wheel1, 1)).with(dots(ColourRole::Wheel2, 2)).with(
            Layer::Line {
                points: curve,
                label: "Coulomb".into(),
                role: ColourRole::Ink,
                width: 1.8,
                dash: Dash::Dashed,
            },
        ),
    )
    .with_panel(
        panel("After")
            .with(dots(ColourRole::Wheel1, 1))
            .with(Layer::hline(0.3, "3σ", ColourRole::Highlight))
            .with(Layer::vline(-2.0, "slip begins", ColourRole::Ink)),
    )
}

fn convergence() -> Figure {
    let cost = |i: usize, rate: f64| (i as f64, 40.0 * (-rate * i as f64).exp() + 3e-5);
    let lines = [("Levenberg–Marquardt", 0.6), ("L-BFGS", 0.3), ("Nelder–Mead", 0.11)];
    let mut panel = Panel::new(Axis::linear("iteration", ""), Axis::log("cost", "rad²/s²"));
    for (n, (name, rate)) in lines.into_iter().enumerate() {
        let points = (0..80).map(|i| cost(i, rate)).collect();
        panel = panel.with(Layer::line(points, name, ColourRole::Series(n)));
    }
    panel = panel.with(Layer::Band {
        x: (0..80).map(f64::from).collect(),
        lower: (0..80).map(|i| cost(i, 0.11).1 * 0.5).collect(),
        upper: (0..80).map(|i| cost(i, 0.11).1 * 2.0).collect(),
        label: "10 to 90 % of starts".into(),
        role: ColourRole::Series(2),
    });
    Figure::new("convergence", "Three solvers, one minimum").with_panel(panel)
}

fn intervals() -> Figure {
    let points = (1..=5).map(|i| f64::from(i) * 100.0).map(|x| ErrorBar {
        x,
        y: 0.02 + 0.5 / x,
        lower: 0.02 - 1.0 / x,
        upper: if x > 450.0 { f64::INFINITY } else { 0.02 + 2.0 / x },
    });
    let panel = Panel::new(Axis::log("samples", ""), Axis::linear("a₄", "N m"))
        .with(Layer::hline(0.02, "true value", ColourRole::Ink))
        .with(Layer::ErrorBars {
            points: points.collect(),
            label: "estimate with 95 % interval".into(),
            role: ColourRole::Measured,
        });
    Figure::new("intervals", "The interval narrows with the square root of the record")
        .with_panel(panel)
}

fn evidence() -> Figure {
    let names = [
        "Coulomb friction",
        "viscous friction",
        "Stribeck curve with a very long name that needs two lines of text",
        "caster wheel",
        "motor dead zone",
        "unequal wheel radii",
    ];
    let values = vec![412.0, 35.2, 18.4, 6.1, 1.2, -0.8];
    let mut series = BarSeries::new("", ColourRole::Series(0), values.clone());
    series.text = values.iter().map(|v| amigo_ident::report::format::number(*v)).collect();
    series.intervals = values.iter().map(|v| (v - 8.0, v + 8.0)).collect();
    let bars = Bars {
        categories: names.map(str::to_owned).to_vec(),
        series: vec![series],
        highlight: Some(0),
    };
    Figure::new("evidence", "Coulomb friction explains the residual best")
        .with_subtitle("Gain in log likelihood by each candidate effect")
        .with_panel(
            Panel::new(Axis::linear("gain in log likelihood", ""), Axis::unlabelled())
                .with(Layer::Bars(bars))
                .with(Layer::vline(60.0, "detection limit", ColourRole::Ink)),
        )
}

fn groups() -> Figure {
    let names = ["straight", "left turn", "right turn", "standstill and creeping", "reverse"];
    let series = |n: usize, name: &str| {
        let mut series = BarSeries::new(
            name,
            ColourRole::Series(n),
            (0..5).map(|i| 0.02 + 0.01 * ((i * (n + 2)) % 5) as f64).collect(),
        );
        series.intervals = series.values.iter().map(|v| (0.8 * v, 1.3 * v)).collect();
        series
    };
    let bars = Bars {
        categories: names.map(str::to_owned).to_vec(),
        series: vec![
            series(0, "least squares"),
            series(1, "instrumental variables"),
            series(2, "output error"),
        ],
        highlight: None,
    };
    let long = Bars {
        categories: (0..24).map(|i| format!("candidate effect number {i}")).collect(),
        series: vec![BarSeries::new(
            "",
            ColourRole::Measured,
            (0..24).map(|i| f64::from(i) - 7.0).collect(),
        )],
        highlight: Some(3),
    };
    Figure::new("groups", "Output error wins in every regime")
        .with_columns(1)
        .with_panel(
            Panel::new(Axis::linear("RMSE", "rad/s"), Axis::unlabelled()).with(Layer::Bars(bars)),
        )
        .with_panel(
            Panel::new(Axis::linear("gain", ""), Axis::unlabelled()).with(Layer::Bars(long)),
        )
}

fn map() -> Figure {
    let names: Vec<String> = ["a1", "a2", "a3", "a4", "a5"].map(str::to_owned).to_vec();
    let value =
        |r: usize, c: usize| if r == c { 1.0 } else { ((r * 7 + c * 7 + r * c) as f64).sin() };
    let values: Vec<Vec<f64>> = (0..5).map(|r| (0..5).map(|c| value(r, c)).collect()).collect();
    let text = values
        .iter()
        .map(|row| row.iter().map(|v| amigo_ident::report::format::fixed(*v, 2)).collect())
        .collect();
    let correlation = HeatMap {
        rows: names.clone(),
        columns: names,
        values,
        text,
        colors: ColorMap::Diverging,
        label: "correlation".into(),
        unit: String::new(),
        range: Some((-1.0, 1.0)),
    };
    let many =
        |n: usize| (0..n).map(|i| format!("{:.1}", i as f64 * 0.4 - 6.0)).collect::<Vec<_>>();
    let field: Vec<Vec<f64>> = (0..30)
        .map(|r| {
            (0..30)
                .map(|c| if r + c < 8 { f64::NAN } else { 2e-4 * (r as f64 * c as f64).sqrt() })
                .collect()
        })
        .collect();
    let rms = HeatMap {
        rows: many(30),
        columns: many(30),
        values: field,
        text: vec![],
        colors: ColorMap::Sequential,
        label: "RMS residual".into(),
        unit: "N m".into(),
        range: None,
    };
    Figure::new("map", "a4 and a5 move together")
        .with_columns(2)
        .with_panel(
            Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(correlation)),
        )
        .with_panel(
            Panel::new(Axis::linear("ω₁", "rad/s"), Axis::linear("ω₂", "rad/s"))
                .with(Layer::HeatMap(rms)),
        )
}

fn content() -> PageContent {
    let section = |id: &str, title: &str, blocks| SectionContent {
        id: id.to_owned(),
        title: title.to_owned(),
        blocks,
        folded: false,
    };
    PageContent {
        title: "Floor run of 3 March".to_owned(),
        subtitle: "floor.toml · 2 recordings · 12 s at 200 Hz · program 0.1.0 · seed 1".to_owned(),
        sections: vec![
            section("verdict", "What is missing", verdict()),
            section("fit", "How well the model follows", fit()),
            section("evidence", "Evidence", pictures()),
        ],
        versions: vec![],
        footer: "Repeat with: experiment floor.toml\nSHA-256 of the recording: 5d41402abc4b2a76"
            .to_owned(),
    }
}

fn verdict() -> Vec<Block> {
    vec![
        Block::verdict(
            Tone::Bad,
            "A friction term is missing: Coulomb friction explains 93 % of the excess.",
            "Gain in log likelihood 412 ± 8; the next candidate gains 35. p < 10⁻⁹ against the noise floor.",
        ),
        Block::verdict(
            Tone::Notice,
            "a4 and a5 are indistinguishable from these data.",
            "Rank 4 of 5; record a turn.",
        ),
        Block::verdict(Tone::Good, "The wheels' encoders agree with the noise model.", ""),
        Block::paragraph(
            Text::from("Add ")
                .code("coulomb_friction")
                .plain(" to the model and run again. The estimate of ")
                .strong("a₃")
                .plain(" moves by less than its standard error."),
        ),
        Block::Code(
            "experiment --set model.effects='[\"inertia\", \"coulomb_friction\"]' floor.toml"
                .into(),
        ),
    ]
}

fn fit() -> Vec<Block> {
    let mut table = Table::new(
        "Estimates of the paper's parameters by output error.",
        vec![
            Column::text("Parameter"),
            Column::text("Meaning"),
            Column::number("Estimate", "kg m², N m"),
            Column::number("p-value", ""),
            Column::number("Share of ISE", "%"),
        ],
    );
    let rows = [
        ("a1", "inertia of a wheel and its share of the body", 0.0412, 0.0003, 1e-12, 0.81),
        ("a2", "coupling inertia", -0.0041, 0.0009, 2.3e-5, 0.12),
        ("a3", "centrifugal coupling", 1.2e-4, 2.1e-5, 0.034, 0.05),
        ("a4", "Coulomb friction of wheel 1", 0.081, f64::INFINITY, 0.5, 0.02),
        ("a5", "Coulomb friction of wheel 2", f64::NAN, 0.1, f64::NAN, f64::NAN),
    ];
    for (name, meaning, value, error, p, share) in rows {
        let estimate = Cell::estimate(value, error);
        let estimate = if error.is_infinite() { estimate.tone(Tone::Bad) } else { estimate };
        table.push(vec![
            Cell::text(name).strong(),
            Cell::text(meaning),
            estimate,
            Cell::p_value(p),
            Cell::number(100.0 * share).bar(share),
        ]);
    }
    let aid = "Dots are what the encoders measured, the line what the model predicts from the start. Grey ranges are turns.";
    vec![
        Block::Heading("Estimates".into()),
        table.into(),
        Block::Heading("Simulation".into()),
        time_series().with_how_to_read(aid).into(),
        Block::List(vec![
            "straight driving: within the noise".into(),
            "turning: 3.1 times the noise".into(),
        ]),
        residuals().interactive().into(),
    ]
}

fn pictures() -> Vec<Block> {
    vec![
        evidence().with_caption("Bars: gain; whiskers: bootstrap interval.").into(),
        convergence().interactive().into(),
        intervals().interactive().into(),
        groups().into(),
        map().into(),
        Block::HowToRead {
            aid: "Red cells move together, blue ones against each other.".into(),
            guide: String::new(),
        },
    ]
}
