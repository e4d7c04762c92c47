import itertools
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray

import viscopoint as vp
from conftest import SMALL
from viscopoint.reproduction.figures import FIGURES
from viscopoint.reproduction.figures.balls import picture
from viscopoint.reproduction.figures.page import BAR
from viscopoint.reproduction.figures.scene import upright
from viscopoint.reproduction.figures.solids import Paint, colours, draw_rod, half_section, whole

TIMES = {"time.end": "20 us", "time.snapshots": ["5 us", "10 us"]}
WITH_UNIT = re.compile(r"\d (µs|ms⁻¹|mm)$|\((mm|m/s)\)$|^[\d,]+ (elements|points)$")


class Witness(Mapping[str, vp.Run]):
    """Runs by name that tell which were asked for."""

    def __init__(self, runs: Mapping[str, vp.Run]) -> None:
        self.runs = runs
        self.asked: set[str] = set()

    def __getitem__(self, name: str) -> vp.Run:
        self.asked.add(name)
        return self.runs[name.partition("-")[0]]

    def __iter__(self) -> Iterator[str]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self.runs)


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> dict[str, vp.Run]:
    """One small run by each method, which stands for all of that method."""
    folder = tmp_path_factory.mktemp("paper")
    cases = {
        "mpm": vp.Case.load("paper", SMALL | TIMES),
        "fem": vp.Case.load("paper", {"method.size": "1.2 mm"} | TIMES, method="fem"),
    }
    return {name: vp.run(case, folder / name, figures=False) for name, case in cases.items()}


@pytest.fixture(scope="session")
def drawn(tiny: dict[str, vp.Run]) -> dict[str, tuple[Figure, set[str]]]:
    """All figures, and which runs they asked for."""
    drawn = {}
    for name, figure in FIGURES.items():
        witness = Witness(tiny)
        drawn[name] = figure.draw(witness), witness.asked
    return drawn


def rods(figure: Figure) -> list[tuple[Any, Any]]:
    """Return axes and the rod in each, an image or polygons."""
    scenes = [axis for axis in figure.axes if axis.get_label() != BAR]
    found = [(axis, [*axis.images, *(c for c in axis.collections if type(c) is PolyCollection)]) for axis in scenes]
    return [(axis, rod) for axis, (rod,) in found]


def corners_of(polygons: Any) -> NDArray[np.float64]:
    return np.concatenate([path.vertices for path in polygons.get_paths()])


def limits(axis: Any, rod: Any) -> tuple[float, ...]:
    size = axis.get_position().size.round(9)
    return (*axis.get_xlim(), *axis.get_ylim(), *size, rod.norm.vmin, rod.norm.vmax)


def texts(figure: Figure) -> list[Text]:
    """Return all that is written, without the labels of ticks beyond an axis, which are kept but not drawn."""
    figure.draw_without_rendering()
    beyond = set()
    for axis in (axis for each in figure.axes for axis in (each.xaxis, each.yaxis)):
        low, high = sorted(axis.get_view_interval())
        ticks = zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=True)
        beyond |= {label for place, label in ticks if not low <= place <= high}
    written = [text for text in figure.findobj(Text) if isinstance(text, Text) and text.get_visible()]
    return [text for text in written if text.get_text().strip() and text not in beyond]


def test_the_paper_s_figures_2_to_7_are_offered():
    assert list(FIGURES) == [f"fig{number}" for number in range(2, 8)]


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_needs_the_runs_that_it_draws(name: str, drawn: dict[str, tuple[Figure, set[str]]]):
    needs = FIGURES[name].needs
    assert len(needs) == len(set(needs))
    assert drawn[name][1] == set(needs)


@pytest.mark.parametrize("name", ["fig3", "fig4", "fig5", "fig6", "fig7"])
def test_panels_share_limits_and_rows_share_colours(name: str, drawn: dict[str, tuple[Figure, set[str]]]):
    figure, _ = drawn[name]
    shown = rods(figure)
    assert len(shown) == 3 * (2 if name in ("fig5", "fig7") else 1)
    assert len({limits(axis, rod)[:-2] for axis, rod in shown}) == 1
    rows = [shown[:3], shown[3:]] if name == "fig7" else [shown]
    for row in rows:
        assert len({limits(axis, rod) for axis, rod in row}) == 1
    bars = [axis.get_ylim() for axis in figure.axes if axis.get_label() == BAR]
    assert bars == [(rod.norm.vmin, rod.norm.vmax) for _, rod in (row[0] for row in rows)]


