"""Folders of figures, and copies of folders with something changed in them."""

import json
import shutil
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

HOSTILE = """</script><script>window.ran=1</script><img src=x onerror="window.ran=2">'"&</style>"""
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="200pt" height="100pt">'
    '<rect width="200" height="100"/></svg>'
)
READING = """# Title

Two lines
of one **bold** paragraph with `code`.

| method | time |
| --- | ---: |
| a | 1 ms |

- first
- second,
  going on
"""
PROVENANCE = {
    "seed": 7,
    "verdict": "a is fastest",
    "versions": {"python": "3.11"},
    "machine": {"processor": "a processor", "processors": 2},
    "threads": {"OMP_NUM_THREADS": "1"},
}


def figure_folder(folder: Path, text: str = "", svg: str = SVG) -> Path:
    """A chart; `text` stands wherever a text may stand."""
    folder.mkdir(parents=True)
    (folder / "chart.svg").write_text(svg)
    (folder / "chart.csv").write_text(f'method,error\n"{text.replace(chr(34), chr(34) * 2)}",1\n')
    (folder / "reading.md").write_text(f"{READING}\n{text}\n\n- {text}\n\n## {text}\n")
    made = {**PROVENANCE, "verdict": text or PROVENANCE["verdict"], "said": text}
    (folder / "provenance.json").write_text(json.dumps(made))
    return folder


def copied(folder: Path, to: Path) -> Path:
    """A copy that may be changed."""
    shutil.copytree(folder, to)
    return to


def change_json(file: Path, change: Callable[[dict[str, Any]], None]) -> None:
    """Change what a JSON file holds."""
    data = json.loads(file.read_text())
    change(data)
    file.write_text(json.dumps(data))


def hostile_check(folder: Path, to: Path) -> Path:
    """A copy of a check whose every text wants to be run."""

    def summary(data: dict[str, Any]) -> None:
        data["design"] = HOSTILE
        data["verdict"] |= {"text": HOSTILE, "law": HOSTILE, "advice": HOSTILE}
        data["section"]["faults"] = [HOSTILE]
        data["mesh"]["notes"] = [HOSTILE]
        data["solids"][0] |= {"element": HOSTILE, "stability": HOSTILE}

    def design(data: dict[str, Any]) -> None:
        data["notes"] = {"scene": HOSTILE, "seed": HOSTILE}

    def provenance(data: dict[str, Any]) -> None:
        data["versions"][HOSTILE] = HOSTILE
        data["machine"]["processor"] = HOSTILE
        data[HOSTILE] = {HOSTILE: HOSTILE}

    copied(folder, to)
    change_json(to / "summary.json", summary)
    change_json(to / "design.json", design)
    change_json(to / "provenance.json", provenance)
    table = to / "table.csv"
    quoted = '"' + HOSTILE.replace('"', '""') + '"'
    lines = table.read_text().splitlines()
    cells = lines[5].split(",")  # of a combination that then has no answer
    lines[5] = ",".join(
        [*cells[:6], "", "", "", "", *cells[10:-3], quoted, "solid.STOPPED", cells[-1]]
    )
    table.write_text("\n".join(lines) + "\n")
    return to


class Page(HTMLParser):
    """What a page is made of, as a parser sees it.

    elements : names and attributes, in order. texts : of everything outside script and style.
    scripts : texts of script elements, with their type.
    """

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.scripts: list[tuple[str | None, str]] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "script":
            self.scripts.append((self.elements[-1][1].get("type"), data))
        elif not (self.open and self.open[-1] == "style"):
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join(self.texts)

    def links(self, attribute: str) -> list[str]:
        return [str(attrs[attribute]) for _, attrs in self.elements if attrs.get(attribute)]
