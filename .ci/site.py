"""The pages of the documentation as HTML, with contents and search. Usage: site.py FOLDER"""

from __future__ import annotations

import html
import json
import re
import shutil
import sys
from pathlib import Path

import markdown

ROOT = Path(__file__).resolve().parents[1]
PAGES = ["README.md", "docs/guide.md", "docs/install.md", "docs/files.md", "docs/methods.md", "docs/export.md", "docs/python.md",
         "docs/library.md", "docs/grids.md", "docs/recordings.md", "docs/paper.md", "docs/effects/README.md",
         "docs/other_simulators.md", "docs/hidden_effects.md", "benchmarks/hidden_effects/README.md", "benchmarks/emps/README.md",
         "benchmarks/estimators/README.md", "docs/robustness.md", "docs/speed.md", "docs/thresholds.md",
         "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"]  # fmt: skip

STYLE = """
:root { color-scheme: light dark }
body { font: 16px/1.55 system-ui, sans-serif; margin: 0; display: flex; flex-wrap: wrap }
nav { flex: 0 0 15rem; padding: 1rem; box-sizing: border-box }
nav ul { list-style: none; padding: 0; margin: .5rem 0 }
nav a[aria-current] { font-weight: 700 }
nav input { width: 100%; box-sizing: border-box; font: inherit }
main { flex: 1 1 30rem; min-width: 0; max-width: 52rem; padding: 1rem; box-sizing: border-box }
pre, table { overflow-x: auto; display: block; max-width: 100% }
pre { background: color-mix(in srgb, currentColor 8%, transparent); padding: .6rem }
td, th { border-bottom: 1px solid color-mix(in srgb, currentColor 25%, transparent); padding: .2rem .6rem; text-align: left }
img { max-width: 100%; background: #fff }
nav a { text-decoration: none }
nav a:hover { text-decoration: underline }
nav li { padding: .1rem 0; line-height: 1.35 }
#found:not(:empty) { border-bottom: 1px solid color-mix(in srgb, currentColor 25%, transparent); padding-bottom: .5rem }
@media (min-width: 50rem) { nav { position: sticky; top: 0; align-self: flex-start; max-height: 100vh; overflow: auto } }
@media (max-width: 50rem) { nav { flex-basis: 100% } nav ul:last-child { max-height: 8rem; overflow: auto } }
"""

SEARCH = """
const box = document.getElementById('search'), list = document.getElementById('found');
box.addEventListener('input', () => {
  const words = box.value.toLowerCase().split(/\\s+/).filter(w => w.length > 1);
  list.replaceChildren();
  if (!words.length) return;
  const hits = INDEX.filter(s => words.every(w => s.text.includes(w)))
    .sort((a, b) => words.filter(w => b.title.toLowerCase().includes(w)).length
                  - words.filter(w => a.title.toLowerCase().includes(w)).length);
  for (const hit of hits.slice(0, 12)) {
    const item = document.createElement('li'), link = document.createElement('a');
    link.href = BASE + hit.url;
    link.textContent = hit.title;
    item.append(link);
    list.append(item);
  }
});
"""


def target(page: str) -> str:
    """Where a page of the repository stands on the site."""
    if page == "README.md":
        return "index.html"
    return re.sub(r"README\.md$", "index.html", page.removeprefix("docs/")).replace(".md", ".html")


