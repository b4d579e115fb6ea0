"""The charts and maps that stand in reports/ go into a page, whatever else changes."""

from pathlib import Path

from femcheck.cli.report_page import report_command

REPORTS = Path(__file__).resolve().parents[3] / "reports"


def test_the_committed_charts_and_the_map_make_a_page(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    report_command([REPORTS / "chart", REPORTS / "stability"], page, "", force=False)
    text = page.read_text(encoding="utf-8")
    for said in ("disc-neo-hookean", "rigid-section", "limit point", "scikit-fem"):
        assert said.lower() in text.lower(), said
    assert len(text) < 8e6
