//! Blocks as HTML. Every text is escaped by maud; only drawings made here pass as they are.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{Markup, PreEscaped, html};

use super::{Drawn, PageData, explorer, what_if};
use crate::report::block::{Align, Block, Cell, Column, Number, Span, Table, Text, Tone};

/// Writes blocks in order and numbers figures and tables through the page.
pub(super) struct Writer<'a> {
    drawn: std::slice::Iter<'a, Drawn<'a>>,
    explorers: std::slice::Iter<'a, String>,
    what_ifs: std::slice::Iter<'a, String>,
    figures: usize,
    tables: usize,
}

impl<'a> Writer<'a> {
    pub(super) fn new(drawn: &'a [Drawn<'a>], data: &'a PageData) -> Self {
        Self {
            drawn: drawn.iter(),
            explorers: data.explorers.iter(),
            what_ifs: data.what_ifs.iter(),
            figures: 0,
            tables: 0,
        }
    }

    pub(super) fn blocks(&mut self, blocks: &[Block]) -> Markup {
        html! { @for block in blocks { (self.block(block)) } }
    }

    fn block(&mut self, block: &Block) -> Markup {
        match block {
            Block::Heading(heading) => html! { h3 { (heading) } },
            Block::Paragraph(paragraph) => html! { p { (text(paragraph)) } },
            Block::Verdict { tone, sentence, rest, detail } => {
                verdict(*tone, [sentence, rest], detail)
            }
            Block::Numbers(all) => numbers(all),
            Block::Table(shown) => {
                self.tables += 1;
                table(shown, self.tables)
            }
            // the figures were drawn in the order in which they are met here
            Block::Figure(_) => match self.drawn.next() {
                Some(drawn) => {
                    self.figures += 1;
                    figure(drawn, self.figures)
                }
                None => Markup::default(),
            },
            Block::Folded { title, blocks } => {
                html! { details.more { summary { (title) } (self.blocks(blocks)) } }
            }
            Block::HowToRead { aid, guide } => how_to_read(aid, guide),
            Block::List(items) => html! { ul { @for item in items { li { (text(item)) } } } },
            Block::Code(code) => html! { pre { code { (code) } } },
            // their data were written in the order in which they are met here
            Block::Explorer(tracks) => match self.explorers.next() {
                Some(json) => explorer::markup(tracks, json),
                None => Markup::default(),
            },
            Block::WhatIf(panel) => match self.what_ifs.next() {
                Some(json) => what_if::markup(panel, json),
                None => Markup::default(),
            },
        }
    }
}

fn text(text: &Text) -> Markup {
    html! {
        @for span in &text.0 {
            @match span {
                Span::Plain(text) => (text),
                Span::Strong(text) => strong { (text) },
                Span::Code(text) => code { (text) },
            }
        }
    }
}

fn verdict(tone: Tone, [sentence, rest]: [&str; 2], detail: &Text) -> Markup {
    let word = match tone {
        Tone::Good => "✓",
        Tone::Neutral => "",
        Tone::Notice => "!",
        Tone::Bad => "✗",
    };
    html! {
        div.verdict.(tone_name(tone)) {
            p.sentence {
                @if !word.is_empty() { span.word aria-hidden="true" { (word) } }
                (sentence)
            }
            @if !rest.is_empty() { p.rest { (rest) } }
            @if *detail != Text::default() { p.detail { (text(detail)) } }
        }
    }
}

fn numbers(all: &[Number]) -> Markup {
    html! {
        dl.numbers {
            @for number in all {
                div.(tone_name(number.tone)) {
                    dt { (number.label) }
                    dd.value {
                        (number.value)
                        @if !number.unit.is_empty() { " " span.unit { (number.unit) } }
                    }
                    @if !number.note.is_empty() { dd.note { (number.note) } }
                }
            }
        }
    }
}

fn tone_name(tone: Tone) -> &'static str {
    match tone {
        Tone::Good => "good",
        Tone::Neutral => "neutral",
        Tone::Notice => "notice",
        Tone::Bad => "bad",
    }
}

/// The guide, whose section texts are included in the report, because a report may be opened on another
/// computer.
const GUIDE: &str = include_str!("../../../docs/guide.md");

fn how_to_read(aid: &str, heading: &str) -> Markup {
    html! {
        details {
            summary { "How to read this" }
            p { (aid) }
            @if let Some(text) = guide(heading) {
                p {
                    @for (k, piece) in text.split('`').enumerate() {
                        @if k % 2 == 1 { code { (piece) } } @else { (piece) }
                    }
                }
            }
        }
    }
}