def convert(page: str) -> tuple[str, str, list[dict[str, str]]]:
    """Title, body and sections of a page; links to pages become links on the site."""
    text = (ROOT / page).read_text(encoding="utf-8")
    converter = markdown.Markdown(extensions=["tables", "fenced_code", "toc", "sane_lists"])
    body = converter.convert(text)
    here, depth = Path(page).parent, target(page).count("/")

    def link(match: re.Match[str]) -> str:
        kind, address = match.groups()
        path, _, anchor = address.partition("#")
        if not path or re.match(r"[a-z]+:", path):
            return match.group(0)
        full = (ROOT / here / path).resolve()
        name = full.relative_to(ROOT).as_posix() if full.is_relative_to(ROOT) else path
        if full.is_dir() and f"{name}/README.md" in ALL:
            name = f"{name}/README.md"
        new = target(name) if name in ALL else name.removeprefix("docs/")
        if (ROOT / name).is_file() and name not in ALL and not name.startswith("docs/"):
            COPIES.add(name)
        if full.is_dir() and name not in ALL:
            return f'title="{html.escape(name)}"'
        return f'{kind}="{"../" * depth}{new}{"#" + anchor if anchor else ""}"'

    body = re.sub(r'(href|src)="([^"]*)"', link, body)
    title = re.search(r"<h1[^>]*>(.*?)</h1>", body, re.S)
    name = html.unescape(re.sub(r"<[^>]+>", "", title.group(1))) if title else page
    sections = []
    for part in re.split(r"(?=<h[1-3][ >])", body):
        head = re.match(r'<h[1-3](?: id="([^"]*)")?>(.*?)</h', part, re.S)
        if head:
            words = html.unescape(re.sub(r"<[^>]+>", " ", part)).lower()
            own = html.unescape(re.sub(r"<[^>]+>", "", head.group(2)))
            shown = own if own == name else f"{name}: {own}"
            sections.append({"url": f"{target(page)}#{head.group(1) or ''}", "title": shown, "text": words})
    return name, body, sections


def extra(out: Path) -> list[tuple[str, str]]:
    """Reports and API, as entries of the contents."""
    reports = sorted((out / "reports").glob("*/report.html"))
    entries = [(f"reports/{r.parent.name}/report.html", f"Report: {r.parent.name}") for r in reports]
    if (out / "api/amigo_ident/index.html").is_file():
        entries.append(("api/amigo_ident/index.html", "API (Rust)"))
    return entries


ALL = PAGES + sorted(
    p.relative_to(ROOT).as_posix() for p in (ROOT / "docs/effects").glob("*.md") if p.name != "README.md"
)


COPIES: set[str] = set()


def broken_links(out: Path) -> list[str]:
    """Links of pages and reports whose file or heading is not there; rustdoc checks those of the API itself."""
    texts = {p: p.read_text(encoding="utf-8") for p in out.rglob("*.html") if "api" not in p.relative_to(out).parts}
    # what scripts hold is no link of the page
    texts = {page: re.sub(r"<script.*?</script>", "", text, flags=re.S) for page, text in texts.items()}
    anchors = {page: set(re.findall(r'\sid="([^"]*)"', text)) for page, text in texts.items()}
    broken = []
    for page, text in texts.items():
        for address in re.findall(r'\s(?:href|src)="([^"]*)"', text):
            if re.match(r"[a-z]+:", address):
                continue
            path, _, anchor = html.unescape(address).partition("#")
            target_page = (page.parent / path).resolve() if path else page
            missing = not target_page.exists() or (anchor and anchor not in anchors.get(target_page, {anchor}))
            if missing:
                broken.append(f"{page.relative_to(out)}: {address}")
    return broken


def main(out: Path) -> None:
    out = out.resolve()
    pages = {page: convert(page) for page in ALL}
    out.mkdir(parents=True, exist_ok=True)
    index = json.dumps([s for _, _, sections in pages.values() for s in sections])
    (out / "search.js").write_text(f"const INDEX = {index};\n{SEARCH}", encoding="utf-8")
    more = extra(out)
    for page, (name, body, _) in pages.items():
        path, depth = out / target(page), "../" * target(page).count("/")
        mark = lambda p: ' aria-current="page"' if p == page else ""  # noqa: E731
        items = [f'<li><a href="{depth}{target(p)}"{mark(p)}>{html.escape(pages[p][0])}</a></li>' for p in PAGES]
        items += [f'<li><a href="{depth}{url}">{html.escape(text)}</a></li>' for url, text in more]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(
            f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(name)}</title>'
            f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head><body>'
            f'<nav><input id="search" type="search" placeholder="Search" aria-label="Search"><ul id="found"></ul>'
            f"<ul>{''.join(items)}</ul></nav><main>{body}</main>"
            f'<script>const BASE = "{depth}";</script><script src="{depth}search.js"></script></body></html>\n',
            encoding="utf-8",
        )
    for picture in [*(ROOT / "docs").rglob("*.png"), *(ROOT / "docs").rglob("*.svg")]:
        copy = out / picture.relative_to(ROOT / "docs")
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(picture, copy)
    for name in COPIES:
        copy = out / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, copy)
    broken = broken_links(out)
    if broken:
        sys.exit("links that lead nowhere:\n" + "\n".join(broken))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
