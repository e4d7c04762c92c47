"""Rings that follow the circumference: every point stands for the same volume, and all together for the cylinder.

A disc of radius R = n d is cut into n rings of thickness d. Ring i = 0, 1, ... has the area π d² (2i + 1), which
3 (2i + 1) points share: each has π d² / 3, about d². They stand at the radius r that halves the ring's area,

    r² = (r_i² + r_o²) / 2    with    r_i = i d,  r_o = (i + 1) d,

since then area times r² is π (r_o⁴ - r_i⁴) / 2: polar moment of area and moment of inertia are the cylinder's. At the
mean radius they would be too small by d² / 4 on each area, 1 / (2 n²) of the whole. Three or more points evenly around
a ring have their centroid on the axis and no preferred direction of bending. The points of every other ring start half
a distance further round.
"""

import numpy as np

from viscopoint.methods.mpm.fills import FILLS, Layer, stacked
from viscopoint.model.body import Body

INNERMOST = 3  # points of the first ring


@FILLS.register("rings")
def rod_rings(radius: float, length: float, spacing: float) -> Body:
    """Fill the rod with rings and layers whose thicknesses divide radius and length, as close to ``spacing`` as can be.

    The undeformed rod measures exactly ``radius`` and ``length``.
    """
    rings, layers = max(round(radius / spacing), 1), max(round(length / spacing), 2)
    thickness, height = radius / rings, length / layers
    ring = np.arange(rings)
    count = INNERMOST * (2 * ring + 1)
    distance = thickness * np.sqrt((ring**2 + (ring + 1) ** 2) / 2)
    of = np.repeat(ring, count)  # the ring of each point of a layer
    place = np.concatenate([np.arange(points) for points in count])
    angle = 2 * np.pi * (place + 0.5 * (of % 2)) / count[of]
    x, y = distance[of] * np.cos(angle), distance[of] * np.sin(angle)
    rim = of >= rings - 2
    volume = np.full(len(x), np.pi * thickness**2 / INNERMOST * height)
    layer = Layer(x, y, volume, rim, distance[of[rim]], contact_height=0.5 * thickness)
    return stacked(layer, layers, height, radius)
