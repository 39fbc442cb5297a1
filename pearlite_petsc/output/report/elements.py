"""Pieces of HTML; every text that comes from outside goes through ``html.escape``."""

import base64
import io
from collections.abc import Sequence
from html import escape
from pathlib import Path

from PIL import Image, features  # type: ignore[import-untyped, unused-ignore]

LARGE = 250_000
"""Size from which a picture is packed for the page [byte]."""


READABLE = 640
"""Width down to which a picture may shrink on a narrow screen [CSS pixel]."""

CSS_PIXELS = 2 / 3
"""Of the page for one of a picture, so that the text of all pictures has one size."""


def paragraph(text: str, style: str = "") -> str:
    """Return a paragraph with the text escaped."""
    chosen = f' class="{style}"' if style else ""
    return f"<p{chosen}>{escape(text)}</p>"


def bullets(texts: Sequence[str], style: str = "") -> str:
    """Return a list with the texts escaped."""
    chosen = f' class="{style}"' if style else ""
    return f"<ul{chosen}>{''.join(f'<li>{escape(text)}</li>' for text in texts)}</ul>"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], numbers_from: int = 1) -> str:
    """Return a table that scrolls sideways on a narrow screen.

    Args:
        head: Titles of the columns.
        rows: Cells as text.
        numbers_from: First column set flush right.
    """
    titles = "".join(_cell("th", text, place, numbers_from) for place, text in enumerate(head))
    body = "".join(
        f"<tr>{''.join(_cell('td', text, i, numbers_from) for i, text in enumerate(row))}</tr>"
        for row in rows
    )
    words = ' class="words"' if numbers_from >= len(head) else ""
    return (
        f'<div class="wide"><table{words}><thead><tr>{titles}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _cell(tag: str, text: str, place: int, numbers_from: int) -> str:
    # Only tables of numbers have short first cells that must not break ("A-T").
    short = ' class="name"' if place == 0 and numbers_from == 1 else ""
    chosen = ' class="number"' if place >= numbers_from else short
    return f"<{tag}{chosen}>{escape(text)}</{tag}>"


def picture(path: Path, caption: str, link: str) -> str:
    """Return a PNG, inlined (a large one as WebP), with its caption; empty if it is missing.

    On a narrow screen it scrolls sideways at a size that can be read.

    Args:
        path: The file.
        caption: Text below it.
        link: Where a click on it leads, the file as the page sees it.
    """
    if not path.is_file():
        return ""
    kind, data = _compact(path)
    width = round(CSS_PIXELS * _pixels(path))
    text = escape(caption)
    code = base64.b64encode(data).decode("ascii")
    return (
        f'<figure><div class="wide"><a href="{escape(link)}"><img alt="{text}" width="{width}" '
        f'style="min-width:{min(width, READABLE)}px" src="data:image/{kind};base64,{code}"></a></div>'
        f"<figcaption>{text}</figcaption></figure>"
    )


def _pixels(path: Path) -> int:
    with Image.open(path) as image:
        return int(image.width)


def _compact(path: Path) -> tuple[str, bytes]:
    data = path.read_bytes()
    if len(data) < LARGE or not features.check("webp"):
        return "png", data
    buffer = io.BytesIO()
    with Image.open(path) as image:
        image.convert("RGB").save(buffer, "WEBP", quality=80, method=2)
    return "webp", buffer.getvalue()


def listing(text: str) -> str:
    """Return preformatted text, escaped."""
    return f"<pre>{escape(text)}</pre>"


def folded(title: str, content: str) -> str:
    """Return HTML that shows when its title is opened (always, in print)."""
    return f"<details><summary>{escape(title)}</summary>{content}</details>"


STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { font: 16px/1.5 "Segoe UI", "Helvetica Neue", "DejaVu Sans", Arial, sans-serif;
  color: #1a1a1a; background: #fff; margin: 0 auto; max-width: 62rem; padding: 1rem; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: .5rem 0; }
h2 { font-size: 1.25rem; margin: 2rem 0 .5rem; border-bottom: 2px solid #0072b2;
  padding-bottom: .2rem; }
h3 { font-size: 1.05rem; margin: 1.2rem 0 .3rem; }
p, ul { margin: .5rem 0; }
li { overflow-wrap: anywhere; }
nav a { display: inline-block; margin: 0 .8rem .3rem 0; color: #0072b2; }
figure { margin: 1rem 0; }
img { max-width: 100%; height: auto; display: block; margin: 0 auto; }
figcaption { font-size: .875rem; color: #444; margin-top: .3rem; }
.wide { overflow-x: auto; margin: .5rem 0; }
table { border-collapse: collapse; font-size: .875rem; width: 100%; }
th, td { padding: .3rem .6rem; text-align: left; vertical-align: top;
  border-bottom: 1px solid #ddd; }
th { border-bottom: 2px solid #999; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
th.number { white-space: normal; }
.name { white-space: nowrap; }
pre { background: #f5f5f5; padding: .7rem; overflow-x: auto; font-size: .8125rem;
  line-height: 1.35; }
.warning { border-left: 4px solid #d55e00; background: #fff4ec; padding: .4rem .4rem .4rem 1.8rem; }
.good { border-left: 4px solid #009e73; background: #eefaf5; padding: .5rem .8rem; }
.lead { font-size: 1.05rem; }
summary { cursor: pointer; color: #0072b2; margin: .5rem 0; }
@media (max-width: 40rem) { body { padding: .6rem; } .number { white-space: normal; }
  table { font-size: .8125rem; } th, td { padding: .3rem .2rem; }
  .words thead { display: none; } .words td { display: block; border: 0; padding: .1rem 0; }
  .words td:first-child { font-weight: bold; border-top: 1px solid #ddd; padding-top: .4rem; } }
@media print { body { max-width: none; font-size: 10pt; } nav { display: none; }
  img { max-height: 23cm; width: auto; } figure, tr, .warning { break-inside: avoid; } h2, h3 { break-after: avoid; }
  .wide, pre { overflow: visible; } pre { white-space: pre-wrap; }
  details > *:not(summary) { display: block !important; }
  details::details-content { content-visibility: visible; height: auto; } }
"""
