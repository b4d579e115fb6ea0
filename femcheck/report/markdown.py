"""The little Markdown that readings are written in, as HTML; all else in them is plain text."""

from __future__ import annotations

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

__all__ = ["to_html"]

BOLD = re.compile(r"\*\*(.+?)\*\*")
CODE = re.compile(r"`([^`]+)`")
HEADING = re.compile(r"(#{1,6})\s+(.*)")
ITEM = re.compile(r"\s*[-*]\s+(.*)")
RULE = re.compile(r":?-{3,}:?")  # a cell of the line below a table's head


def to_html(text: str) -> Markup:
    """Headings, paragraphs, lists, tables, bold and code; everything is escaped first.

    A first heading of the first level is left out: the page has a title of its own.
    """
    lines = text.splitlines()
    if lines and lines[0].startswith("# "):
        lines = lines[1:]
    return Markup("\n").join(_blocks(lines))


def _blocks(lines: list[str]) -> Iterator[Markup]:
    place = 0
    while place < len(lines):
        line = lines[place]
        heading = HEADING.match(line)
        stop = place + 1
        if heading:
            level = min(2 + len(heading[1]), 6)
            yield Markup(f"<h{level}>{{}}</h{level}>").format(_inline(heading[2]))
        elif line.startswith("|") and place + 1 < len(lines) and _is_rule(lines[place + 1]):
            stop = _end(lines, place, lambda one: one.startswith("|"))
            yield _table(lines[place:stop])
        elif ITEM.match(line):
            stop = _end(lines, place, lambda one: bool(one.strip()))
            yield _list(lines[place:stop])
        elif line.strip():
            stop = _end(lines, place, _is_prose)
            yield Markup("<p>{}</p>").format(_inline(" ".join(lines[place:stop])))
        place = stop


def _is_prose(line: str) -> bool:
    return bool(line.strip()) and not (HEADING.match(line) or ITEM.match(line) or line[0] == "|")


def _end(lines: list[str], start: int, belongs: object) -> int:
    """The first line after `start` that does not belong to its block."""
    assert callable(belongs)
    stop = start + 1
    while stop < len(lines) and belongs(lines[stop]):
        stop += 1
    return stop


def _list(lines: list[str]) -> Markup:
    """A line without a mark goes on with the item before it."""
    items: list[str] = []
    for line in lines:
        item = ITEM.match(line)
        if item:
            items.append(item[1])
        else:
            items[-1] += " " + line.strip()
    inner = Markup("").join(Markup("<li>{}</li>").format(_inline(item)) for item in items)
    return Markup("<ul>{}</ul>").format(inner)


def _table(lines: list[str]) -> Markup:
    head, rule, *rest = ([cell.strip() for cell in _cells(line)] for line in lines)
    right = [cell.endswith(":") for cell in rule]
    rows = [_row(head, right, "th")] + [_row(row, right, "td") for row in rest]
    body = Markup("").join(rows[1:])
    return Markup(
        '<div class="scroll" tabindex="0"><table><thead>{}</thead><tbody>{}</tbody></table></div>'
    ).format(rows[0], body)


def _is_rule(line: str) -> bool:
    return line.startswith("|") and all(RULE.fullmatch(cell.strip()) for cell in _cells(line))


def _cells(line: str) -> list[str]:
    return line.strip().strip("|").split("|")


def _row(cells: list[str], right: list[bool], tag: str) -> Markup:
    inner = Markup("").join(
        Markup(f'<{tag} class="{{}}">{{}}</{tag}>').format("number" if end else "", _inline(cell))
        for cell, end in zip(cells, right + [False] * len(cells), strict=False)
    )
    return Markup("<tr>{}</tr>").format(inner)


def _inline(text: str) -> Markup:
    escaped = str(escape(text))
    escaped = CODE.sub(r"<code>\1</code>", escaped)
    return Markup(BOLD.sub(r"<strong>\1</strong>", escaped))