/// Text of the guide under a heading of the third level.
pub(super) fn guide(heading: &str) -> Option<String> {
    let (_, behind) = GUIDE.split_once(&format!("\n### {heading}\n"))?;
    let text = behind.split("\n#").next()?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Number of columns from which a phone shows every row as a block, with the column headings beside the
/// cells.
const LEAST_STACKED: usize = 4;
/// Largest number of rows for this layout: longer tables scroll sideways.
const MOST_STACKED: usize = 100;

fn table(table: &Table, number: usize) -> Markup {
    let class = |align: Align| if align == Align::Right { "number" } else { "" };
    let is_stacked = table.columns.len() >= LEAST_STACKED && table.rows.len() <= MOST_STACKED;
    let label = |column: &Column| match column.unit.as_str() {
        "" => column.title.clone(),
        unit => format!("{} [{unit}]", column.title),
    };
    html! {
        div.table {
            table.sortable.stacked[is_stacked] {
                caption { b { "Table " (number) } " " (table.caption) }
                thead {
                    tr {
                        @for column in &table.columns {
                            th scope="col" class=(class(column.align)) {
                                (column.title)
                                @if !column.unit.is_empty() { " " span.unit { "[" (column.unit) "]" } }
                            }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr {
                            @for (i, column) in table.columns.iter().enumerate() {
                                @match row.get(i) {
                                    Some(shown) => {
                                        @let label = is_stacked.then(|| label(column));
                                        @let is_head = is_stacked && i <= table.further_heads;
                                        (cell(shown, [class(column.align), if is_head { "head" } else { "" }], label))
                                    },
                                    None => td {},
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn cell(cell: &Cell, [align, head]: [&str; 2], label: Option<String>) -> Markup {
    let tone = cell.tone.map_or(String::new(), |tone| format!("tone-{}", tone_name(tone)));
    let classes = [align, head, &tone, if cell.bar.is_some() { "bar" } else { "" }];
    let classes: Vec<&str> = classes.into_iter().filter(|class| !class.is_empty()).collect();
    let style = cell.bar.map(|length| format!("--length:{length:.4}"));
    // an empty value is a missing one; scripts read "Infinity", not "inf"
    let value = cell.sort_by.map(|value| match value {
        v if v.is_nan() => String::new(),
        v if v.is_infinite() => format!("{}Infinity", if v < 0.0 { "-" } else { "" }),
        v => format!("{v}"),
    });
    let (shown, note) = (unbroken(&cell.text), unbroken(&cell.note));
    html! {
        td class=[(!classes.is_empty()).then(|| classes.join(" "))] style=[style] data-value=[value] data-label=[label] {
            @if let Some(png) = &cell.picture {
                img.thumbnail alt=(shown) src={ "data:image/png;base64," (BASE64.encode(png)) };
            } @else if let Some(address) = &cell.link { a href=(address) { (shown) } }
            @else if cell.code { code { (shown) } }
            @else if cell.strong { strong { (shown) } }
            @else { (shown) }
            @if !note.is_empty() { span.note { (note) } }
        }
    }
}

/// Prevents line breaks before a power of ten and between a value and its error.
fn unbroken(text: &str) -> String {
    text.replace(" × 10", "\u{a0}×\u{a0}10").replace(" ± ", "\u{a0}±\u{a0}")
}

/// Where the drawings are: embedded as well, they would double the page.
const BESIDE: &str = "The file lies in the folder of this report";

fn figure(drawn: &Drawn<'_>, number: usize) -> Markup {
    let figure = drawn.figure;
    let [file, drawing] = ["png", "svg"].map(|ending| format!("{}.{ending}", drawn.file_stem));
    let heading = format!("title-{}", drawn.file_stem);
    let alt = [&figure.title, &figure.caption].map(String::as_str).join(". ");
    html! {
        figure id={ "figure-" (drawn.file_stem) } aria-labelledby=(heading) data-interactive[drawn.data.is_some()] {
            h3 id=(heading) { (figure.title) }
            @if !figure.subtitle.is_empty() { p.subtitle { (figure.subtitle) } }
            @match &drawn.inline {
                // each says in words what it shows
                Some([wide, narrow]) => div.picture {
                    div.wide { (PreEscaped(wide)) }
                    div.narrow { (PreEscaped(narrow)) }
                },
                None => {
                    @let png = format!("data:image/png;base64,{}", BASE64.encode(&drawn.png));
                    div.picture { img src=(png) alt=(alt); }
                },
            }
            @if let Some(data) = &drawn.data {
                div.plot {}
                script type="application/json" { (PreEscaped(data)) }
            }
            figcaption {
                b { "Figure " (number) } " "
                (figure.caption)
                @if drawn.inline.is_some() {
                    a.download href=(file) download=(file) title=(BESIDE) { "Download PNG" }
                } @else {
                    a.download data-picture hidden download=(file) { "Download PNG" }
                }
                a.download href=(drawing) download=(drawing) title=(BESIDE) { "SVG" }
            }
            @if !figure.how_to_read.is_empty() { (how_to_read(&figure.how_to_read, "")) }
        }
    }
}
