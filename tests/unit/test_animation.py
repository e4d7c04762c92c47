"""Films of a run, and its snapshots as PyVista has them."""

import subprocess
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
import pyvista
import shell
from PIL import Image

import viscopoint as vp

WHITE = 250  # of 255


def pictures(film: Path) -> list[np.ndarray]:
    """Return the pictures of a film, each once."""
    if film.suffix == ".gif":
        with Image.open(film) as file:
            return [np.array(_at(file, number).convert("RGB")) for number in range(file.n_frames)]  # pyright: ignore
    line = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", film, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    size = (160, 128)
    raw = np.frombuffer(subprocess.run(line, capture_output=True, check=True).stdout, np.uint8)
    return list(raw.reshape(-1, size[1], size[0], 3))


def _at(file: Any, number: int) -> Any:
    file.seek(number)
    return file


def rod_in(picture: np.ndarray) -> np.ndarray:
    """Return which rows of a picture show a part of the rod, left of the scale."""
    return np.asarray((picture[:, : int(0.8 * picture.shape[1])] < WHITE).any(axis=(1, 2)))


@pytest.mark.parametrize("kind", ["gif", "mp4"])
def test_a_film_shows_the_rod_fall_and_shorten(finished: Path, tmp_path: Path, kind: str):
    run = vp.Run(finished)
    film = run.animate(tmp_path / f"film.{kind}", "displacement", size=(160, 128))
    shown = pictures(film)
    first, last = (np.flatnonzero(rod_in(picture[20:])) for picture in (shown[0], shown[-1]))  # below the time
    assert len(shown) >= len(run.times)
    # seen from 15 degrees above in parallel, the rod's top falls by v t cos 15
    places = np.concatenate([run.snapshot(n)["position"] for n in range(len(run.times))])
    cos, sin = np.cos(np.radians(15.0)), np.sin(np.radians(15.0))
    pixels = 128 / (1.08 * (cos * np.ptp(places[:, 2]) + sin * np.ptp(places[:, 1])))
    assert last[0] - first[0] == pytest.approx(150.0 * run.times[-1] * cos * pixels, abs=1.5)
    assert [path.name for path in tmp_path.iterdir()] == [film.name]


def test_where_no_film_can_be_made_a_gif_is(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.warns(vp.ViscopointWarning, match=r"an MP4 takes imageio-ffmpeg .*film\.gif is written instead"):
        film = vp.Run(finished).animate(tmp_path / "film.mp4", size=(160, 128))
    assert film == tmp_path / "film.gif"


@pytest.mark.parametrize(
    ("file", "named", "told"),
    [
        ("film.avi", {}, r"film\.avi: write a file \.mp4 or \.gif"),
        ("film.gif", {"seconds": 0.0}, "in more than 0 seconds"),
        ("film.gif", {"size": (160,)}, "of two sizes"),
        ("film.gif", {"field": "stress"}, "field 'stress': did you mean 'stress_"),
        ("film.gif", {"field": "velocity_q"}, "field 'velocity_q': did you mean 'velocity"),
    ],
)
def test_a_film_that_cannot_be_is_refused_and_nothing_written(
    finished: Path, tmp_path: Path, file: str, named: dict[str, Any], told: str
):
    with pytest.raises(vp.InputError, match=told):
        vp.Run(finished).animate(tmp_path / file, **named)
    assert list(tmp_path.iterdir()) == []


def test_the_command_writes_a_film_once(finished: Path, tmp_path: Path):
    words = ("animate", finished, "--field", "von_mises", "--out", tmp_path / "film.gif")
    code, out, messages = shell.call(*words)
    assert (code, out.strip(), messages) == (0, str(tmp_path / "film.gif"), "")
    code, _, messages = shell.call(*words)
    assert (code, "already there; --force replaces it" in messages) == (2, True)
    assert shell.call(*words, "--force")[0] == 0


def test_a_snapshot_is_a_grid_of_pyvista_s(finished: Path, finished_fem: Path):
    for folder, kind in ((finished, pyvista.CellType.VERTEX), (finished_fem, pyvista.CellType.HEXAHEDRON)):
        run = vp.Run(folder)
        grid, snapshot = run.to_pyvista("2 us"), run.snapshot("2 us")
        assert set(grid.celltypes) == {kind}
        assert np.array_equal(grid.points, snapshot["position"])
        for name, field in snapshot.fields.items():
            data = grid.cell_data if field.on == "cells" else grid.point_data
            assert name == "position" or np.array_equal(data[name], field.values), name


def test_a_number_per_point_is_that_of_a_component_or_a_length(finished: Path):
    snapshot = vp.Run(finished).snapshot(-1)
    assert np.array_equal(snapshot.scalar("stress_zx")[0], snapshot["stress"][:, 5])
    assert np.array_equal(snapshot.scalar("velocity_y")[0], snapshot["velocity"][:, 1])
    assert np.allclose(snapshot.scalar("velocity")[0], np.sqrt((snapshot["velocity"] ** 2).sum(axis=1)))
    assert snapshot.scalar("von_mises")[1] == "MPa"