def test_figures_3_and_4_can_be_laid_side_by_side(drawn: dict[str, tuple[Figure, set[str]]]):
    third, fourth = (drawn[name][0] for name in ("fig3", "fig4"))
    assert [limits(*shown) for shown in rods(third)] == [limits(*shown) for shown in rods(fourth)]
    assert third.get_size_inches().tolist() == fourth.get_size_inches().tolist()
    words = [{text.get_text() for text in texts(figure)} for figure in (third, fourth)]
    assert words[0] ^ words[1] == {"FEM", "MPM"}


@pytest.mark.parametrize("name", FIGURES)
def test_a_rod_lies_within_its_axes(name: str, drawn: dict[str, tuple[Figure, set[str]]]):
    for axis, rod in rods(drawn[name][0]):
        if axis.spines["top"].get_visible():
            continue  # a close-up
        if isinstance(rod, PolyCollection):
            corners = corners_of(rod)
            (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
            assert ((corners > (left, low)) & (corners < (right, high))).all()
        else:
            opacity = np.asarray(rod.get_array())[..., 3]
            assert opacity.any()
            assert not any(edge.any() for edge in (opacity[0], opacity[-1], opacity[:, 0], opacity[:, -1]))


@pytest.mark.parametrize("name", FIGURES)
def test_labels_carry_their_units(name: str, drawn: dict[str, tuple[Figure, set[str]]]):
    figure, _ = drawn[name]
    labels = [axis.get_ylabel() for axis in figure.axes] + [axis.get_xlabel() for axis in figure.axes]
    words = [text.get_text() for axis in figure.axes for text in (axis.title, *axis.texts)]
    told = [label for label in labels if label] + [word for word in words if re.search(r"\d", word)]
    assert told
    assert [text for text in told if not WITH_UNIT.search(text)] == []


@pytest.mark.parametrize("name", FIGURES)
def test_words_neither_overlap_nor_leave_the_page(name: str, drawn: dict[str, tuple[Figure, set[str]]]):
    figure, _ = drawn[name]
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts(figure)]
    assert len(boxes) > 8
    assert [(a, b) for (a, one), (b, other) in itertools.combinations(boxes, 2) if one.overlaps(other)] == []
    page = figure.bbox
    assert [text for text, box in boxes if box.x0 < 0 or box.y0 < 0 or box.x1 > page.x1 or box.y1 > page.y1] == []


def test_the_nearer_ball_hides_the_one_behind_and_is_lit_from_the_upper_left():
    places = np.array([[1.0, 1.0, 5.0], [1.0, 1.0, 2.0], [1.0, 1.0, 9.0]])
    image = picture(places, np.eye(3), 0.5, np.zeros(2), (40, 40), 20.0).astype(int)
    seen = image[..., 3] > 0
    assert seen.sum() == pytest.approx(np.pi * 10**2, rel=0.03)
    assert image[seen][:, 1].min() > 0
    assert not image[seen][:, [0, 2]].any()
    assert image[25, 15, 1] > image[15, 25, 1]


def test_balls_beyond_the_edge_reach_in():
    image = picture(np.array([[-0.2, 1.0, 0.0]]), np.ones((1, 3)), 0.5, np.zeros(2), (40, 40), 20.0)
    assert image[20, :5, 3].all()
    assert not image[20, 8:, 3].any()


@pytest.mark.parametrize("method", ["mpm", "fem"])
def test_lost_material_is_not_shown(method: str, tiny: dict[str, vp.Run]):
    run = tiny[method]
    height = Paint("z (mm)", lambda snapshot: snapshot["position"][:, 2], colours("viridis"), Normalize(0.0, 26.0))
    view = upright(run.case.rod, run.case.impact.gap, 0.1)
    snapshot = run.snapshot(0)
    upper = run.body.position[:, 2] > 10.0
    snapshot["lost"][upper] = 1.0
    if method == "fem":
        snapshot["deleted"][upper[run.body.cells].any(axis=1)] = 1.0
    axis = Figure().add_subplot()
    draw_rod(axis, view, run, snapshot, height)
    if method == "fem":
        highest = corners_of(axis.collections[0])[:, 1].max()
    else:
        rows = np.flatnonzero(np.asarray(axis.images[0].get_array())[..., 3].any(axis=1))
        highest = view.extent[2] + rows.max() / (2.0 * view.pixels)
    reach = run.case.rod.radius * np.sin(view.tilt)
    assert 8.0 < highest - reach < 10.5


def test_half_a_section_leaves_out_the_quarter_in_front_at_the_right():
    corners = np.array([[x, y, 1.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    assert half_section(corners).tolist() == [True, True, False, True]
    assert whole(corners).all()
