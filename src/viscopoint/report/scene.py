"""The content of the interactive 3-D view: the surfaces of finished runs at all snapshots, and fields on them."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from viscopoint.errors import InputError
from viscopoint.figures.revolve import turned
from viscopoint.kernels.arrays import Array
from viscopoint.model.body import Body, in_half_plane
from viscopoint.report.packing import BYTES_PER_VALUE, Packed, pack, pack_indices
from viscopoint.report.surfaces import Skin, at_points, skin_of_elements, skin_of_points, skin_of_rings
from viscopoint.results.reader import NEAR, Snapshot
from viscopoint.results.run import Run

LIMIT = 6_000_000  # bytes of all shapes; beside Plotly's 4.8 MB that leaves room for figures
COARSEST = 4  # spacings: larger cubes show no rod any more
SHADES = 33  # between them, Plotly interpolates
ROBUST = 1.0  # per cent of the values that may lie beyond either end of the colours
FAR = 1.0  # greatest extents of the body that a point may be away from where the body started; beyond it is not shown


class Quantity(NamedTuple):
    """A field that the view can show."""

    label: str
    unit: str
    field: str  # its name in a snapshot
    column: int | None  # of a vector
    ends: Callable[[float, float], tuple[float, float]]  # of the colours, from a robust range


def _as_found(low: float, high: float) -> tuple[float, float]:
    return low, high


def _symmetric(low: float, high: float) -> tuple[float, float]:
    return -max(-low, high), max(-low, high)


def _from_zero(low: float, high: float) -> tuple[float, float]:
    return 0.0, high


QUANTITIES = (
    Quantity("axial velocity", "m/s", "velocity", 2, _as_found),
    Quantity("x-displacement", "mm", "displacement", 0, _symmetric),
    Quantity("pressure", "MPa", "pressure", None, _as_found),
    Quantity("von Mises stress", "MPa", "von_mises", None, _from_zero),
)
ARRAYS = 3 + len(QUANTITIES)  # of each snapshot, the position's components first


class Shape(NamedTuple):
    """A run's surface at its snapshots."""

    material: str
    method: str
    times: tuple[float, ...]  # of the snapshots, µs
    skin: Skin
    wall: float  # height, mm
    arrays: tuple[tuple[Packed, ...], ...]  # [snapshot][x, y, z, quantities in order]


@dataclass(frozen=True)
class Scene:
    """All that the 3-D view shows."""

    times: tuple[float, ...]  # at which any run has a snapshot, µs
    box: tuple[tuple[float, float], ...]  # lowest and highest x, y, z shown, mm
    ranges: tuple[tuple[float, float], ...]  # of the colours, for each quantity
    shapes: tuple[Shape, ...]

    @property
    def materials(self) -> tuple[str, ...]:
        """The materials' labels in the order in which they came."""
        return tuple(dict.fromkeys(shape.material for shape in self.shapes))

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods' labels in the order in which they came."""
        return tuple(dict.fromkeys(shape.method for shape in self.shapes))

    @property
    def quantities(self) -> tuple[str, ...]:
        """The labels of the fields."""
        return tuple(quantity.label for quantity in QUANTITIES)

    def to_json(self) -> str:
        """Return what ``viewer.js`` reads."""
        fields = [
            {"label": quantity.label, "unit": quantity.unit, "range": ends}
            for quantity, ends in zip(QUANTITIES, self.ranges, strict=True)
        ]
        shapes = [self._table(shape) for shape in self.shapes]
        tables = {
            "materials": self.materials,
            "methods": self.methods,
            "times": self.times,
            "box": self.box,
            "colours": _colours(),
            "fields": fields,
            "shapes": shapes,
        }
        return json.dumps(tables, allow_nan=False, ensure_ascii=False, separators=(",", ":"))

    def _table(self, shape: Shape) -> dict[str, Any]:
        return {
            "material": shape.material,
            "method": shape.method,
            "times": shape.times,
            "shown": [_last_until(time, shape.times) for time in self.times],
            "wall": shape.wall,
            "edge": shape.skin.edge,
            "faces": [pack_indices(faces.ravel()) for faces in shape.skin.faces],
            "facesAt": shape.skin.faces_at,
            "arrays": [[packed._asdict() for packed in arrays] for arrays in shape.arrays],
        }


def scene_of(runs: Mapping[tuple[str, str], Run], limit: int = LIMIT) -> Scene:
    """Return the 3-D view of runs.

    Args:
        runs: by the labels of material and method, such as ("β = 650 1/ms", "FEM").
        limit: bytes that the shapes may take in the page; each run has an equal share. Material points are shown by
            fewer and larger cubes if that is needed.

    Raises:
        InputError: there is no run, one without snapshots, or one that is too large.
    """
    if not runs:
        raise InputError("the 3-D view of a report: there is no run to show")
    shapes, shown = [], []
    for (material, method), run in runs.items():
        shape, tables = _shape(run, material, method, limit / len(runs))
        shapes.append(shape)
        shown += [table[there] for table in tables if (there := np.isfinite(table).all(axis=1)).any()]
    if not shown:
        raise InputError("the 3-D view of a report: no run has a point left to show")
    times = _merged(time for shape in shapes for time in shape.times)
    ranges = (_range([table[:, 3 + k] for table in shown], quantity) for k, quantity in enumerate(QUANTITIES))
    return Scene(times, _box(shapes, shown), tuple(ranges), tuple(shapes))


