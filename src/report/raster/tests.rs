use super::*;
use crate::report::figure::{
    Axis, BarSeries, Bars, ColorMap, ColourRole, Dash, ErrorBar, HeatMap, Layer, Panel, Size,
};
use crate::report::page::{PageContent, SectionContent, render_page};

/// Values that break careless drawing code, as series.
fn awkward() -> Vec<(&'static str, Vec<(f64, f64)>)> {
    vec![
        ("empty", vec![]),
        ("single", vec![(1.0, 2.0)]),
        ("constant", (0..10).map(|i| (f64::from(i), 3.0)).collect()),
        ("one place", vec![(1.0, 1.0); 5]),
        ("missing", vec![(f64::NAN, f64::NAN); 4]),
        ("gaps", vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 2.0), (f64::INFINITY, 3.0), (4.0, 1.0)]),
        ("infinite", vec![(0.0, f64::INFINITY), (1.0, f64::NEG_INFINITY), (2.0, 0.0)]),
        ("huge", vec![(-1e308, -1e308), (0.0, 0.0), (1e308, 1e308)]),
        ("tiny", vec![(0.0, 1e-320), (1e-310, 5e-324), (1e-300, 1e-300)]),
        ("nearly constant", vec![(0.0, 1.0), (1.0, 1.0 + 1e-15)]),
        ("negative", vec![(-2.0, -3.0), (-1.0, -1e-9)]),
        ("backwards", vec![(3.0, 0.0), (1.0, 2.0), (2.0, 1.0)]),
        ("many", (0..30_000).map(|i| (f64::from(i), f64::from(i % 7) - 3.0)).collect()),
    ]
}

/// Every kind of layer made of numbers.
fn layers(points: &[(f64, f64)]) -> Vec<Layer> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let bar = |p: &(f64, f64)| ErrorBar { x: p.0, y: p.1, lower: p.1 - 1.0, upper: f64::INFINITY };
    vec![
        Layer::line(points.to_vec(), "line", ColourRole::Model),
        Layer::Line {
            points: points.iter().take(50).copied().collect(),
            label: "<dots> & \"more\"\u{0}\u{7}".into(),
            role: ColourRole::Ink,
            width: 1.0,
            dash: Dash::Dotted,
        },
        Layer::points(points.to_vec(), "points", ColourRole::Measured),
        Layer::Band {
            upper: y.iter().map(|v| v + 1.0).collect(),
            lower: y.clone(),
            x: x.clone(),
            label: "band".into(),
            role: ColourRole::NoiseFloor,
        },
        Layer::hline(y.first().copied().unwrap_or(f64::NAN), "h", ColourRole::Highlight),
        Layer::vline(x.first().copied().unwrap_or(f64::NAN), "v", ColourRole::Wheel1),
        Layer::Shade {
            ranges: points.iter().take(50).copied().collect(),
            label: "shade".into(),
            role: ColourRole::Wheel2,
        },
        Layer::ErrorBars {
            points: points.iter().take(50).map(bar).collect(),
            label: "bars".into(),
            role: ColourRole::Series(9),
        },
    ]
}

fn awkward_figures() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (name, points) in awkward() {
        let mut figure =
            Figure::new(name, format!("<script> {name}")).with_columns(2).interactive();
        for axes in [
            (Axis::linear("x", "s"), Axis::linear("y", "rad/s")),
            (Axis::log("x", "s"), Axis::log("y", "rad/s")),
        ] {
            let mut panel = Panel::new(axes.0, axes.1).with_title(name);
            panel.layers = layers(&points);
            figure = figure.with_panel(panel);
        }
        figures.push(figure);
        let values: Vec<f64> = points.iter().take(30).map(|p| p.1).collect();
        figures.push(named_figure(name, &values, Axis::linear("gain", "")));
        figures.push(named_figure(name, &values, Axis::log("gain", "")));
    }
    figures
}

/// Bars and both kinds of heat map with names too long for their place.
fn named_figure(name: &str, values: &[f64], axis: Axis) -> Figure {
    let names: Vec<String> = (0..values.len())
        .map(|i| format!("effect {i} with a name beyond all room & reason"))
        .collect();
    let mut series = BarSeries::new("gain", ColourRole::Series(0), values.to_vec());
    series.intervals = values.iter().map(|v| (v - 1.0, v * 2.0)).collect();
    series.text = values.iter().map(|v| format!("{v:.3e}")).collect();
    let bars = Bars { categories: names.clone(), series: vec![series], highlight: Some(99) };
    let map = |colors| {
        Layer::HeatMap(HeatMap {
            rows: names.clone(),
            columns: names.clone(),
            values: values.iter().map(|_| values.to_vec()).collect(),
            text: vec![vec!["1.00".into()]],
            colors,
            label: "size".into(),
            unit: "N m".into(),
            range: None,
        })
    };
    let value = Panel::new(axis, Axis::unlabelled());
    let plain = || Panel::new(Axis::unlabelled(), Axis::unlabelled());
    Figure::new(format!("{name}-named"), "")
        .with_panel(value.with(Layer::Bars(bars)))
        .with_panel(plain().with(map(ColorMap::Diverging)))
        .with_panel(plain().with(map(ColorMap::Sequential)))
}

