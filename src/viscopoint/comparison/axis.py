"""What a run says along the rod's axis."""

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array
from viscopoint.model.body import spacing
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

CORE = 0.25  # radii from the axis: what is averaged, so that it matters little where a method has its points
NEAR = 0.75  # spacings from the axis, if that is more; on a lattice the nearest four points of a layer stand at 0.71
SAMPLES = 400  # heights at which two profiles are compared


def axial_velocity(run: Run, snapshot: Snapshot) -> tuple[Array, Array]:
    """Return height [mm] and mean axial velocity [m/s] of the layers' points around the axis, from the foot up."""
    _, height, speed = _by_layer(run, snapshot, _beside(run))
    order = np.argsort(height)
    return height[order], speed[order]


def whole(run: Run, snapshot: Snapshot) -> tuple[Array, Array]:
    """Return the same, or nothing if points around the axis are lost."""
    return (np.empty(0), np.empty(0)) if snapshot["lost"][_beside(run)].any() else axial_velocity(run, snapshot)


def _beside(run: Run) -> NDArray[np.bool_]:
    """Return which points are around the axis."""
    start = run.body.position
    return np.hypot(start[:, 0], start[:, 1]) < max(CORE * run.case.rod.radius, NEAR * spacing(run.body))


def layer_velocity(run: Run, snapshot: Snapshot) -> tuple[Array, Array]:
    """Return the height at the start [mm] and the mean axial velocity [m/s] of whole layers of the rod."""
    start, _, speed = _by_layer(run, snapshot, np.ones(len(run.body.position), bool))
    return start, speed


def _by_layer(run: Run, snapshot: Snapshot, chosen: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """Return heights at the start and now, and mean axial velocity, of layers of points that started level."""
    chosen = chosen & (snapshot["lost"] == 0) & (run.body.volume > 0.0)  # not what only shows the surface
    unit = spacing(run.body)
    layers, layer = np.unique(np.round(run.body.position[chosen, 2] / unit, 6), return_inverse=True)
    weight = run.body.volume[chosen]
    total = np.bincount(layer, weight, minlength=len(layers))
    height = np.bincount(layer, weight * snapshot["position"][chosen, 2]) / total
    speed = np.bincount(layer, weight * snapshot["velocity"][chosen, 2]) / total
    return layers * unit, height, speed


def apart(one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
    """Return the root mean square difference over the heights that both profiles have; or not-a-number."""
    if not (len(one[0]) and len(other[0])):
        return np.nan
    low, high = max(one[0][0], other[0][0]), min(one[0][-1], other[0][-1])
    if not low < high:
        return np.nan
    places = np.linspace(low, high, SAMPLES)
    return float(np.sqrt(np.mean((np.interp(places, *one) - np.interp(places, *other)) ** 2)))
