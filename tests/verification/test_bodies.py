"""Bodies that never touch: together they have the bits that each has alone, in the same steps."""

from typing import Any

import bricks
import columns
import lagrangian
import numpy as np
from numpy.testing import assert_array_equal

import viscopoint as vp
from viscopoint.integrators.central_differences import CentralDifferences
from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.materials.elastic import Elastic
from viscopoint.model.build import Model, build
from viscopoint.model.callbacks import Callback
from viscopoint.model.simulation import Simulation

SOFT = Elastic(density=2e-3, bulk=300.0, shear=100.0)
FALLING = (20.0, 5.0, -100.0)


def bodies() -> list[Any]:
    """Return a body of each method, of two materials; the last one stands on rollers as well."""
    sides = (rigid_wall(0.0, 0.2), symmetry_plane(0, -1.0))
    uneven = bricks.brick((2.0, 2.0, 3.0), (3, 3, 4), shake=0.1)
    return [
        bricks.fem(uneven, bricks.STIFF, bricks.ELASTIC, walls(0.3), FALLING),
        lagrangian.brick((2, 2, 3), SOFT, walls(0.1), lagrangian.flying(*FALLING)),
        columns.rod(velocity=FALLING, walls=walls(0.2), contact="gated", shape="quadratic"),
        bricks.fem(bricks.brick((2.0, 2.0, 2.0), (3, 3, 3)), bricks.SELECTIVE, SOFT, sides, (0.0, 0.0, -80.0)),
    ]


def walls(friction: float) -> tuple[Any, ...]:
    return (rigid_wall(0.0, friction),)


def test_bodies_that_never_touch_have_the_bits_that_each_has_alone() -> None:
    together, steps = bodies(), []
    integrator = CentralDifferences(together)
    for _ in range(60):
        dt = min(body.stable_step() for body in together)
        integrator.advance(dt)
        steps.append(dt)
    for alone, other in zip(bodies(), together, strict=True):
        for dt in steps:
            alone.advance(dt)
        assert abs(alone.reactions[0, 2]) > 0.0  # it has hit the wall
        for name, values in alone.state().items():
            assert_array_equal(values, other.state()[name], name)


def two_rods() -> Model:
    """Return the paper's rod twice, by two methods."""
    rod = vp.Case.load("paper", {"time.end": "4 us", "time.snapshots": ["2 us"]})
    cases = [
        rod.with_(method={"name": "tlmpm", "spacing": "0.76 mm"}),
        rod.with_(method={"name": "fem", "size": "1 mm"}),
    ]
    return Model(cases[0], tuple(build(case).method for case in cases))


def test_a_simulation_of_two_bodies_keeps_a_balance_for_each() -> None:
    simulation = Simulation(two_rods())
    outcome = simulation.run()
    assert outcome.status == "complete"
    rods = [simulation.history.of_snapshots(body) for body in (0, 1)]
    assert rods[0][-1].step == rods[1][-1].step == outcome.steps
    for rows in rods:
        assert [row.time for row in rows] == [0.0, 0.002, 0.004]
        start, end = rows[0], rows[-1]
        assert end.kinetic < start.kinetic
        assert abs(end.numerical) < 0.01 * start.kinetic
    assert not np.isclose(rods[0][-1].stored, rods[1][-1].stored, rtol=1e-6)


def test_a_body_at_rest_beside_one_that_moves_stays_so_and_is_no_division_by_zero() -> None:
    model = two_rods()
    model.bodies[1].nodes.velocity[:] = 0.0  # pyright: ignore[reportAttributeAccessIssue]
    simulation = Simulation(model)
    assert simulation.run().status == "complete"
    brought = simulation.history.row(0).kinetic
    for balance in simulation.balances:
        assert balance.reference.energy == brought
    last = simulation.balances[1].before
    # the wall's reaction to rounded stresses is all there is
    assert max(last.kinetic, last.stored, abs(last.numerical)) < 1e-20 * brought


class EndsAt(Callback):
    """Ends a run at a step, as a second Ctrl-C would."""

    def __init__(self, step: int) -> None:
        self.step = step

    def __call__(self, simulation: Simulation) -> None:
        if simulation.step == self.step:
            raise KeyboardInterrupt


def test_two_bodies_go_on_from_their_state_with_the_bits_of_a_run_that_was_never_interrupted() -> None:
    whole, cut, rest = Simulation(two_rods()), Simulation(two_rods(), [EndsAt(5)]), Simulation(two_rods())
    assert (whole.run().status, cut.run().status) == ("complete", "interrupted")
    rest.restore(cut.progress, {name: values.copy() for name, values in cut.state().items()})
    assert rest.run()._replace(wall_time=0.0) == whole.run()._replace(wall_time=0.0)
    for name, values in whole.state().items():
        assert_array_equal(values, rest.state()[name], name)
