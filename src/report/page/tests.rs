use super::*;
use crate::report::block::{Cell, Column, Number, Table, Text, Tone, Track};
use crate::report::figure::{Axis, Layer, Panel};
use crate::report::what_if::{Driven, Slider, WhatIf};

fn with_blocks(blocks: Vec<Block>) -> PageContent {
    let (id, title) = ("a b".into(), "<script>t".into());
    let section = SectionContent { id, title, blocks, folded: false };
    PageContent {
        title: "<script>alert(1)</script>".into(),
        subtitle: "a & b".into(),
        sections: vec![section.clone(), section],
        versions: vec![],
        footer: "\"end\"".into(),
    }
}

fn series(id: &str) -> Figure {
    let points = (0..50_000).map(|i| (f64::from(i) * 1e-3, (f64::from(i) * 0.01).sin()));
    let panel = Panel::new(Axis::linear("</script>", "s"), Axis::linear("y", ""))
        .with(Layer::line(points.collect(), "</script><b>", ColourRole::Model));
    Figure::new(id, "<img onerror=1>").with_panel(panel).interactive()
}

/// A panel in which every text is `text`.
fn simulated(text: &str) -> WhatIf {
    let [name, symbol, meaning, unit] = [(); 4].map(|()| text.to_owned());
    let recording = Driven {
        name: text.into(),
        t: vec![0.0, 0.1],
        input: vec![[0.0; 2]; 2],
        omega: vec![[0.0; 2]; 2],
        starts: vec![],
        floor: f64::NAN,
    };
    WhatIf {
        script: format!("// {text}\n// </script><b>\nfunction model() {{}}"),
        sliders: vec![Slider { name, symbol, meaning, unit, value: 1.0, half: 0.5, least: -1.0 }],
        recordings: vec![recording],
        figure: series("simulated"),
    }
}

#[test]
fn every_text_is_escaped_and_only_our_scripts_stand_on_the_page() {
    let evil = "<script>x</script>&\"'";
    let mut table = Table::new(evil, vec![Column::number(evil, evil)]);
    table.push(vec![Cell::text(evil).tone(Tone::Bad).bar(0.5), Cell::text("surplus")]);
    table.push(vec![]);
    let mut still = series("still");
    still.interactive = false;
    let html = page(&with_blocks(vec![
        Block::Heading(evil.into()),
        Block::paragraph(Text::from(evil).strong(evil).code(evil)),
        Block::verdict(Tone::Notice, evil, evil),
        Block::HowToRead { aid: evil.into(), guide: evil.into() },
        Block::Code(evil.into()),
        Block::List(vec![evil.into()]),
        Block::folded(evil, vec![Block::Heading(evil.into())]),
        Block::Numbers(vec![Number {
            label: evil.into(),
            value: evil.into(),
            ..Number::default()
        }]),
        table.into(),
        series("live").into(),
        still.into(),
        Block::Explorer(vec![Track {
            name: evil.into(),
            note: evil.into(),
            figure: series("explored"),
            path: vec![[0.0; 4], [f64::NAN; 4]],
        }]),
        Block::WhatIf(Box::new(simulated(evil))),
    ]))
    .unwrap();
    // three scripts of ours at the end, and in both sections a block of data of the live figure, the explorer
    // and the sliders
    assert_eq!(html.matches("<script").count(), 9);
    assert_eq!(html.matches("</script>").count(), 9);
    assert_eq!(html.matches("'sha256-").count(), 3);
    assert!(!html.contains("<img onerror") && !html.contains("<b>\""));
    assert!(html.contains("\\u003c/script>"));
    assert!(
        !html.contains("http://") || html.matches("http://").all(|_| html.contains("www.w3.org"))
    );
}

#[test]
fn the_policy_names_the_hashes_of_the_scripts_as_written() {
    let html = page(&PageContent::default()).unwrap();
    for (i, script) in [SORT, INTERACTIVE].into_iter().enumerate() {
        let written = html.split("<script>").nth(i + 1).unwrap();
        let written = written.split("</script>").next().unwrap();
        assert_eq!(written, script);
        assert!(html.contains(&format!("sha256-{}", BASE64.encode(Sha256::digest(written)))));
    }
    assert!(html.contains("default-src 'none'"));
}

