"""What material points carry in every method, as a block of them has it in the workspace.

``points`` is the NamedTuple of any method whose fields have these names. A method's own columns begin at ``OWN``.
"""

from typing import Any

from viscopoint.kernels.jit import inline
from viscopoint.kernels.rows import load, store
from viscopoint.kernels.tensors import components, read, write
from viscopoint.kernels.workspace import HISTORY, columns, keep, kept
from viscopoint.materials import History

STRESS, JACOBIAN, VISCOUS, LOSS, HYPOELASTIC, VISCOUS_LOSS, OWN = columns(6, 1, 1, 1, 1, 1)
SIX = (0.0,) * 6


@inline
def recall(points: Any, p: int, work: Any, i: int, blank: History) -> None:
    """Take what point p carries to the workspace."""
    keep(work, STRESS, i, components(read(points.stress[p])))
    keep(work, HISTORY, i, load(points.history[p], blank))
    keep(work, JACOBIAN, i, points.jacobian[p])
    keep(work, VISCOUS, i, points.viscous_pressure[p])
    keep(work, LOSS, i, points.dissipated[p])
    keep(work, HYPOELASTIC, i, points.hypoelastic[p])
    keep(work, VISCOUS_LOSS, i, points.viscous_loss[p])


@inline
def remember(points: Any, p: int, work: Any, i: int, blank: History) -> None:
    """Give point p back what it carries."""
    write(points.stress[p], read(kept(work, STRESS, i, SIX)))
    store(points.history[p], kept(work, HISTORY, i, blank))
    points.jacobian[p] = kept(work, JACOBIAN, i, 0.0)
    points.viscous_pressure[p] = kept(work, VISCOUS, i, 0.0)
    points.dissipated[p] = kept(work, LOSS, i, 0.0)
    points.hypoelastic[p] = kept(work, HYPOELASTIC, i, 0.0)
    points.viscous_loss[p] = kept(work, VISCOUS_LOSS, i, 0.0)
