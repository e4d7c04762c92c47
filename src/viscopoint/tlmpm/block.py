"""What a block of points has in the workspace while they are strained."""

from typing import Any

from viscopoint.jit import inline
from viscopoint.laws import History
from viscopoint.rows import load, store
from viscopoint.tensors import Matrix, components, read, write
from viscopoint.tlmpm.points import Points, deformation, keep_deformation
from viscopoint.workspace import columns, keep, kept

SIX, NINE = (0.0,) * 6, (0.0,) * 9
(
    STEP,  # F_n+1 - F_n; then the force on the areas, -V_p P_p
    DEFORMATION,  # F
    STRAIN,  # increment
    TURN,  # Q
    STRESS,  # σ
    VOLUME,  # V_p
    DETERMINANT,  # det F at the end of the step
    MID_JACOBIAN,  # det F at mid-step
    SWELLING,  # tr Δε
    JACOBIAN,  # J that the law shall see
    BEFORE,  # J that it saw before
    VISCOUS,  # pressure
    LOSS,
    HYPOELASTIC,
    VISCOUS_LOSS,
    STEP_LENGTH,  # the longest stable step
    HISTORY,
) = columns(9, 9, 6, 9, 6, *(1,) * 11)


@inline
def recall(points: Points, p: int, work: Any, i: int, blank: History) -> None:
    """Take what point p has to the workspace."""
    keep(work, DEFORMATION, i, deformation(points, p))
    keep(work, STRESS, i, components(read(points.stress[p])))
    keep(work, HISTORY, i, load(points.history[p], blank))
    keep(work, VOLUME, i, points.volume[p])
    keep(work, BEFORE, i, points.jacobian[p])
    keep(work, VISCOUS, i, points.viscous_pressure[p])
    keep(work, LOSS, i, points.dissipated[p])
    keep(work, HYPOELASTIC, i, points.hypoelastic[p])
    keep(work, VISCOUS_LOSS, i, points.viscous_loss[p])


@inline
def remember(points: Points, p: int, work: Any, i: int, blank: History) -> None:
    """Give point p back what it has in the workspace, all but F."""
    write(points.stress[p], read(kept(work, STRESS, i, SIX)))
    store(points.history[p], kept(work, HISTORY, i, blank))
    points.jacobian[p] = kept(work, JACOBIAN, i, 0.0)
    points.viscous_pressure[p] = kept(work, VISCOUS, i, 0.0)
    points.dissipated[p] = kept(work, LOSS, i, 0.0)
    points.hypoelastic[p] = kept(work, HYPOELASTIC, i, 0.0)
    points.viscous_loss[p] = kept(work, VISCOUS_LOSS, i, 0.0)


@inline
def remember_deformation(points: Points, p: int, work: Any, i: int) -> None:
    """Give point p back its F."""
    keep_deformation(points, p, Matrix(*kept(work, DEFORMATION, i, NINE)))
