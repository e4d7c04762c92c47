"""How material points fill the rod: one short file each, found by itself.

A fill is a function of radius, length and spacing [mm], offered under the name that a case uses, that returns an
upright rod with its foot at z = 0. Its points are about ``spacing`` apart, in at least two layers. ``MERIDIANS`` are
those of axisymmetric rods (``mpm.geometry``), under the same names.
"""

from collections.abc import Callable

from viscopoint.discovery import Registry, import_all
from viscopoint.model.body import Body

Fill = Callable[[float, float, float], Body]
EXACT_FILL = 'method.fill = "trimmed", which has the rod\'s volume, or a smaller method.spacing'
FILLS: Registry[Fill] = Registry()
MERIDIANS: Registry[Fill] = Registry()


import_all(__name__)
