"""The report as a person uses it, in a real browser without a window.

Ten to thirty seconds: they buy that the page works at all, which nothing but a browser tells.
"""

import base64
import hashlib
import os
import shutil
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from femcheck.report.page import report_page
from tests.femcheck.report.folders import figure_folder, hostile_check

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-quic",
)
NO_WEBGL = """
const given = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind === "webgl" ? null : given.call(this, kind, ...rest);
};
"""
PATIENCE = 20.0  # s until something that a click brings about must have come
HOSTILE_SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10" onload="window.ran=3">'
    "<script>window.ran=4; parent.ran=5</script>"
    '<image href="http://127.0.0.1:9/x.png" width="1" height="1"/></svg>'
)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Chromium with WebGL drawn by the processor; its downloads go to a folder of its own."""
    if CHROMIUM is None or DRIVER is None:
        if os.environ.get("CI"):
            pytest.fail("no chromium, no chromedriver: install them with apt-get")
        pytest.skip("no chromium here")
    try:
        socket.getaddrinfo("localhost", None)
    except OSError as error:  # driver and browser talk over it
        pytest.skip(f"localhost has no address here: {error}")
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    place = tmp_path_factory.mktemp("browser")
    for flag in (*FLAGS, f"--user-data-dir={place / 'profile'}"):
        options.add_argument(flag)
    options.add_experimental_option("prefs", {"download.default_directory": str(place)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.downloads = place
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def file(page: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "report.html"
    out.write_text(page, encoding="utf-8")
    return out


@pytest.fixture
def opened(browser: Any, file: Path) -> Any:
    """The report, opened from disk with its first model in sight, and nothing to complain of."""
    show(browser, file, 1280)
    yield browser
    assert complaints(browser) == []


def show(browser: Any, file: Path, width: int) -> None:
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.get_log("browser")
    browser.get(file.as_uri())
    find(browser, ".viewer")
    browser.execute_script("document.querySelector('.viewer').scrollIntoView({block: 'center'})")
    until(lambda: browser.find_elements("css selector", ".stage.live"))


def find(browser: Any, selector: str) -> Any:
    return browser.find_element("css selector", selector)


def complaints(browser: Any) -> list[str]:
    """Everything the page or the browser's policy said on the console."""
    return [entry["message"] for entry in browser.get_log("browser")]


def until(comes: Callable[[], Any]) -> Any:
    """Wait for something to be so."""
    end = time.monotonic() + PATIENCE
    while not (found := comes()):
        assert time.monotonic() < end, "it never came"
        time.sleep(0.05)
    return found


def pixels(browser: Any) -> str:
    """What the first model's canvas shows, once it has come to rest."""
    seen = ""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        shown = browser.execute_script("return document.querySelector('.stage canvas').toDataURL()")
        digest = hashlib.sha256(shown.encode()).hexdigest()
        if digest == seen:
            return digest
        seen = digest
        time.sleep(0.5)
    raise AssertionError("the model never comes to rest")


def colours(browser: Any) -> int:
    """How many colours the model's picture has: a plain canvas has one."""
    return int(
        browser.execute_script(
            "const gl = document.querySelector('.stage canvas').getContext('webgl');"
            "const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];"
            "const data = new Uint8Array(4 * w * h);"
            "gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data);"
            "return new Set(new Uint32Array(data.buffer)).size"
        )
    )


def drag(browser: Any, right: int, down: int) -> None:
    from selenium.webdriver import ActionChains

    canvas = find(browser, ".stage canvas")
    actions = ActionChains(browser).move_to_element(canvas).click_and_hold()
    actions.move_by_offset(right, down).release().perform()


def test_the_model_is_drawn_and_turns(opened: Any) -> None:
    assert colours(opened) > 200
    before = pixels(opened)
    drag(opened, 120, 30)
    turned = pixels(opened)
    assert turned != before
    find(opened, ".keys .reset").click()
    assert pixels(opened) == before
    find(opened, ".keys .nearer").click()
    assert pixels(opened) not in (before, turned)


