"""A piston at constant speed drives a column: a front of constant stress runs up, and the piston's work is known.

Behind the front the material moves with the piston, at U, and is strained by U/c: kinetic and stored energy are both
ρ A U² c t / 2, and the piston's push is ρ c U A. Strains are so small that what is not linear is of their size.
"""

from typing import Any

import bricks
import columns
import lagrangian
import numpy as np
import pytest
from columns import COURANT, DENSITY, ELASTIC, LENGTH, one_thread  # noqa: F401
from numpy.testing import assert_allclose

from viscopoint.errors import InputError
from viscopoint.interactions.planes import MovingPlane, Plane

pytestmark = pytest.mark.usefixtures("one_thread")
SPEED, CELLS = 1e-3, 50  # mm/ms
CELL = LENGTH / CELLS
SOUND = float(np.sqrt(ELASTIC.p_wave_modulus / DENSITY))
TIME = 0.8 * LENGTH / SOUND  # before the front arrives at the other end
PISTON = MovingPlane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), SPEED)


COLUMNS: dict[str, Any] = {
    "stiffness": lambda: bricks.column(CELLS, bricks.STIFF, ELASTIC, (PISTON,)),
    "selective": lambda: bricks.column(CELLS, bricks.SELECTIVE, ELASTIC, (PISTON,)),
    "tlmpm": lambda: lagrangian.column(CELLS, ELASTIC, (PISTON,)),
    "mpm": lambda: columns.column(CELLS, ELASTIC, (PISTON,)),
}


@pytest.mark.parametrize("make", COLUMNS.values(), ids=COLUMNS.keys())
def test_work_of_a_piston_is_what_its_column_has(make: Any) -> None:
    method = make()
    area = method.totals().mass / DENSITY / LENGTH
    start = method.totals()
    columns.advance(method, TIME)
    now, impedance = method.totals(), DENSITY * SOUND * area
    work = impedance * SPEED**2 * TIME
    # half a cell stands on the piston, whose mass U makes move at once: h / (2 c t) of the work, half of it for good
    once = 0.5 * CELL / (SOUND * TIME)
    assert_allclose(-now.contact, work, rtol=2 * once)
    assert_allclose(now.impulse[2], impedance * SPEED * TIME, rtol=2 * once)
    # the shortest waves behind the front swing by (w dt)² / 4 < C² in leapfrog steps, in about as much of the column
    assert_allclose(now.energy, start.energy, rtol=0, atol=COURANT**2 * once * work)
    assert_allclose(now.kinetic, now.stored, rtol=4 * once)


class Ram:
    """A plane that pushes, from which nodes separate freely."""

    plane = Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), SPEED, 0.0, two_sided=False)
    holds = False


def test_a_moving_plane_that_does_not_hold_is_refused_on_nodes() -> None:
    with pytest.raises(InputError, match="Ram: on nodes a plane that moves must be two-sided"):
        bricks.column(4, bricks.STIFF, ELASTIC, (Ram(),))
