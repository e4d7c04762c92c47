"""What a mesh is made of: hexahedra, or quadrilaterals that turn around the z axis; and how good it is."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.mesh import HEXAHEDRA, Form
from viscopoint.methods.fem.section import QUADRILATERALS

FORMS = {8: HEXAHEDRA, 4: QUADRILATERALS}  # by the number of corners


class Quality(NamedTuple):
    """How far the worst elements are from cubes or squares."""

    least_jacobian: float  # scaled: det of the unit edge vectors at a corner, 1 for a brick
    greatest_aspect: float  # longest edge over shortest edge
    smallest_edge: float  # mm


def form_of(cells: Indices) -> Form:
    """Return what depends on the shape of elements ``cells[e, corners]``."""
    return FORMS[cells.shape[1]]


def quality(position: Array, corner: Indices) -> Quality:
    """Measure the mesh; elements that are degenerate or inverted have a scaled Jacobian of zero or less."""
    form, x = form_of(corner), position[corner]
    edges = np.stack([np.linalg.norm(x[:, b] - x[:, a], axis=1) for a, b in form.edges])
    return Quality(
        float(form.scaled_jacobians(position, corner).min()),
        float((edges.max(axis=0) / np.maximum(edges.min(axis=0), np.finfo(float).tiny)).max()),
        float(edges.min()),
    )