#[test]
fn every_layer_draws_every_awkward_series_without_panic() {
    for figure in awkward_figures() {
        let svg = figure_to_svg(&figure).unwrap_or_else(|e| panic!("{}: {e}", figure.id));
        assert!(svg.starts_with("<svg"), "{}", figure.id);
        let (_, drawing) = svg.split_once("</desc>").unwrap();
        assert!(!drawing.contains("NaN") && !drawing.contains("inf"), "{}", figure.id);
        // text became paths
        assert!(!svg.contains("<text"), "{}", figure.id);
    }
}

#[test]
fn a_page_of_awkward_figures_is_written() {
    let blocks = awkward_figures().into_iter().map(Into::into).collect();
    let (id, title) = ("all".into(), "all".into());
    let section = SectionContent { id, title, blocks, folded: false };
    let page = render_page(&PageContent { sections: vec![section], ..Default::default() }).unwrap();
    assert_eq!(page.pictures.len(), 3 * awkward().len());
}

#[test]
fn a_png_has_two_pixels_per_css_pixel_and_repeats_to_the_byte() {
    let mut figure = Figure::new("size", "Title").with_panel(
        Panel::new(Axis::linear("t", "s"), Axis::linear("y", "")).with(Layer::line(
            vec![(0.0, 0.0), (1.0, 1.0)],
            "",
            ColourRole::Model,
        )),
    );
    figure.size = Size { width: 500.0, height: Some(400.0) };
    let png = figure_to_png(&figure).unwrap();
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    // IHDR: width and height follow the eight bytes of signature and eight of chunk header
    // 500 px of 820 that are 7.16 in at 300 dpi: 500 / 820 * 2148
    assert_eq!(number(16), 1310);
    assert!((1035..=1051).contains(&number(20)), "{}", number(20));
    // pHYs: 300 / 0.0254 pixels to the metre
    let place = png.windows(4).position(|w| w == b"pHYs").unwrap();
    assert_eq!((number(place + 4), number(place + 8), png[place + 12]), (11811, 11811, 1));
    assert_eq!(png, figure_to_png(&figure).unwrap());
}

#[test]
fn absurd_sizes_and_no_panels_are_drawn_all_the_same() {
    for size in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e9] {
        let mut figure = Figure::new("absurd", "A title that must be broken into several lines");
        figure.size = Size { width: size, height: Some(1.0) };
        assert!(figure_to_svg(&figure).is_ok(), "{size}");
    }
}

#[test]
fn the_picture_shows_the_line_where_the_data_are() {
    // a horizontal line at the middle of the axis: its pixels are vermilion, those above it white
    let points = vec![(0.0, 0.5), (1.0, 0.5)];
    let y = Axis::linear("", "").with_range(0.0, 1.0);
    let panel = Panel::new(Axis::linear("", ""), y).with(Layer::Line {
        points,
        label: String::new(),
        role: ColourRole::Model,
        width: 4.0,
        dash: Dash::Solid,
    });
    let png = figure_to_png(&Figure::new("line", "").with_panel(panel)).unwrap();
    let picture = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
    let is = |x: u32, y: u32, color: (u8, u8, u8)| {
        picture.pixel(x, y).is_some_and(|p| (p.red(), p.green(), p.blue()) == color)
    };
    let x = picture.width() / 2;
    let rows: Vec<u32> = (0..picture.height()).filter(|y| is(x, *y, (0xD5, 0x5E, 0x00))).collect();
    // 4 px at 2.62 pixels each, one lost to anti-aliasing at either side at most
    assert!((8..=11).contains(&rows.len()), "{rows:?}");
    assert!(is(x, rows[0] - 4, (0xFF, 0xFF, 0xFF)));
}

#[test]
fn a_map_widens_one_range_until_a_unit_is_as_long_in_x_as_in_y() {
    use crate::report::plot::{Purpose, draw};
    let square = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    let panel = Panel::new(Axis::linear("x", "m"), Axis::linear("y", "m"))
        .with_equal_units()
        .with(Layer::line(square, "", ColourRole::Model));
    let svg = draw(&Figure::new("map", "").with_panel(panel), Purpose::Inline).unwrap();
    // the line is the only mark in the model's colour
    let line = svg.lines().find(|l| l.contains(&ColourRole::Model.color().hex())).unwrap();
    let points = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
    let numbers: Vec<f64> =
        points.split([',', ' ']).filter_map(|number| number.parse().ok()).collect();
    let side = |k: usize| {
        let own = || numbers.iter().skip(k).step_by(2);
        own().fold(0.0_f64, |a, b| a.max(*b)) - own().fold(f64::INFINITY, |a, b| a.min(*b))
    };
    assert!(side(0) > 50.0 && (side(0) - side(1)).abs() < 1.0, "{} {}", side(0), side(1));
}

#[test]
fn a_drawing_states_in_words_what_it_shows_and_is_as_wide_on_paper_as_its_picture() {
    let panel = Panel::new(Axis::linear("x", "m"), Axis::linear("y", "m")).with(Layer::line(
        vec![(0.0, 0.0), (1.0, 1.0)],
        "",
        ColourRole::Model,
    ));
    let figure = Figure::new("f", "Error < floor").with_caption("Of <b>.").with_panel(panel);
    let svg = figure_to_svg(&figure).unwrap();
    assert!(svg.contains("role=\"img\"") && svg.contains("width=\"7.1600in\""), "{}", &svg[..200]);
    assert!(svg.contains("<title>Error &lt; floor</title><desc>Of &lt;b&gt;.</desc>"));
    // still a drawing that readers of SVG take
    assert!(Tree::from_str(&svg, &Options::default()).is_ok());
}
