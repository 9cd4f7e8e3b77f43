//! Sections as one self-contained HTML file: nothing is loaded from elsewhere, as enforced by a content
//! security policy.

mod blocks;
mod column;
mod data;
mod explorer;
mod narrow;
mod what_if;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{DOCTYPE, PreEscaped, html};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::ReportError;
use super::block::Block;
use super::figure::Figure;
use super::fonts::{FAMILY, REGULAR, SEMI_BOLD};
use super::palette::{
    AXIS, ColourRole, DARK_PARTNERS, GRID, INK, MUTED, Rgb, SURFACE, css_variable,
};
use super::raster::figure_to_both;

const INTERACTIVE: &str = concat!(
    include_str!("scales.js"),
    include_str!("canvas.js"),
    include_str!("curves.js"),
    include_str!("panel.js"),
    include_str!("interactive.js"),
    include_str!("explorer.js"),
    include_str!("what_if.js")
);
const SORT: &str = concat!(include_str!("sort.js"), include_str!("reading.js"));
const STYLE: &str = include_str!("style.css");

/// Sections, title and provenance of a report, from which its HTML is generated.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PageContent {
    /// Heading and window title.
    pub title: String,
    /// One line of provenance: file, date, program version.
    pub subtitle: String,
    /// The sections, in order.
    pub sections: Vec<SectionContent>,
    /// Names of the two models whose curves the reader can show or hide, that of [`ColourRole::Given`] first;
    /// empty for none.
    pub versions: Vec<String>,
    /// Closing remarks; line breaks are kept.
    pub footer: String,
}

/// One section of a page.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SectionContent {
    /// Anchor.
    pub id: String,
    /// Heading and entry in the navigation.
    pub title: String,
    /// What it is made of.
    pub blocks: Vec<Block>,
    /// Whether it is collapsed until the reader opens it; collapsed sections are not printed.
    pub folded: bool,
}

/// A page and its figures, each drawn once.
#[derive(Clone, Debug)]
pub struct Page {
    /// The file.
    pub html: String,
    /// The figures as files, in the order of the page.
    pub pictures: Vec<Picture>,
}

/// A figure as PNG and as SVG.
#[derive(Clone, Debug)]
pub struct Picture {
    /// File name without extension; unique on the page.
    pub file_stem: String,
    /// The bytes of the PNG file.
    pub png: Vec<u8>,
    /// The text of the SVG file.
    pub svg: String,
}

impl Picture {
    /// Names and bytes of both files.
    #[must_use]
    pub fn files(self) -> [(String, Vec<u8>); 2] {
        let Self { file_stem, png, svg } = self;
        [(format!("{file_stem}.png"), png), (format!("{file_stem}.svg"), svg.into_bytes())]
    }
}

/// A figure drawn for the page.
struct Drawn<'a> {
    figure: &'a Figure,
    file_stem: String,
    /// Drawings for a wide and a narrow screen that follow the colours of the page; only for static figures.
    inline: Option<[String; 2]>,
    png: Vec<u8>,
    svg: String,
    data: Option<String>,
}

/// Data of blocks that are filled by scripts, in the order of the page.
struct PageData {
    explorers: Vec<String>,
    what_ifs: Vec<String>,
}

/// Writes the page. Where the pictures are wanted as files too, [`render_page`] returns both.
///
/// # Errors
/// [`ReportError`] if a figure cannot be drawn.
///
/// # Examples
/// ```
/// use amigo_ident::report::{PageContent, SectionContent, block::Block, page};
/// let section = SectionContent {
///     id: "result".into(),
///     title: "Result".into(),
///     blocks: vec![Block::paragraph("1 < 2")],
///     folded: false,
/// };
/// let content = PageContent { title: "Run 1".into(), sections: vec![section], ..Default::default() };
/// assert!(page(&content)?.contains("1 &lt; 2"));
/// # Ok::<(), amigo_ident::report::ReportError>(())
/// ```
pub fn page(content: &PageContent) -> Result<String, ReportError> {
    Ok(render_page(content)?.html)
}