#[test]
fn figures_are_drawn_once_named_apart_and_returned() {
    let page = render_page(&with_blocks(vec![series("run").into()])).unwrap();
    let stems: Vec<&str> = page.pictures.iter().map(|p| p.file_stem.as_str()).collect();
    assert_eq!(stems, ["run", "run-2"]);
    assert!(page.pictures.iter().all(|p| p.png.starts_with(b"\x89PNG")));
    assert!(page.html.contains("id=\"s-a-b\"") && page.html.contains("id=\"s-a-b-2\""));
    // 50 000 samples must not make a heavy page: two copies, each below 250 kB of data and picture
    assert!(page.html.len() < 900_000, "{} bytes", page.html.len());
}

#[test]
fn embedded_data_are_valid_json_with_gaps_as_null() {
    let points = vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0), (3.0, f64::INFINITY)];
    let panel = Panel::new(Axis::linear("t", "s"), Axis::linear("y", ""))
        .with(Layer::line(points.clone(), "a", ColourRole::Model))
        .with(Layer::points(points, "b", ColourRole::Measured))
        .with(Layer::hline(f64::NAN, "c", ColourRole::Ink))
        .with(Layer::Shade {
            ranges: vec![(1.0, f64::INFINITY)],
            label: String::new(),
            role: ColourRole::NoiseFloor,
        })
        .with(Layer::Band {
            x: vec![0.0, 1.0],
            lower: vec![f64::NEG_INFINITY, f64::NAN],
            upper: vec![2.0, 2.0],
            label: String::new(),
            role: ColourRole::NoiseFloor,
        });
    let text = data::json(&data::of(&Figure::new("f", "").with_panel(panel)), "f").unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let layers = &json["panels"][0]["layers"];
    // shade, band, line and dots; the line at no place is left out
    assert_eq!(layers.as_array().unwrap().len(), 4);
    assert_eq!(layers[0]["ranges"], serde_json::json!([[1.0, 2.0]]));
    assert_eq!(layers[2]["y"], serde_json::json!({ "d": 0, "v": [1, null, 2] }));
    assert_eq!(json["xs"][1], serde_json::json!({ "d": 0, "v": [0, null, 2] }));
    let low = &layers[1]["low"]["v"];
    assert!(low[0].as_f64().unwrap() < -1000.0 && low[1].is_null(), "{low}");
}

#[test]
fn the_same_content_gives_the_same_bytes() {
    let content = with_blocks(vec![series("run").into()]);
    assert_eq!(page(&content).unwrap(), page(&content).unwrap());
}

#[test]
fn a_reading_aid_brings_the_text_of_the_guide_along() {
    let aid = Block::HowToRead { aid: "So.".into(), guide: "Provenance".into() };
    let html = page(&with_blocks(vec![aid])).unwrap();
    assert!(html.contains("<p>So.</p>") && html.contains("needed to repeat the run"), "{html}");
    assert_eq!(blocks::guide("No such heading"), None);
    let staircase = blocks::guide("Error by model version").unwrap();
    assert!(staircase.starts_with("One bar") && !staircase.contains('#'), "{staircase}");
}

#[test]
fn a_table_of_many_columns_names_them_in_its_cells_and_breaks_no_value_from_its_error() {
    let with = |columns: usize| {
        let names = (0..columns).map(|n| Column::number(format!("column {n}"), "rad/s"));
        let mut table = Table::new("", names.collect());
        table.push((0..columns).map(|_| Cell::estimate(0.1234, 0.01).noted("1 ± 2")).collect());
        page(&with_blocks(vec![table.into()])).unwrap()
    };
    let (few, many) = (with(3), with(4));
    assert!(many.contains("data-label=\"column 3 [rad/s]\"") && many.contains("sortable stacked"));
    assert!(!few.contains("data-label=") && !few.contains("sortable stacked"));
    assert!(few.contains("0.123\u{a0}±\u{a0}0.010") && few.contains("1\u{a0}±\u{a0}2"));
}
