"""A film of a run: its snapshots one after the other, coloured by a field, drawn by PyVista without a screen."""

import importlib.util
import warnings
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from viscopoint.errors import InputError, ViscopointWarning
from viscopoint.figures import COLOURS
from viscopoint.model.body import in_half_plane, spacing
from viscopoint.results.folder import disk_faults, whole
from viscopoint.results.run import Run, importing_pyvista

SLOWEST, FASTEST = 2, 25  # pictures a second
MARGIN, ROOM = 1.08, 0.65  # of what is seen over the body's greatest size; its greatest share of the width
BAR: Any = {
    "vertical": True, "position_x": 0.84, "position_y": 0.2, "height": 0.6, "width": 0.06, "fmt": "%.3g",
    "color": "black",
}  # fmt: skip
UP, TILT = (0.0, 0.0, 1.0), 15.0  # the camera looks down on a body by this angle


def animate(run: Run, file: Path, field: str, seconds: float, size: tuple[int, ...]) -> Path:
    """Write a film; see ``Run.animate``."""
    kinds = (".mp4", ".gif")
    if file.suffix not in kinds or len(size) != 2 or min(size) < 16 or not seconds > 0.0:
        raise InputError(
            f"{file}: write a file {' or '.join(kinds)}, of two sizes of 16 or more, in more than 0 seconds"
        )
    if len(run.times) < 2:
        raise InputError(f"{run.place}: a film takes two snapshots or more; see time.snapshots")
    if file.suffix == ".mp4" and importlib.util.find_spec("imageio_ffmpeg") is None:
        file = file.with_suffix(".gif")
        told = f"an MP4 takes imageio-ffmpeg (pip install 'viscopoint[film]'); {file} is written instead"
        warnings.warn(told, ViscopointWarning, stacklevel=4)
    size = tuple(pixels // 16 * 16 for pixels in size)  # as films want it
    pace = float(np.clip(len(run.times) / seconds, SLOWEST, FASTEST))
    limits, write = _limits(run, field), _write_film if file.suffix == ".mp4" else _write_gif
    with disk_faults(file.parent):
        file.parent.mkdir(parents=True, exist_ok=True)
        with whole(file) as part:
            write(part, _pictures(run, field, size, *limits), pace)
    return file


def _write_film(path: Path, pictures: Iterator[NDArray[np.uint8]], pace: float) -> None:
    from imageio_ffmpeg import write_frames

    first = next(pictures)
    write: Any = write_frames  # which takes any pace
    film = write(str(path), first.shape[1::-1], fps=pace, output_params=["-f", "mp4"])
    film.send(None)
    for picture in chain([first], pictures):
        film.send(np.ascontiguousarray(picture))
    film.close()


def _write_gif(path: Path, pictures: Iterator[NDArray[np.uint8]], pace: float) -> None:
    first, *rest = (Image.fromarray(picture) for picture in pictures)
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=1e3 / pace, loop=0)


def _pictures(
    run: Run, field: str, size: tuple[int, ...], low: float, high: float, corners: NDArray[np.float64]
) -> Iterator[NDArray[np.uint8]]:
    """Yield a picture of each snapshot, all with the same colours and from the same place."""
    pv = importing_pyvista()
    unit = run.snapshot(0).scalar(field)[1]
    plotter: Any = pv.Plotter(off_screen=True, window_size=size)
    for number, time in enumerate(run.times):
        snapshot = run.snapshot(number)
        values, _ = snapshot.scalar(field)
        grid = run.to_pyvista(number)
        name = f"{field} ({unit})"
        (grid.cell_data if len(values) == grid.n_cells and len(run.body.cells) else grid.point_data)[name] = values
        gone = snapshot.fields.get("deleted", snapshot.fields["lost"]).values > 0
        shown = grid.extract_cells(np.flatnonzero(~gone)) if gone.any() else grid
        plotter.clear()
        plotter.add_mesh(
            shown, scalars=name, cmap=COLOURS, clim=(low, high), point_size=_points(run, corners, size),
            render_points_as_spheres=not len(run.body.cells), scalar_bar_args=BAR,
        )  # fmt: skip
        plotter.add_text(f"{time * 1e3:.3g} µs", font_size=12, color="black")
        _look(plotter, corners, flat=in_half_plane(run.body))
        yield plotter.screenshot(return_img=True)
    plotter.close()


def _limits(run: Run, field: str) -> tuple[float, float, NDArray[np.float64]]:
    """Return the least and greatest value of all snapshots, and the corners of the box that holds the body in all."""
    least, most, boxes = np.inf, -np.inf, []
    for number in range(len(run.times)):
        snapshot = run.snapshot(number)
        values, there = snapshot.scalar(field)[0], snapshot["position"][snapshot["lost"] == 0]
        least, most = min(least, float(np.nanmin(values))), max(most, float(np.nanmax(values)))
        boxes.append((there.min(axis=0), there.max(axis=0)))
    lows, highs = zip(*boxes, strict=True)
    return least, most if most > least else least + 1.0, np.array([np.min(lows, axis=0), np.max(highs, axis=0)])


def _points(run: Run, corners: NDArray[np.float64], size: tuple[int, ...]) -> float:
    """Return how large a point is to be drawn, so that those of the undeformed body touch [pixels]."""
    return max(spacing(run.body) / _seen(corners) * min(size), 1.0)


def _seen(corners: NDArray[np.float64]) -> float:
    """Return the height of what is seen [mm]."""
    x, y, z = np.ptp(corners, axis=0)
    tilt = np.radians(TILT)
    return MARGIN * max(z * np.cos(tilt) + y * np.sin(tilt), z, x / ROOM)


def _look(plotter: Any, corners: NDArray[np.float64], flat: bool) -> None:
    """Look from the front, at a half section, or a little from above, at all that is ever there."""
    middle, tilt = corners.mean(axis=0), 0.0 if flat else np.radians(TILT)
    away = np.array([0.0, -np.cos(tilt), np.sin(tilt)]) * 10.0 * _seen(corners)
    plotter.camera.up, plotter.camera.focal_point = UP, tuple(middle)
    plotter.camera.position = tuple(middle + away)
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 0.5 * _seen(corners)
    plotter.camera.clipping_range = (1e-3, 100.0 * _seen(corners))
