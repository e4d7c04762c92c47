import base64
import html.parser
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import runs_side_by_side, scene_of_runs  # noqa: F401

import viscopoint as vp
from viscopoint.errors import OutputError
from viscopoint.report import page as pages
from viscopoint.report.packing import MISSING, pack
from viscopoint.report.page import Page, Paragraph, Picture, Section, Table, Verdict, View, page_text, write_page
from viscopoint.report.scene import Scene, scene_of

ATTACK = '<script>alert(1)</script> & "it\'s"'
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


class Reader(html.parser.HTMLParser):
    """What a browser sees of a page: its elements, and the text outside scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.scripts: list[str] = []
        self.styles: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        within = {"script": self.scripts, "style": self.styles}
        within.get(self.cdata_elem or "", self.words).append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def page_of(*parts: Picture | Table | Paragraph | View | Verdict, title: str = "Rods") -> Page:
    return Page(title, "What rods do.", (Section("Results", parts),))


@pytest.fixture
def pixel(tmp_path: Path) -> Path:
    file = tmp_path / "pixel.png"
    file.write_bytes(PIXEL)
    return file


# --- the page ---


def test_every_text_is_shown_as_it_is_and_none_is_read_as_html(pixel: Path, runs: dict[tuple[str, str], vp.Run]):
    view = View(scene_of({(ATTACK, f"{name} {ATTACK}"): run for (_, name), run in runs.items()}))
    verdict = Verdict(f"1 {ATTACK}", True, f"2 {ATTACK}")
    picture = Picture(pixel, f"3 {ATTACK}", (verdict,))
    table = Table(f"4 {ATTACK}", (f"5 {ATTACK}",), ((f"6 {ATTACK}",),), f"7 {ATTACK}")
    parts = (picture, table, Paragraph(f"8 {ATTACK}"), view)
    text = page_text(Page(f"9 {ATTACK}", f"10 {ATTACK}", (Section(f"11 {ATTACK}", parts),)))
    seen = Reader(text)
    for number in range(1, 12):
        assert f"{number} {ATTACK}" in seen.text
    assert "<script>alert(1)" not in text
    assert [tag for tag, _ in seen.tags].count("script") == 3  # the scene, Plotly, the viewer
    labels = json.loads(seen.scripts[0])
    assert labels["methods"] == [f"FEM {ATTACK}", f"MPM {ATTACK}"]


def test_text_neither_turns_the_page_s_direction_nor_ends_its_writing(tmp_path: Path):
    write_page(page_of(Paragraph("one\u202e\x1b[2J"), title="\udcff"), tmp_path / "page.html")
    seen = Reader((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert "one\\u202e\\x1b[2J" in seen.text
    assert "\\udcff" in seen.text


def test_page_needs_nothing_from_elsewhere(pixel: Path, scene: Scene):
    seen = Reader(page_text(page_of(Picture(pixel, "A rod."), View(scene))))
    addresses = [values[name] or "" for _, values in seen.tags for name in ("src", "href") if name in values]
    assert all(address.startswith(("data:", "#")) for address in addresses)
    assert not {tag for tag, _ in seen.tags} & {"iframe", "object", "embed", "base"}
    assert not re.search(r"@import|url\(", "".join(seen.styles))
    policy = next(values["content"] for _, values in seen.tags if values.get("http-equiv") == "Content-Security-Policy")
    assert policy is not None
    assert policy.startswith("default-src 'none'")
    assert not re.search(r"https?:|\*", policy)


def test_links_of_the_navigation_lead_to_the_sections():
    page = Page("Rods", "", (Section("Shapes", ()), Section("Lengths", (Paragraph("None."),))))
    seen = Reader(page_text(page))
    links = [values["href"] for tag, values in seen.tags if tag == "a"]
    assert links == [f"#{values['id']}" for tag, values in seen.tags if tag == "section"]


def test_page_without_a_view_is_small():
    assert len(page_text(page_of(Paragraph("Nothing to turn.")))) < 20_000


def test_table_and_verdicts_say_what_was_measured():
    table = Table("Length at 20 µs", ("rod", "MPM [mm]"), (("soft", "22.53"), ("elastic", "23.30")), "By the driver.")
    text = page_text(page_of(table, Verdict("it swells", True, "5.8 mm"), Verdict("it leaves", False, "−31 m/s")))
    seen = Reader(text)
    assert "Length at 20 µs rod MPM [mm] soft 22.53 elastic 23.30 By the driver." in seen.text
    assert "seen it swells 5.8 mm" in seen.text
    assert "not seen it leaves −31 m/s" in seen.text
    assert [tag for tag, _ in seen.tags].count("td") == 2
    assert re.search(r"td\s*{[^}]*text-align: right", "".join(seen.styles))


def test_picture_is_in_the_page(pixel: Path):
    seen = Reader(page_text(page_of(Picture(pixel, "A rod."))))
    source = next(values["src"] for tag, values in seen.tags if tag == "img")
    assert source is not None
    assert base64.b64decode(source.removeprefix("data:image/png;base64,")) == PIXEL


def test_page_that_is_too_large_is_refused_with_its_size(tmp_path: Path):
    large = tmp_path / "large.png"
    large.write_bytes(bytes(12_000_000))
    with pytest.raises(OutputError, match=r"would be 16\.0 MB, more than 15 MB"):
        write_page(page_of(Picture(large, "Too much.")), tmp_path / "report.html")
    assert sorted(tmp_path.iterdir()) == [large]


def test_page_is_written_whole_over_an_older_one(tmp_path: Path):
    file = tmp_path / "report.html"
    file.write_text("old")
    write_page(page_of(Paragraph("β = 650 1/ms")), file)
    assert "β = 650 1/ms" in file.read_text(encoding="utf-8")
    assert list(tmp_path.iterdir()) == [file]


def test_place_that_cannot_be_written_is_named(tmp_path: Path, pixel: Path):
    for place in (tmp_path / "missing" / "report.html", pixel / "report.html", tmp_path):
        with pytest.raises(OutputError, match=re.escape(f"report {place}: cannot be written")):
            write_page(page_of(Paragraph("Lost.")), place)
    assert list(tmp_path.iterdir()) == [pixel]
    with pytest.raises(OutputError, match=r"gone\.png: cannot be read"):
        write_page(page_of(Picture(tmp_path / "gone.png", "Gone.")), tmp_path / "report.html")


def test_plotly_and_jinja_wait_until_a_page_is_written():
    code = "import sys, viscopoint.report.page as p; print([m for m in ('plotly', 'jinja2') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_code_cannot_end_its_script_element(monkeypatch: pytest.MonkeyPatch, scene: Scene):
    code = 'a = "</script><b>", b = "<!--";'
    monkeypatch.setattr(pages, "_plotly", lambda: code)
    seen = Reader(page_text(page_of(View(scene))))
    assert seen.scripts[1].replace("\\/", "/").replace("\\!", "!") == code


# --- numbers ---


@given(st.lists(st.floats(-1e300, 1e300) | st.sampled_from([np.nan, np.inf, -np.inf]), max_size=50))
def test_packed_values_are_wrong_by_half_a_step_at_most(values: list[float]):
    exact = np.array(values, float)
    packed = pack(exact)
    there = np.isfinite(exact)
    found = packed.values()
    assert np.isnan(found[~there]).all()
    largest = np.abs(exact[there]).max(initial=0.0)
    rounding = 8 * np.finfo(float).eps * largest + np.finfo(float).tiny  # of low + step * code, and of its inverse
    assert (np.abs(found[there] - exact[there]) <= packed.step / 2 + rounding).all()
    assert packed.step <= 2 * largest / (MISSING - 1) * (1 + 1e-12)


def test_equal_values_are_packed_exactly():
    assert pack(np.full(3, -150.0)).values().tolist() == [-150.0] * 3
