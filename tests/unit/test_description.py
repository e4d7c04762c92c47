from importlib import resources
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.case.description import description, physics
from viscopoint.command_line.cli import app
from viscopoint.figures import save_all
from viscopoint.reproduction.cases import main_cases, printed_cases
from viscopoint.reproduction.deviations import cases


def test_the_description_has_the_values_of_the_case():
    assert description(vp.Case.load("paper")) == (
        "radius 3.8 mm, length 25.4 mm, speed 150 m/s, gap 0.01 mm; linear-viscoelastic: density 1 g/cm^3, "
        "bulk 550 MPa, shear short 140 MPa, shear long 5 MPa, decay 650 1/ms; mpm, 0.38 mm"
    )
    changes = {"rod.radius": "0.2 in", "impact.friction": 0.25, "impact.gap": "0 mm", "material.decay": "65 1/ms"}
    case = vp.Case.load("paper", changes | {"method.geometry": "axisymmetric"}, method="fem")
    for words in ("radius 5.08 mm", "150 m/s, friction 0.25;", "decay 65 1/ms", "; fem axisymmetric, 0.38 mm"):
        assert words in description(case)


@pytest.mark.parametrize("name", sorted(vp.packaged()))
def test_titles_of_packaged_cases_repeat_no_value_that_can_be_changed(name: str):
    case = vp.Case.load(name)
    values = (case.rod.radius, case.rod.length, case.impact.speed, *dict(case.material).values())
    assert not {f"{value:g}" for value in values if isinstance(value, float)} & set(case.title.split())
    for word in ("decay", case.method.name, case.material.law, "1/ms", "m/s", "finite", "elastic"):
        assert word not in case.title


def test_a_changed_value_is_in_no_label(tmp_path: Path):
    changes = ["method.size=1.9 mm", "time.end=0.1 us", "time.snapshots=[]", "material.decay=65 1/ms"]
    words = [word for change in changes for word in ("--set", change)]
    out = str(tmp_path / "run")
    done = CliRunner().invoke(app, ["run", "paper", "--method", "fem", *words, "--out", out, "--no-figures"])
    assert done.exit_code == 0
    assert "650" not in done.stdout
    assert "decay 65 1/ms" in done.stdout.replace("\n", " ")


def test_labels_of_the_reproduction_are_made_from_the_cases():
    for name, case in (*main_cases("paper"), *printed_cases(), *cases()):
        assert case.title == vp.Case.load("paper").title, name


def test_the_list_of_cases_tells_them_apart():
    lines = CliRunner().invoke(app, ["cases"]).stdout.splitlines()
    assert [line.split()[0] for line in lines[::2]] == sorted(vp.packaged())
    assert len({line.strip() for line in lines[1::2]}) == len(vp.packaged())
    for name, line in zip(sorted(vp.packaged()), lines[1::2], strict=True):
        assert line.strip() == description(vp.Case.load(name))
    files = [path for path in resources.files("viscopoint.case.library").iterdir() if path.name.endswith(".toml")]
    assert len(files) == len(vp.packaged())


def test_every_figure_of_a_run_says_what_was_computed(finished: Path, monkeypatch: pytest.MonkeyPatch):
    run, drawn = vp.Run(finished), []
    monkeypatch.setattr(Figure, "savefig", lambda figure, part, **words: (drawn.append((figure, words)), part.touch()))
    for figure, words in (run.draw(), drawn)[1]:
        (caption,) = figure.texts
        assert caption.get_text().replace("\n", " ") == description(run.case)
        assert words["bbox_inches"].y0 < 0.0  # there is room for it, below the figure
        assert words["bbox_inches"].y1 == figure.get_size_inches()[1]
    assert len(drawn) == 4


def test_figures_of_something_else_have_no_caption(tmp_path: Path):
    made: list[Figure] = []
    save_all({"one": lambda _: (made.append(Figure()), made[0])[1]}, None, tmp_path)
    assert [text.get_text() for text in made[0].texts] == [""]


def test_physics_leaves_the_method_out():
    assert physics(vp.Case.load("copper")) == physics(vp.Case.load("copper-fem"))