def test_without_a_mouse(opened: Any) -> None:
    """Arrow keys turn, plus and minus zoom, 0 comes back; sliders take the keys of every slider."""
    from selenium.webdriver.common.keys import Keys

    before = pixels(opened)
    canvas = find(opened, ".stage canvas")
    for keys in (Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "-"):
        canvas.send_keys("0")
        assert pixels(opened) == before
        canvas.send_keys(keys)
        assert pixels(opened) != before
    canvas.send_keys("0")
    slider = find(opened, "[data-supply='1']")
    slider.send_keys(Keys.HOME)
    assert slider.get_attribute("aria-valuetext") == "0 kPa"
    lowest = pixels(opened)
    slider.send_keys(Keys.ARROW_RIGHT)
    assert slider.get_attribute("aria-valuetext") == "20 kPa"
    assert pixels(opened) != lowest


def test_the_pressures_have_their_shapes(opened: Any) -> None:
    """All 27, each told by its own picture, and named in words and in the table."""
    seen = set()
    for row in (0, 1, 5, 13, 26):
        button = f".combinations tr[data-row='{row}'] .show"
        opened.execute_script(f'document.querySelector("{button}").click()')
        seen.add(pixels(opened))
        pressures = find(opened, button).text.replace(", ", " · ")
        assert find(opened, ".state").text.startswith(f"{pressures} kPa")
        current = opened.find_elements("css selector", ".combinations tr.current")
        assert current[0].get_attribute("data-row") == str(row)
    assert len(seen) == 5


def test_what_is_shown_can_be_chosen(opened: Any) -> None:
    before = pixels(opened)
    for name in ("beam", "ghost", "open", "supplies"):
        find(opened, f"[data-show='{name}']").click()
        assert pixels(opened) != before
        find(opened, f"[data-show='{name}']").click()
        assert pixels(opened) == before


def test_a_combination_without_answer_says_why(opened: Any) -> None:
    """In the second viewer, of the prediction."""
    row = ".run:has(.unanswered) .unanswered"
    opened.execute_script(f"document.querySelector('{row} .show').click()")
    state = find(opened, ".run:has(.unanswered) .state")
    assert "unanswered" in state.get_attribute("class")
    until(lambda: "no answer" in state.text)  # once it has scrolled into sight
    assert "at P = " in state.text
    assert "last stable shape" in state.text


def test_theme_details_and_sorting(opened: Any) -> None:
    ground = "return getComputedStyle(document.body).backgroundColor"
    light, shown = opened.execute_script(ground), pixels(opened)
    find(opened, "#theme").click()
    assert opened.execute_script(ground) != light
    assert pixels(opened) != shown
    find(opened, "#theme").click()
    assert opened.execute_script(ground) == light
    details = find(opened, ".run details")
    details.find_element("css selector", "summary").click()
    assert details.get_attribute("open") is None
    details.find_element("css selector", "summary").click()
    assert details.get_attribute("open") is not None
    head = opened.find_elements("css selector", ".combinations thead button")[2]
    head.click()
    cells = [
        one.text
        for one in opened.find_elements("css selector", ".combinations")[0].find_elements(
            "css selector", "tbody td:nth-child(3)"
        )
    ]
    assert [float(cell) for cell in cells] == sorted(float(cell) for cell in cells)


def test_a_table_is_downloaded_to_the_byte(opened: Any, checked: Path) -> None:
    link = find(opened, ".downloads a[download$='table.csv']")
    opened.execute_script("arguments[0].click()", link)
    out = opened.downloads / link.get_attribute("download")
    until(out.exists)
    assert until(out.read_bytes) == (checked / "table.csv").read_bytes()


@pytest.mark.parametrize("width", [1280, 390, 360])
def test_it_fits_and_asks_for_nothing(browser: Any, file: Path, width: int) -> None:
    show(browser, file, width)
    inner, scroll = browser.execute_script(
        "return [document.documentElement.clientWidth, document.documentElement.scrollWidth]"
    )
    assert scroll <= inner <= width
    assert browser.execute_script("return performance.getEntriesByType('resource')") == []
    assert colours(browser) > 200
    drag(browser, 60, 0)
    broken = "return [...document.images].filter((one) => !one.naturalWidth).length"
    until(lambda: browser.execute_script(broken) == 0)
    assert complaints(browser) == []


