"""What a page is made of, and the writing of it as one HTML file that needs no network."""

import importlib.resources
from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from viscopoint.errors import OutputError
from viscopoint.messages import one_line
from viscopoint.report.scene import Scene
from viscopoint.results.folder import write_text

LIMIT = 15_000_000  # bytes of a page: more cannot be mailed, and opens slowly
WITHIN_SCRIPT = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}  # JSON's own


@dataclass(frozen=True)
class Verdict:
    """Whether something that was expected is in the results."""

    statement: str
    seen: bool
    measured: str  # the number behind it, with its unit


@dataclass(frozen=True)
class Picture:
    """A figure, as a PNG file, with what is to be seen in it."""

    file: Path
    caption: str
    verdicts: tuple[Verdict, ...] = ()


@dataclass(frozen=True)
class Table:
    """Numbers, as they are to be read."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


@dataclass(frozen=True)
class Paragraph:
    """Plain text."""

    text: str


@dataclass(frozen=True)
class View:
    """The interactive 3-D view."""

    scene: Scene


@dataclass(frozen=True)
class Section:
    """A chapter of the page; the navigation lists its title."""

    title: str
    parts: tuple[Picture | Table | Paragraph | View | Verdict, ...]


@dataclass(frozen=True)
class Page:
    """All of the page."""

    title: str
    lead: str  # what the page is about, in a few sentences
    sections: tuple[Section, ...]


def write_page(page: Page, path: Path) -> None:
    """Write a page whole or not at all.

    Raises:
        OutputError: the file cannot be written, a picture cannot be read, or the page would be too large.
    """
    text = page_text(page)
    size = len(text.encode())
    if size > LIMIT:
        raise OutputError(
            f"report {path}: would be {size / 1e6:.1f} MB, more than {LIMIT / 1e6:.0f} MB; leave out figures, or show "
            "fewer runs or snapshots in 3-D"
        )
    try:
        write_text(path, text)
    except OSError as error:
        raise OutputError(f"report {path}: cannot be written ({error.strerror})") from None


def page_text(page: Page) -> str:
    """Return the page's HTML."""
    from markupsafe import Markup

    has_view = any(isinstance(part, View) for section in page.sections for part in section.parts)
    return _environment().get_template("page.html").render(
        page=page,
        kind=lambda part: type(part).__name__,
        image=_image,
        json=lambda scene: Markup(_for_script(scene.to_json())),
        style=Markup(_file("style.css")),
        plotly=Markup(_within_script(_plotly())) if has_view else "",
        viewer=Markup(_within_script(_file("surfaces.js") + _file("viewer.js"))) if has_view else "",
    )  # fmt: skip


@cache
def _environment() -> Any:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    load: Callable[[str], str] = _file
    return Environment(
        loader=FunctionLoader(load), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        finalize=_showing,
    )  # fmt: skip


def _showing(value: Any) -> Any:
    """Return text in which nothing acts on what is around it; HTML in it is escaped afterwards."""
    if not isinstance(value, str) or hasattr(value, "__html__"):
        return value
    return "\n".join(map(one_line, value.split("\n")))


@cache
def _plotly() -> str:
    """Return Plotly's own code, which draws the 3-D view; it comes with the installed package."""
    from plotly.offline import get_plotlyjs

    return get_plotlyjs()


def _file(name: str) -> str:
    return (importlib.resources.files("viscopoint.report") / name).read_text(encoding="utf-8")


def _image(file: Path) -> str:
    """Return a PNG file as an address."""
    try:
        return "data:image/png;base64," + b64encode(file.read_bytes()).decode("ascii")
    except OSError as error:
        raise OutputError(f"picture {file}: cannot be read ({error.strerror})") from None


def _for_script(json: str) -> str:
    """Return JSON in which nothing can end the script element that holds it."""
    return json.translate(str.maketrans(WITHIN_SCRIPT))


def _within_script(code: str) -> str:
    """Return JavaScript of which nothing ends the script element: there, such letters stand in strings only."""
    return code.replace("</script", "<\\/script").replace("<!--", "<\\!--")
