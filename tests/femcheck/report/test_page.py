"""The page: whole, the same every time, alone, and nothing in it runs but its own script."""

import base64
import json
import re
from pathlib import Path

import pytest

from femcheck.report.markdown import to_html
from femcheck.report.page import MARK, report_page
from tests.femcheck.report.folders import HOSTILE, Page, copied, figure_folder, hostile_check

LARGEST = 8_000_000


def decoded(link: str) -> bytes:
    return base64.b64decode(link.partition(";base64,")[2])


def test_it_says_what_was_found(page: str, checked: Path, predicted: Path) -> None:
    text = Page(page).text
    for folder in (checked, predicted):
        verdict = json.loads((folder / "summary.json").read_text())["verdict"]
        assert verdict["text"] in text
        assert verdict["law"] in text
    assert page.startswith("<!doctype html>")
    assert MARK in page[:500]
    for said in ("tolerance", "5 %", "stable box", "limit point at P =", "a is fastest"):
        assert said in text
    assert "E/2 (λ3 − 1)²" in text  # the energy of the check
    assert "μ/2 (I1 − 3 − 2 ln J)" in text
    assert "unknowns" in text
    assert "OMP_NUM_THREADS=1" in text


def test_all_27_are_there_with_status_and_reason(page: str) -> None:
    rows = [attrs for tag, attrs in Page(page).elements if tag == "tr" and "data-row" in attrs]
    assert [int(str(row["data-row"])) for row in rows] == 2 * list(range(27))
    text = Page(page).text
    assert "the largest pressure of its path" in text  # what the status means


def test_the_same_folders_give_the_same_bytes(
    page: str, checked: Path, predicted: Path, chart: Path
) -> None:
    assert report_page([checked, predicted, chart]) == page


def test_it_is_small(page: str) -> None:
    assert len(page.encode()) < LARGEST


def test_nothing_is_asked_of_the_network(page: str) -> None:
    """No address but data inside, and a policy that forbids the browser any."""
    found = Page(page)
    links = found.links("src") + found.links("href")
    assert links
    assert all(link.startswith(("data:", "#")) for link in links)
    bare = re.sub(r"data:[^\"]*", "", page)
    assert not re.search(r"https?:|@import|url\(|fetch\(|XMLHttpRequest|sendBeacon", bare)
    policy = next(attrs for _, attrs in found.elements if attrs.get("http-equiv"))
    assert "default-src 'none'" in str(policy["content"])
    assert "unsafe" not in str(policy["content"])
    for image in (link for link in links if link.startswith("data:image")):
        addresses = re.findall(rb"(?:href|src)=\"([^\"]*)\"", decoded(image))
        assert all(one.startswith((b"#", b"data:")) for one in addresses)


def test_tables_come_back_to_the_byte(page: str, checked: Path, predicted: Path) -> None:
    links = {
        str(attrs["download"]): str(attrs["href"])
        for tag, attrs in Page(page).elements
        if tag == "a" and "download" in attrs
    }
    for folder, law in ((checked, "rigid-section"), (predicted, "neo-hookean")):
        name = json.loads((folder / "summary.json").read_text())["design"]
        files = sorted(folder.glob("*.csv"))
        assert len(files) >= 3
        for file in files:
            assert decoded(links[f"{name}-{law}-{file.name}"]) == file.read_bytes()


def test_texts_from_files_stay_texts(checked: Path, tmp_path: Path) -> None:
    """Names, verdicts, notes, statuses, cells, readings: shown to the letter, never run."""
    plain = Page(report_page([figure_folder(tmp_path / "plain")]))
    hostile = hostile_check(checked, tmp_path / "check")
    chart = figure_folder(tmp_path / "a<b>", HOSTILE)
    found = Page(report_page([hostile, chart], title=HOSTILE))
    own = [text for kind, text in plain.scripts if kind is None]
    assert [text for kind, text in found.scripts if kind is None] == own
    assert not any("onerror" in attrs for _, attrs in found.elements)
    assert found.text.count(HOSTILE) >= 15
    for kind, text in found.scripts:
        if kind is not None:
            assert "<" not in text
    model = next(json.loads(text) for kind, text in found.scripts if kind and "said" in text)
    assert HOSTILE in model["said"][4]
    kept = [attrs for tag, attrs in found.elements if tag == "a" and "download" in attrs]
    assert any(HOSTILE.encode() in decoded(str(one["href"])).replace(b'""', b'"') for one in kept)


READING = """# Left out

## Part

a **b** `c<d>`
e

| x | y |
| --- | ---: |
| 1 | 2 |

- f
- g
  h
"""


def test_a_reading_is_set_in_type() -> None:
    html = to_html(READING)
    assert "Left out" not in html
    assert "<h4>Part</h4>" in html
    assert "<p>a <strong>b</strong> <code>c&lt;d&gt;</code>\ne</p>" in html
    assert '<td>1</td>\n<td class="number">2</td>' in html
    assert "<ul>\n<li>f</li>\n<li>g\nh</li>\n</ul>" in html


@pytest.mark.parametrize(
    "text", ["[a](http://b)", "![a](b.png)", "<script>a</script>", "<http://a.b>", "**<b>**"]
)
def test_a_reading_links_to_nothing(text: str) -> None:
    html = to_html(text)
    assert not any(tag in html for tag in ("<a", "<img", "<script", "<b>"))


@pytest.mark.parametrize(
    "text", ["", "#", "|", "| a |\n| --- |", "- ", "**", "`", "- a\n\nb", "|a\nb"]
)
def test_any_reading_ends(text: str) -> None:
    assert "<script" not in to_html(text)


def test_runs_of_one_design_stand_together(page: str, checked: Path, tmp_path: Path) -> None:
    """Told by the design file; the two fixtures' differ in moduli."""
    apart = Page(page)
    assert sum(attrs.get("class") == "design" for _, attrs in apart.elements) == 2
    assert sum(attrs.get("class") == "card run" for _, attrs in apart.elements) == 2
    together = Page(report_page([checked, copied(checked, tmp_path / "again")]))
    assert sum(attrs.get("class") == "design" for _, attrs in together.elements) == 1
    assert sum(attrs.get("class") == "card run" for _, attrs in together.elements) == 2


def test_without_meshes_there_is_no_model_but_a_sentence(checked: Path, tmp_path: Path) -> None:
    bare = copied(checked, tmp_path / "bare")
    for file in (bare / "deformed").iterdir():
        file.unlink()
    (bare / "deformed").rmdir()
    found = Page(report_page([bare]))
    assert not any(attrs.get("class") == "viewer" for _, attrs in found.elements)
    assert "the deformed meshes are not in this folder" in found.text
