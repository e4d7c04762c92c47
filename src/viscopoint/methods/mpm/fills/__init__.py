"""How material points fill the rod: one short file each, found by itself.

A fill is a function of radius, length and spacing [mm], offered under the name that a case uses, that returns an
upright rod with its foot at z = 0. Its points are about ``spacing`` apart, in at least two layers. ``MERIDIANS`` are
those of axisymmetric rods (``mpm.geometry``), under the same names.
"""

from collections.abc import Callable

from viscopoint.discovery import import_all
from viscopoint.model.body import Body

Fill = Callable[[float, float, float], Body]
EXACT_FILL = 'method.fill = "trimmed", which has the rod\'s volume, or a smaller method.spacing'
FILLS: dict[str, Fill] = {}
MERIDIANS: dict[str, Fill] = {}


def offer(name: str, among: dict[str, Fill] = FILLS) -> Callable[[Fill], Fill]:
    """Let cases choose the decorated fill by ``name``."""

    def register(fill: Fill) -> Fill:
        among[name] = fill
        return fill

    return register


import_all(__name__)
