"""Draws material points as lit balls into a picture of pixels, each pixel showing the ball nearest to the camera.

Balls drawn as discs from the far to the near would hide how they stand: real balls cut into each other. All have one
size, so that one stamp of heights and normals serves all; the loop runs over the pixels of the stamp.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.reproduction.figures.scene import brightness

FORM = 0.6  # share of the body's own form in the light, the rest being that of the balls
SMOOTH = 2.5  # width over which the form is averaged, in diameters of a ball
COARSE = 3  # pixels to one of the averaged form

Pixels = NDArray[np.uint8]


class Stamp(NamedTuple):
    """One ball: for each of its pixels the place in the picture, the height towards the camera, the light."""

    row: Indices
    column: Indices
    height: Array  # pixels
    light: Array


class Sight(NamedTuple):
    """What is nearest at each pixel ``[row, column]``."""

    depth: Array  # towards the camera, pixels; minus infinity where there is nothing
    owner: Indices  # the ball
    light: Array


def picture(seen: Array, colour: Array, radius: float, corner: Array, shape: tuple[int, int], fine: float) -> Pixels:
    """Return red, green, blue and opacity ``[row, column, 4]`` of a picture, its first row at the bottom.

    Args:
        seen: places across, up and away from the camera ``[p, 3]`` [mm].
        colour: red, green and blue ``[p, 3]``.
        radius: of each ball [mm].
        corner: the picture's lower left corner [mm].
        shape: its rows and columns.
        fine: pixels per mm.
    """
    sight = _look((seen - np.append(corner, 0.0)) * fine, radius * fine, shape)
    light = (1.0 - FORM) * sight.light + FORM * _form(sight.depth, round(SMOOTH * radius * fine))
    there = np.isfinite(sight.depth)
    image = np.zeros((*shape, 4), np.uint8)
    image[there, :3] = np.clip(255.0 * colour[sight.owner[there]] * light[there][:, None], 0.0, 255.0)
    image[there, 3] = 255
    return image


def _look(seen: Array, radius: float, shape: tuple[int, int]) -> Sight:
    """Return what is seen of balls at places across, up and away; all in pixels."""
    stamp = _stamp(radius)
    reach = int(stamp.row.max())
    margin = 2 * reach  # balls beyond the edge reach in, and are whole on the margin
    rows, columns = shape[0] + 2 * margin, shape[1] + 2 * margin
    column, row = np.rint(seen[:, :2] - 0.5).astype(np.int64).T + margin
    order = np.flatnonzero((np.minimum(row, column) >= reach) & (row < rows - reach) & (column < columns - reach))
    order = order[np.argsort(-seen[order, 2], kind="stable")]  # far ones first: where two share a pixel the last stays
    place, near = row[order] * columns + column[order], -seen[order, 2]
    depth, owner, light = np.full(rows * columns, -np.inf), np.zeros(rows * columns, np.int64), np.zeros(rows * columns)
    for step, height, shine in zip(stamp.row * columns + stamp.column, stamp.height, stamp.light, strict=True):
        pixel, nearest = place + step, near + height
        wins = np.flatnonzero(nearest > depth[pixel])
        pixel = pixel[wins]
        depth[pixel], owner[pixel], light[pixel] = nearest[wins], order[wins], shine
    inside = slice(margin, margin + shape[0]), slice(margin, margin + shape[1])
    whole = (rows, columns)
    return Sight(depth.reshape(whole)[inside], owner.reshape(whole)[inside], light.reshape(whole)[inside])


def _stamp(radius: float) -> Stamp:
    """Return a ball of a radius in pixels."""
    half = int(radius)
    along = np.arange(-half, half + 1, dtype=np.int64)
    row, column = np.repeat(along, len(along)), np.tile(along, len(along))
    inside = row**2 + column**2 <= radius**2
    row, column = row[inside], column[inside]
    height = np.sqrt(radius**2 - row**2 - column**2)
    return Stamp(row, column, height, brightness(np.column_stack([column, row, -height]) / radius))


def _form(depth: Array, half: int) -> Array:
    """Return the light on the body without its balls: on the depth averaged over ``half`` pixels around."""
    rough = depth[::COARSE, ::COARSE]
    there = np.isfinite(rough)
    weight = _box(there.astype(float), half // COARSE)
    total = _box(np.where(there, rough, 0.0), half // COARSE)
    smooth = np.divide(total, weight, out=np.zeros_like(rough), where=weight > 0.0)
    up, across = np.gradient(smooth, COARSE)
    normal = np.stack([-across, -up, np.full_like(up, -1.0)], axis=-1) / np.sqrt(1.0 + across**2 + up**2)[..., None]
    light = brightness(normal)
    rows, columns = depth.shape
    return light.repeat(COARSE, axis=0).repeat(COARSE, axis=1)[:rows, :columns]


def _box(values: Array, half: int) -> Array:
    """Average over the square of ``2 half + 1`` pixels around each; beyond the edge there is nothing."""
    for axis in (0, 1):
        margins = [(half + 1, half) if a == axis else (0, 0) for a in (0, 1)]
        total = np.cumsum(np.pad(values, margins), axis=axis)
        lower, upper = (np.arange(values.shape[axis]) + shift for shift in (0, 2 * half + 1))
        values = (np.take(total, upper, axis) - np.take(total, lower, axis)) / (2 * half + 1)
    return values
