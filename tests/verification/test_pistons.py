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

import viscopoint as vp
from viscopoint.errors import InputError
from viscopoint.interactions.planes import MovingPlane, Plane
from viscopoint.model.build import Model
from viscopoint.model.guards import is_finite
from viscopoint.model.simulation import Simulation

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
RESTING: dict[str, Any] = {
    "stiffness": lambda: bricks.column(CELLS, bricks.STIFF, ELASTIC),
    "tlmpm": lambda: lagrangian.column(CELLS, ELASTIC),
    "mpm": lambda: columns.column(CELLS, ELASTIC),
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


def simulation(method: Any, energy_error: float = 0.05) -> Simulation:
    """Return a simulation of a column until ``TIME``, as of a case; the rod that the case describes takes no part."""
    surface = method.body.surface._replace(contact_height=0.5 * CELL)
    method.body = method.body._replace(surface=surface)
    case = vp.Case.load("paper", {"time.end": f"{TIME} ms", "time.snapshots": []})
    return Simulation(Model(case.with_(guards={"energy_error": energy_error}), (method,)))


@pytest.mark.parametrize("make", COLUMNS.values(), ids=COLUMNS.keys())
def test_errors_of_a_column_at_rest_are_shares_of_the_work_of_its_piston(make: Any) -> None:
    method = make()
    struck = simulation(method)
    outcome, reference = struck.run(), struck.balances[0].reference
    assert outcome.status == "complete"
    assert all(map(is_finite, outcome.rows))
    work = method.totals().mass / LENGTH * SOUND * SPEED**2 * TIME
    assert_allclose(reference.energy, work, rtol=CELL / (SOUND * TIME))
    assert_allclose(reference.energy, -outcome.rows[-1].contact, rtol=1e-12)
    # ρ A U² h C² / 2 of the waves behind the front (see above), of m U² / 2 until more work is done
    assert 0.0 < outcome.energy_error < COURANT**2 * CELL / LENGTH
    stopped = simulation(make(), 0.5 * outcome.energy_error).run()
    assert stopped.status == "stopped"
    assert "% of the energy of the moving planes (guards.energy_error allows" in stopped.reason


@pytest.mark.parametrize("make", RESTING.values(), ids=RESTING.keys())
def test_where_nothing_moves_nothing_is_missing(make: Any) -> None:
    outcome = simulation(make()).run()
    assert outcome.status == "complete"
    assert all(map(is_finite, outcome.rows))
    assert max(outcome.energy_error, outcome.hourglass_share) < 1e-6


def test_energy_from_nowhere_stops_a_column_at_rest() -> None:
    method = bricks.column(CELLS, bricks.STIFF, ELASTIC)
    haunted = simulation(method)
    method.nodes.velocity[-1, 2] = SPEED
    outcome = haunted.run()
    assert outcome.status == "stopped"
    assert "the energy balance does not close: gained" in outcome.reason


class Ram:
    """A plane that pushes, from which nodes separate freely."""

    plane = Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), SPEED, 0.0, two_sided=False)
    holds = False


def test_a_moving_plane_that_does_not_hold_is_refused_on_nodes() -> None:
    with pytest.raises(InputError, match="Ram: on nodes a plane that moves must be two-sided"):
        bricks.column(4, bricks.STIFF, ELASTIC, (Ram(),))
