"""The report as a reader meets it: a headless Chromium opens the file, looks at its pixels and works its controls.

The browser is Debian's (``apt install chromium chromium-driver``); none is ever downloaded.
"""

import io
import itertools
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray

import viscopoint as vp
from viscopoint.report.page import Page, Paragraph, Picture, Section, Table, Verdict, View, write_page
from viscopoint.report.scene import scene_of
from viscopoint.reproduction import Reproduction

BROWSER, DRIVER = Path("/usr/bin/chromium"), Path("/usr/bin/chromedriver")
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
    "--force-device-scale-factor=1",
)  # fmt: skip
WEBGL, NO_WEBGL = "--enable-unsafe-swiftshader", "--disable-3d-apis"  # drawn by the processor
NOISE = 2e-3  # of the pixels: what may differ between two drawings of the same thing
CHANGE = 2e-2  # of the pixels: less is no change that a reader sees
LONG = "a name that has no end and no place to break it " * 3

pytestmark = pytest.mark.skipif(
    not (BROWSER.is_file() and DRIVER.is_file()), reason=f"no {BROWSER} or no {DRIVER}: apt install chromium-driver"
)
Open = Callable[..., Any]


@pytest.fixture(scope="module")
def report(finished: Path, finished_fem: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    fem, mpm = vp.Run(finished_fem), vp.Run(finished)
    elastic = vp.run(
        fem.case.with_({"material.shear_long": "140 MPa", "time.end": "1 us", "time.snapshots": []}),
        folder / "elastic",
        figures=False,
    )
    scene = scene_of({("soft", "FEM"): fem, ("soft", "MPM"): mpm, ("<b>elastic</b> & so on", "FEM"): elastic})
    parts = (
        View(scene),
        Picture(finished / "figures" / "profiles.png", "Outlines.", (Verdict("it swells", True, "1 mm"),)),
        Table(LONG, tuple(f"column {number}" for number in range(20)), (("0.123456",) * 20,), LONG),
        Paragraph("x" * 500),
    )
    file = folder / "report.html"
    write_page(Page("Rods <script>alert(1)</script>", LONG, (Section("View", parts), Section(LONG, ()))), file)
    return file


@pytest.fixture(scope="module")
def start(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Open]:
    """Start a browser with options; all end with the module."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    browsers = []

    def started(*options: str) -> Any:
        choices = webdriver.ChromeOptions()
        choices.binary_location = str(BROWSER)
        for option in (*OPTIONS, f"--user-data-dir={tmp_path_factory.mktemp('browser')}", *options):
            choices.add_argument(option)
        choices.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        browser = webdriver.Chrome(options=choices, service=Service(str(DRIVER)))
        browsers.append(browser)
        browser.set_script_timeout(120)
        return browser

    yield started
    for browser in browsers:
        browser.quit()


class Reader:
    """Who reads the page, and works its controls."""

    def __init__(self, browser: Any, file: Path) -> None:
        self.browser, self.file = browser, file
        browser.set_window_size(1200, 1500)
        browser.get(file.as_uri())
        self.wait()

    def begin_again(self) -> None:
        """Set all controls to where they were when the page was opened; loading it again takes seconds."""
        self.browser.execute_script(
            "document.querySelector('form').reset();"
            "document.querySelector('form').dispatchEvent(new Event('change'));"
            "document.querySelector('[data-action=reset]').click()"
        )
        self.wait()

    def wait(self) -> None:
        """Wait until what is chosen is drawn."""
        script = "const done = arguments[0]; viscopointView.ready.then(() => done(''), (error) => done(String(error)));"
        assert self.browser.execute_async_script(script) == ""

    def find(self, selector: str) -> Any:
        return self.browser.find_element("css selector", selector)

    def choose(self, name: str, label: str) -> None:
        from selenium.webdriver.support.ui import Select

        Select(self.find(f"[data-choice='{name}']")).select_by_visible_text(label)
        self.wait()

    def press(self, selector: str, *keys: str) -> None:
        self.find(selector).send_keys(*keys)
        self.wait()

    def state(self, name: str) -> Any:
        return self.browser.execute_script(f"return viscopointView.{name}")

    def look(self) -> NDArray[np.float32]:
        """Return what the view shows, apart from its controls ``[row, column, 3]``."""
        return imread(io.BytesIO(self.find(".plot").screenshot_as_png))[:, :, :3]

    def messages(self) -> list[str]:
        """Return errors in the console since the last call, and warnings that are not the browser's own on drawing."""
        return [
            entry["message"]
            for entry in self.browser.get_log("browser")
            if entry["level"] == "SEVERE" or not any(word in entry["message"] for word in ("GL Driver", "Canvas2D"))
        ]


def changed(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Return the share of pixels that differ visibly."""
    assert one.shape == other.shape
    return float((np.abs(one - other).max(axis=2) > 0.05).mean())


@pytest.fixture(scope="module")
def opened(start: Open, report: Path) -> Reader:
    return Reader(start(WEBGL), report)


@pytest.fixture
def reader(opened: Reader) -> Iterator[Reader]:
    opened.begin_again()
    yield opened
    assert opened.messages() == []


def test_nothing_is_fetched_but_the_file_itself(reader: Reader):
    reader.press("[data-choice='time']", "\ue014")
    events = [json.loads(entry["message"])["message"] for entry in reader.browser.get_log("performance")]
    sent = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
    assert reader.file.as_uri() in sent
    own = (reader.file.as_uri(), "data:", "blob:", "chrome:", "chrome-untrusted:")  # the browser's empty tab as well
    assert [address for address in sent if not address.startswith(own)] == []


def test_title_is_text(reader: Reader):
    assert reader.browser.title == "Rods <script>alert(1)</script>"
    reader.choose("material", "<b>elastic</b> & so on")
    assert reader.state("material") == "<b>elastic</b> & so on"


def test_view_opens_with_both_methods_and_the_rods_in_colour(reader: Reader):
    assert reader.state("method") == "side by side"
    assert reader.state("field") == "axial velocity"
    assert reader.state("time") == 0
    picture = reader.look()
    colourful = np.ptp(picture, axis=2) > 0.15
    columns = picture.shape[1]
    for panel in (colourful[:, : columns * 4 // 10], colourful[:, columns * 5 // 10 : columns * 8 // 10]):
        assert panel.mean() > 0.05


def test_time_slider_changes_the_picture_and_back(reader: Reader):
    first = reader.look()
    reader.press("[data-choice='time']", "\ue014", "\ue014")  # arrow to the right
    assert reader.state("time") == 2
    assert "2 µs" in reader.find(".time label").text
    later = reader.look()
    assert changed(first, later) > CHANGE
    reader.press("[data-choice='time']", "\ue012", "\ue012")
    assert reader.state("time") == 0
    assert changed(first, reader.look()) < NOISE


def test_fields_and_methods_and_materials_change_the_picture(reader: Reader):
    reader.press("[data-choice='time']", "\ue010")  # to the end
    pictures = [reader.look()]
    for name, label in (
        ("field", "pressure"), ("field", "von Mises stress"), ("field", "x-displacement"),
        ("method", "FEM"), ("method", "MPM"), ("method", "side by side"), ("material", "<b>elastic</b> & so on"),
    ):  # fmt: skip
        reader.choose(name, label)
        assert reader.state(name) == label
        pictures.append(reader.look())
        assert changed(*pictures[-2:]) > CHANGE / 4, label


def test_run_that_ended_early_or_is_not_there_says_so(reader: Reader):
    reader.press("[data-choice='time']", "\ue010")
    reader.choose("material", "<b>elastic</b> & so on")
    assert "FEM, 1 µs (none at 2 µs)" in reader.find(".plot").text
    assert "MPM: no run" in reader.find(".plot").text


def test_dragging_rotates_both_panels_and_the_camera_stays_when_all_else_is_switched(reader: Reader):
    from selenium.webdriver.common.action_chains import ActionChains

    before, eye = reader.look(), reader.state("camera.eye")
    plot = reader.find(".plot")
    drag = ActionChains(reader.browser).move_to_element_with_offset(plot, -250, 0).click_and_hold()
    drag.move_by_offset(40, 10).move_by_offset(40, 10).release().perform()
    reader.wait()
    turned = reader.state("camera.eye")
    assert np.linalg.norm([turned[key] - eye[key] for key in "xyz"]) > 0.2
    script = "return [arguments[0].layout.scene, arguments[0].layout.scene2].map((scene) => scene?.camera.eye)"
    assert reader.browser.execute_script(script, plot) == [turned, turned]
    after = reader.look()
    assert changed(before, after) > CHANGE
    reader.press("[data-choice='time']", "\ue014")
    assert reader.browser.execute_script(script, plot) == [turned, turned]
    for name, label in (("field", "pressure"), ("method", "MPM"), ("method", "side by side")):
        reader.choose(name, label)
        assert reader.state("camera.eye") == turned
        assert reader.browser.execute_script(script, plot) == [turned, None if label == "MPM" else turned]
    reader.choose("field", "axial velocity")
    reader.press("[data-choice='time']", "\ue012")
    assert changed(after, reader.look()) < NOISE
    reader.find("[data-action='reset']").click()
    reader.wait()
    assert reader.state("camera.eye") == eye


def test_keys_turn_and_zoom_the_view(reader: Reader):
    first = reader.look()
    for key, back in (("\ue012", "\ue014"), ("\ue013", "\ue015"), ("+", "-")):
        reader.press(".plot", key, key)
        assert changed(first, reader.look()) > CHANGE
        reader.press(".plot", back, back)
        assert changed(first, reader.look()) < 5 * NOISE  # a focus ring, and half pixels


def test_every_control_is_reached_by_tab_and_has_a_name(reader: Reader):
    from selenium.webdriver.common.keys import Keys

    reader.find(".view select").send_keys("")
    names = []
    for _ in range(9):
        element = reader.browser.switch_to.active_element
        names.append(element.accessible_name.removesuffix("0 µs").strip())
        element.send_keys(Keys.TAB)
    assert names[:8] == ["material", "method", "field", "time", "Play", "nearer", "farther", "Reset view"]
    assert names[8].startswith("3-D view; arrow keys")


def test_play_runs_through_the_times_until_it_is_paused(reader: Reader):
    play = reader.find("[data-action='play']")
    play.click()
    assert play.text == "Pause"
    seen, end = set(), time.monotonic() + 60.0
    while seen != {0, 1, 2} and time.monotonic() < end:
        seen.add(reader.state("time"))
        time.sleep(0.1)  # a picture is shown seven times as long
    assert seen == {0, 1, 2}
    play.click()
    assert play.text == "Play"
    reader.wait()
    time.sleep(1.0)
    stopped = reader.state("drawn")
    time.sleep(1.5)
    assert reader.state("drawn") == stopped


@pytest.mark.parametrize("width", [360, 700])
def test_nothing_sticks_out_of_a_small_window(reader: Reader, width: int):
    size = {"width": width, "height": 1600, "deviceScaleFactor": 1, "mobile": False}
    reader.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        reader.browser.execute_async_script("dispatchEvent(new Event('resize')); setTimeout(arguments[0], 500)")
        reader.wait()
        widths = "return [document.documentElement.scrollWidth, innerWidth, arguments[0].scrollWidth]"
        page, window, plot = reader.browser.execute_script(widths, reader.find(".plot"))
        assert window == width
        assert page <= width
        assert plot <= width
        colourful = np.ptp(reader.look(), axis=2) > 0.15
        assert colourful.mean() > 0.02
    finally:
        reader.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_browser_without_webgl_says_so_in_place_of_the_view(start: Open, report: Path):
    reader = Reader(start(NO_WEBGL), report)
    assert "needs WebGL" in reader.find(".message").text
    assert not reader.find(".plot").is_displayed()
    assert not reader.find(".controls").is_displayed()
    assert reader.messages() == []


def test_the_paper_s_report_shows_its_four_rods_without_an_error(start: Open, made: Reproduction):
    assert made.report is not None
    reader = Reader(start(WEBGL), made.report)
    pictures = []
    reader.press("[data-choice='time']", "\ue010")  # to the end
    for material in ("β = 6.5 1/ms", "β = 65 1/ms", "β = 650 1/ms", "elastic"):
        reader.choose("material", material)
        assert "FEM, 20 µs" in reader.find(".plot").text
        assert "MPM, 20 µs" in reader.find(".plot").text
        pictures.append(reader.look())
    assert all(changed(one, other) > CHANGE / 4 for one, other in itertools.pairwise(pictures))
    images = reader.browser.find_elements("css selector", "figure img")
    widths = [reader.browser.execute_script("return arguments[0].naturalWidth", image) for image in images]
    assert len(widths) == 8
    assert min(widths) > 900
    verdicts = [badge.text for badge in reader.browser.find_elements("css selector", ".verdict strong")]
    assert len(verdicts) == 2 * len(made.findings)
    assert set(verdicts) == {"seen", "not seen"}
    assert reader.messages() == []