def test_texts_from_files_do_not_run(browser: Any, checked: Path, tmp_path: Path) -> None:
    """Neither as HTML nor within a figure."""
    from tests.femcheck.report.folders import HOSTILE

    hostile = hostile_check(checked, tmp_path / "check")
    chart = figure_folder(tmp_path / "chart", HOSTILE, HOSTILE_SVG)
    out = tmp_path / "hostile.html"
    out.write_text(report_page([hostile, chart], title=HOSTILE), encoding="utf-8")
    show(browser, out, 1280)
    assert browser.execute_script("return typeof window.ran") == "undefined"
    assert browser.title == HOSTILE
    assert find(browser, "h1").text == HOSTILE
    assert browser.execute_script("return performance.getEntriesByType('resource')") == []
    assert complaints(browser) == []


def test_its_policy_lets_nothing_else_run(browser: Any, file: Path) -> None:
    """Should a text ever get through: the browser itself refuses it."""
    show(browser, file, 1280)
    browser.execute_script(
        "const [script, image] = [document.createElement('script'), new Image()];"
        "script.textContent = 'window.ran = 1'; image.src = 'http://127.0.0.1:9/x.png';"
        "document.body.append(script, image)"
    )
    assert browser.execute_script("return typeof window.ran") == "undefined"
    said = until(lambda: complaints(browser))
    assert any("Content Security Policy" in one for one in said)


def test_without_webgl_there_is_a_picture(browser: Any, file: Path) -> None:
    """The same page in a browser that gives no WebGL context: a sentence and the still picture."""
    size = {"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    source = {"source": NO_WEBGL}
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", source)
    try:
        browser.get(file.as_uri())
        browser.execute_script("document.querySelector('.viewer').scrollIntoView()")
        said = until(
            lambda: find(browser, ".fallback").is_displayed() and find(browser, ".fallback")
        )
        assert "WebGL" in said.text
        assert find(browser, ".still").is_displayed()
        assert not find(browser, ".stage canvas").is_displayed()
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)


def test_it_prints(opened: Any) -> None:
    """As pages with the still picture in the model's place, and no buttons."""
    opened.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert find(opened, ".still").is_displayed()
        assert not find(opened, ".stage canvas").is_displayed()
        assert not find(opened, "#theme").is_displayed()
        pdf = base64.b64decode(opened.execute_cdp_cmd("Page.printToPDF", {})["data"])
        assert pdf.startswith(b"%PDF")
    finally:
        opened.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_a_shape_that_is_still_moving_does_not_come_back(opened: Any) -> None:
    """Where the next combination has none to show."""
    seen = opened.execute_async_script(
        "const done = arguments[0], one = viewers[0];"
        "one.choose(0);"
        "setTimeout(() => {"
        "  one.choose(26);"
        "  const moving = one.shown !== null;"
        "  one.moveTo(-1);"
        "  setTimeout(() => done([moving, one.shown === null]), 700);"
        "}, 700);"
    )
    assert seen == [True, True]


def test_thousands_are_sorted_as_numbers(opened: Any) -> None:
    cells = (
        "const table = document.querySelector('.combinations');"
        "const cells = [...table.tBodies[0].rows].map((row) => row.cells[2]);"
    )
    values = ["1,234", "−5", "999", "12,345,678", "–", *22 * ["0.5"]]
    opened.execute_script(f"{cells} cells.forEach((one, k) => one.textContent = {values!r}[k])")
    opened.find_elements("css selector", ".combinations thead button")[2].click()
    order = opened.execute_script(f"{cells} return cells.map((one) => one.textContent)")
    assert order == ["−5", *22 * ["0.5"], "999", "1,234", "12,345,678", "–"]


def test_a_context_that_is_lost_leaves_the_still_picture(browser: Any, file: Path) -> None:
    show(browser, file, 1280)
    assert not find(browser, ".still").is_displayed()
    browser.execute_script("viewers[0].drawing.gl.getExtension('WEBGL_lose_context').loseContext()")
    until(lambda: find(browser, ".still").is_displayed())
    assert not find(browser, ".stage canvas").is_displayed()
    find(browser, "#theme").click()  # all else goes on
    find(browser, "#theme").click()