/// Writes the page and returns its figures as PNG beside it.
///
/// # Errors
/// [`ReportError`] if a figure cannot be drawn.
pub fn render_page(content: &PageContent) -> Result<Page, ReportError> {
    let drawn = draw_figures(content)?;
    let blocks = || content.sections.iter().flat_map(|section| &section.blocks);
    let data = PageData { explorers: explorer::all(blocks())?, what_ifs: what_if::all(blocks())? };
    let html = write(content, &drawn, &data, what_if::script(blocks()).as_deref());
    let picture = |d: Drawn| Picture { file_stem: d.file_stem, png: d.png, svg: d.svg };
    Ok(Page { html, pictures: drawn.into_iter().map(picture).collect() })
}

fn draw_figures(content: &PageContent) -> Result<Vec<Drawn<'_>>, ReportError> {
    let blocks = content.sections.iter().flat_map(|section| &section.blocks);
    let figures = blocks.flat_map(Block::figures);
    let mut named: Vec<(&Figure, String)> = Vec::new();
    for figure in figures {
        let stem = unique(figure.file_stem(), |stem| named.iter().all(|(_, taken)| taken != stem));
        named.push((figure, stem));
    }
    named
        .into_par_iter()
        .map(|(figure, file_stem)| {
            let (png, svg) = figure_to_both(figure)?;
            let interactive = figure.is_interactive();
            let inline = if interactive { None } else { Some(narrow::both(figure)?) };
            let data =
                interactive.then(|| data::json(&data::of(figure), &figure.id)).transpose()?;
            Ok(Drawn { figure, file_stem, inline, png, svg, data })
        })
        .collect()
}

/// The name, with a number from 2 on if it is already used.
pub(crate) fn unique(name: String, is_free: impl Fn(&str) -> bool) -> String {
    if is_free(&name) {
        return name;
    }
    let numbered = (2..).map(|n: usize| format!("{name}-{n}"));
    numbered.into_iter().find(|name| is_free(name)).unwrap_or(name)
}

fn write(
    content: &PageContent,
    drawn: &[Drawn<'_>],
    data: &PageData,
    model: Option<&str>,
) -> String {
    let ids = section_ids(content);
    let scripts: Vec<&str> = [Some(SORT), model, Some(INTERACTIVE)].into_iter().flatten().collect();
    let mut writer = blocks::Writer::new(drawn, data);
    let sections: Vec<_> = content.sections.iter().map(|s| writer.blocks(&s.blocks)).collect();
    let style = format!("{}{}{STYLE}", font_faces(), colors());
    // a single section has neither a table of contents nor a heading
    let is_single = content.sections.len() == 1;
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy(&scripts));
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (content.title) }
                style { (PreEscaped(style)) }
            }
            body {
                div.layout.single[is_single] {
                    @if !is_single { (navigation(content, &ids)) }
                    main {
                        header {
                            h1 { (content.title) }
                            p.provenance { (content.subtitle) }
                        }
                        @for ((section, id), blocks) in content.sections.iter().zip(&ids).zip(&sections) {
                            section id=(id) {
                                @if is_single { (blocks) } @else { (titled(section, blocks)) }
                            }
                            @if id == &ids[0] && content.versions.len() == 2 {
                                (version_switch(&content.versions))
                            }
                        }
                        @if !content.footer.is_empty() { footer { (content.footer) } }
                    }
                }
                @for script in &scripts { script { (PreEscaped(script)) } }
            }
        }
    }
    .into_string()
}

/// The table of contents.
fn navigation(content: &PageContent, ids: &[String]) -> maud::Markup {
    html! {
        nav aria-label="Sections" {
            ol {
                @for (section, id) in content.sections.iter().zip(ids) {
                    li.folded[section.folded] { a href={ "#" (id) } { (section.title) } }
                }
            }
        }
    }
}

