"""How material points fill the rod: one short file each, found by itself.

A fill is a function of radius, length and spacing [mm], registered under the name that a case uses, that returns an
upright rod with its foot at z = 0. Its points are about ``spacing`` apart, in at least two layers. ``MERIDIANS`` are
those of axisymmetric rods (``mpm.geometry``), under the same names.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.arrays import Array
from viscopoint.model.body import Body, layered_surface

Fill = Callable[[float, float, float], Body]
EXACT_FILL = 'method.fill = "trimmed", which has the rod\'s volume, or a smaller method.spacing'
FILLS: Registry[Fill] = Registry()
MERIDIANS: Registry[Fill] = Registry()


class Layer(NamedTuple):
    """The points of a layer, one like the other."""

    x: Array  # [p], mm
    y: Array
    volume: Array  # [p], mm^3
    rim: Any  # which of them show where the surface is
    start: Array  # how far from the axis these are, mm
    contact_height: float  # ``Surface.contact_height``, mm


def stacked(layer: Layer, layers: int, thickness: float, radius: float) -> Body:
    """Return an upright rod, its foot at z = 0, of layers of a ``thickness`` [mm]."""
    x, y, count = layer.x, layer.y, len(layer.x)
    z = (np.arange(layers) + 0.5) * thickness
    position = np.stack([np.tile(x, layers), np.tile(y, layers), np.repeat(z, count)], axis=1, dtype=np.float64)
    index = np.arange(len(position)).reshape(layers, count)
    rim, start, height = layer.rim, layer.start, layer.contact_height
    surface = layered_surface(index, rim, start, radius, end_overhang=0.5, contact_height=height)
    return Body(position, np.tile(layer.volume, layers), surface)


import_all(__name__)