def _shape(run: Run, material: str, method: str, limit: float) -> tuple[Shape, list[Array]]:
    """Return a run's shape, and what it shows at each snapshot, ``[n, ARRAYS]``."""
    snapshots = [run.snapshot(number) for number in range(len(run.times))]
    if not snapshots:
        raise InputError(f"{run.place}: has no snapshot to show")
    skin = _skin(run, snapshots, limit)
    start = run.body.position
    reach = FAR * np.ptp(start, axis=0).max()
    nearby = start.min(axis=0) - reach, start.max(axis=0) + reach
    tables = [_seen(run, snapshot, skin, nearby) for snapshot in snapshots]
    times = tuple(float(time) * 1e3 for time in run.times)
    arrays = tuple(tuple(pack(column) for column in table.T) for table in tables)
    return Shape(material, method, times, skin, -run.case.impact.gap, arrays), tables


def _skin(run: Run, snapshots: list[Snapshot], limit: float) -> Skin:
    """Return what shows, as fine as the limit allows."""
    is_mesh = len(run.body.cells) > 0
    size = np.inf
    for skin in _skins(run.body, snapshots):
        indices = 4 * sum(faces.size for faces in skin.faces) * 4 / 3
        size = len(skin.points) * len(snapshots) * ARRAYS * BYTES_PER_VALUE + indices
        if size <= limit:
            return skin
    remedy = "method.size" if is_mesh else "method.spacing"
    raise InputError(
        f"{run.place}: {len(snapshots)} snapshots would take {size / 1e6:.1f} MB of the report's 3-D view, "
        f"where {limit / 1e6:.1f} MB are left for each run; keep fewer (time.snapshots), or take a larger {remedy}"
    )


def _skins(body: Body, snapshots: list[Snapshot]) -> Iterator[Skin]:
    """Yield what shows of a body, the finest first."""
    if not len(body.cells):
        yield from (skin_of_points(body, coarser) for coarser in range(1, COARSEST + 1))
    elif in_half_plane(body):
        yield from (skin_of_rings(body, snapshots, coarser) for coarser in range(1, COARSEST + 1))
    else:
        yield skin_of_elements(body, snapshots)


def _seen(run: Run, snapshot: Snapshot, skin: Skin, nearby: tuple[Array, Array]) -> Array:
    """Return position and quantities of a snapshot's points, ``[n, ARRAYS]``; not-a-number for those not to show."""
    low, high = nearby
    with np.errstate(invalid="ignore"):
        columns = [*turned(snapshot["position"][skin.points], skin.angle).T]
        for quantity in QUANTITIES:
            values = at_points(snapshot.fields[quantity.field], snapshot, run.body)[skin.points]
            columns.append(values if quantity.column is None else turned(values, skin.angle)[:, quantity.column])
        table = np.column_stack(columns)
        there = np.isfinite(table).all(axis=1) & (snapshot["lost"][skin.points] == 0)
        there &= ((table[:, :3] >= low) & (table[:, :3] <= high)).all(axis=1)
    return np.where(there[:, None], table, np.nan)


def _box(shapes: list[Shape], shown: list[Array]) -> tuple[tuple[float, float], ...]:
    """Return the region to show: square at the wall, which is in it, with a margin."""
    places = np.concatenate([table[:, :3] for table in shown])
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.03 * float((high - low).max()) + max(shape.skin.edge for shape in shapes) / 2
    low[2] = min([low[2], *(shape.wall for shape in shapes)])
    middle, half = (low + high) / 2, float((high - low)[:2].max()) / 2 + margin
    across = [(float(place) - half, float(place) + half) for place in middle[:2]]
    return *across, (float(low[2]) - margin, float(high[2]) + margin)


def _range(values: list[Array], quantity: Quantity) -> tuple[float, float]:
    """Return the ends of a quantity's colours, rounded outwards to two digits.

    They hold, of each snapshot, all but the outermost per cent at either end: with all snapshots together, what only
    happens at the foot of one would be beyond them.
    """
    lows, highs = zip(*(np.percentile(part, [ROBUST, 100.0 - ROBUST]) for part in values), strict=True)
    low, high = quantity.ends(float(min(lows)), float(max(highs)))
    if not high > low:
        return low - 0.5, low + 0.5
    digit = 10.0 ** (np.floor(np.log10(high - low)) - 1.0)
    low, high = np.floor(low / digit + 1e-9) * digit, np.ceil(high / digit - 1e-9) * digit
    return float(f"{low:.9g}"), float(f"{high:.9g}")


def _colours() -> list[tuple[float, str]]:
    """Return the colours of the figures, from the lowest to the highest value."""
    import matplotlib
    from matplotlib.colors import to_hex

    from viscopoint.figures import COLOURS

    colours = matplotlib.colormaps[COLOURS]
    return [(float(place), to_hex(colours(place))) for place in np.linspace(0.0, 1.0, SHADES)]


def _merged(times: Iterable[float]) -> tuple[float, ...]:
    """Return times in order; of those that differ by rounding, one."""
    ordered = sorted(times)
    gaps = np.diff(ordered, prepend=-np.inf)
    return tuple(time for time, gap in zip(ordered, gaps, strict=True) if gap > NEAR * ordered[-1])


def _last_until(time: float, times: tuple[float, ...]) -> int:
    """Return the number of the last snapshot that is not later, the first if all are."""
    return max(0, int(np.searchsorted(times, time + NEAR * max(time, times[-1]), side="right")) - 1)