/// The blocks of a section below its title.
fn titled(section: &SectionContent, blocks: &maud::Markup) -> maud::Markup {
    html! {
        @if section.folded {
            details.folded {
                summary { h2 { (section.title) } }
                (blocks)
            }
        } @else {
            h2 { (section.title) }
            (blocks)
        }
    }
}

/// Shows the curves of one model or of both; hidden without scripts.
fn version_switch(names: &[String]) -> maud::Markup {
    let choices = [("both", "both"), ("given", &names[0]), ("model", &names[1])];
    html! {
        fieldset.versions hidden {
            legend { "Show" }
            @for (value, name) in choices {
                label {
                    input type="radio" name="version" value=(value) checked[value == "both"];
                    (name)
                }
            }
        }
    }
}

/// Anchors without spaces, unique on the page; figures have a separate prefix.
fn section_ids(content: &PageContent) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for section in &content.sections {
        let keep = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        let id: String = section.id.chars().map(keep).collect();
        let id = if id.is_empty() { "section".to_owned() } else { id };
        ids.push(unique(format!("s-{id}"), |id| ids.iter().all(|taken| taken != id)));
    }
    ids
}

/// Nothing is loaded; only the scripts of the page run, identified by their hashes.
fn policy(scripts: &[&str]) -> String {
    let hash = |script: &&str| format!("'sha256-{}'", BASE64.encode(Sha256::digest(script)));
    let hashes: Vec<String> = scripts.iter().map(hash).collect();
    format!(
        "default-src 'none'; img-src data:; font-src data:; style-src 'unsafe-inline'; \
         script-src {}; base-uri 'none'; form-action 'none'",
        hashes.join(" ")
    )
}

/// The embedded typeface without its combining accents: it has no anchors for them, and a browser would place
/// the dot of ω̇ beside the letter. These letters are taken from a system font.
fn font_faces() -> String {
    let face = |bytes: &[u8], weight: &str| {
        format!(
            "@font-face{{font-family:{FAMILY};font-weight:{weight};\
             unicode-range:U+0-2FF,U+370-10FFFF;src:url(data:font/ttf;base64,{})}}\n",
            BASE64.encode(bytes)
        )
    };
    face(REGULAR, "400") + &face(SEMI_BOLD, "600 700")
}

/// The palette as custom properties with their dark-mode partners, and the rules by which drawings follow
/// them. Printed pages use the light colours.
fn colors() -> String {
    let declare = |dark: bool| -> String {
        let pick = |pair: &(Rgb, Rgb)| if dark { pair.1 } else { pair.0 };
        let declare = |pair| format!("{}:{};", css_variable(pair_light(pair)), pick(pair).hex());
        DARK_PARTNERS.iter().map(declare).collect()
    };
    let named = |name: &str, color: Rgb| format!("--{name}:var({});", css_variable(color));
    let roles = [
        named("ink", INK),
        named("muted", MUTED),
        named("axis", AXIS),
        named("grid", GRID),
        named("paper", SURFACE),
        named("link", ColourRole::Measured.color()),
        "--good:#00734F;--notice:#8F5F00;--bad:#B23C00;--tint:#F4F6F8;--track:#D5E6F3;".to_owned(),
    ];
    let dark = "--good:#3CCB9F;--notice:#F2B52C;--bad:#FF8A4A;--tint:#1F252D;--track:#1F3F5A;";
    let follow = |(light, _): &(Rgb, Rgb)| {
        let (hex, variable) = (light.hex(), css_variable(*light));
        format!(
            ".picture svg [fill=\"{hex}\"]{{fill:var({variable})}}\
             .picture svg [stroke=\"{hex}\"]{{stroke:var({variable})}}\n"
        )
    };
    format!(
        ":root{{{}{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{}{dark}}}}}\n{}",
        declare(false),
        roles.concat(),
        declare(true),
        DARK_PARTNERS.iter().map(follow).collect::<String>()
    )
}

fn pair_light(pair: &(Rgb, Rgb)) -> Rgb {
    pair.0
}

#[cfg(test)]
mod tests;
