"""The Markdown that readings are written in, as HTML."""

from __future__ import annotations

from markdown_it import MarkdownIt
from markupsafe import Markup

__all__ = ["to_html"]

RULES = ("heading", "list", "table", "emphasis", "backticks")
"""No links, images or HTML: a page loads nothing, and all else is plain text."""


def to_html(text: str) -> Markup:
    """Convert headings, paragraphs, lists, tables, bold and code; all else is escaped.

    A first heading of the first level is left out: the page has a title of its own. The others
    stand two levels lower.
    """
    parser = MarkdownIt("zero").enable(RULES)
    tokens = parser.parse(text)
    if tokens and (tokens[0].type, tokens[0].tag) == ("heading_open", "h1"):
        tokens = tokens[3:]  # it opens, holds its text, and closes
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(2 + int(token.tag[1:]), 6)}"
        elif token.attrs.pop("style", "") == "text-align:right":
            token.attrs["class"] = "number"
    html = parser.renderer.render(tokens, parser.options, {})
    html = html.replace("<table>", '<div class="scroll" tabindex="0"><table>')
    return Markup(html.replace("</table>", "</table></div>"))
