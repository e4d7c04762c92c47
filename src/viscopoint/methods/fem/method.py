"""The finite element method as the driver sees it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viscopoint.errors import InputError
from viscopoint.interactions.planes import TALLY, RigidWall, Symmetry
from viscopoint.kernels.arrays import Array, Real, Rows
from viscopoint.materials import Law, step_factors
from viscopoint.methods.fem.elements import Element, Limits
from viscopoint.methods.fem.forms import form_of
from viscopoint.methods.fem.mesh import slabs
from viscopoint.methods.fem.motion import arrive, set_off
from viscopoint.methods.fem.state import (
    CHUNKS,
    Elements,
    Nodes,
    elements_at_rest,
    nodes_at_rest,
    sum_elements,
    sum_nodes,
    unload,
)
from viscopoint.model.body import Body
from viscopoint.model.method import Advice, Field, Totals, history_fields, von_mises_of
from viscopoint.model.viscosity import BulkViscosity, signal_speed

ON_PLANE = 1e-9  # of the body's extent: nodes closer than this to a plane of symmetry stand on it
CONSTANT = ("mass", "fixed", "corner", "volume")  # of what nodes and elements have
NO_WALL = RigidWall(-np.inf, 0.0)


@dataclass(frozen=True)
class Discretisation:
    """The choices that make a finite element method."""

    element: Element  # of ``fem.elements``
    safety: float  # share of the critical step to take
    viscosity: BulkViscosity
    delete_below: float = 0.0  # share of the first stable step below which elements are deleted; 0: none is
    real: Real = np.float64  # of the elements' state


class FiniteElementMethod:
    """A body of hexahedra, or of rings of quadrilateral section, moving at ``velocity`` [mm/ms] at the start."""

    advice = Advice(
        lost="elements are deleted that should deform; take a smaller method.delete_below, or 0, or a coarser mesh",
        unstable="the integration became unstable; take a smaller method.safety",
        dissipating="the integration is becoming unstable; take a smaller method.safety",
        gaining="the mesh is badly distorted, or the integration is becoming unstable; look at the last snapshot, take "
        "a smaller method.safety",
        collapsed="the mesh is too distorted. Take larger elements there (method.size) or a smaller impact speed, let "
        "such elements be deleted (method.delete_below), or use the material point method, which has no mesh to tangle",
        hourglassing="hourglass modes, which one-point elements resist by a stiffness that is none of the material's; "
        'take method.element = "selective", which has none, smaller elements, or a smaller coefficient of '
        "method.hourglass",
        losses="elements deleted",
    )

    def __init__(
        self,
        body: Body,
        law: Law,
        boundaries: tuple[RigidWall | Symmetry, ...],
        choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:
        self.body, self.law, self.element = body, law, choices.element
        self.safety, self.viscosity = choices.safety, choices.viscosity
        self.blank = (0.0,) * sum(size for _, size in law.history_fields)
        self.sound = float(np.sqrt(law.instantaneous_modulus / law.density))
        self.form = form_of(body.cells)
        volume = self.form.point_volumes(body.position, body.cells)
        volume = volume if self.element.points > 1 else volume.sum(axis=1, keepdims=True)
        self.nodes: Nodes = nodes_at_rest(body, law.density)
        self.elements: Elements = elements_at_rest(
            body.cells, volume, len(self.blank), self.element.memory, choices.real
        )
        self.slabs = slabs(body.position, body.cells)
        self.wall = NO_WALL
        for boundary in boundaries:
            self._stand_between(boundary)
        count = len(self.slabs.start) - 1
        self.limits = Limits(np.full(count, np.inf), np.full(count, -1), -1.0)
        self._find_first_step(choices.delete_below)
        self.nodes.velocity[:] = velocity
        self._allow_for_impact()
        self.tally = np.zeros(TALLY)  # of wall and planes of symmetry, since the start

    def _find_first_step(self, share: float) -> None:
        """Let elements at rest say how long a step they allow; some share of it is where they are deleted."""
        viscosity, self.viscosity = self.viscosity, BulkViscosity(0.0, 0.0)
        self._answer(1.0)
        self.viscosity = viscosity
        unload(self.elements)  # rounding
        self.nodes.force[:] = 0.0
        self.limits.weakest[:] = -1
        if share > 0.0:
            self.limits = self.limits._replace(delete_below=share * float(self.limits.critical.min()))

    def _allow_for_impact(self) -> None:
        """Shorten the first step by what bulk viscosity and flight may do in it."""
        fastest = float(np.linalg.norm(self.nodes.velocity, axis=1).max())
        linear, quadratic = self.viscosity
        damping = np.sqrt(3.0) * (linear * self.sound + quadratic * fastest)  # of a cube that is struck
        self.limits.critical[:] *= self.sound / (signal_speed(self.sound, damping) + fastest)

    def _answer(self, dt: float) -> None:
        factors = step_factors(self.law, dt)
        self.element.answer(
            self.nodes, self.elements, self.slabs, self.limits, self.law, factors, self.blank, self.sound,
            self.viscosity, dt,
        )  # fmt: skip

    def _stand_between(self, boundary: RigidWall | Symmetry) -> None:
        if isinstance(boundary, RigidWall):
            self.wall = boundary
            return
        place = self.body.position[:, boundary.axis]
        on = np.abs(place - boundary.position) <= ON_PLANE * np.ptp(self.body.position, axis=0).max()
        if not on.any():
            raise InputError(
                f"no node stands on the plane of symmetry {'xyz'[boundary.axis]} = {boundary.position:g} mm"
            )
        self.nodes.fixed[on] |= np.uint8(1 << boundary.axis)

    def stable_step(self) -> float:
        return self.safety * float(self.limits.critical.min())

    def advance(self, dt: float) -> None:
        """One step of velocity Verlet (central differences)."""
        nodes, tally = self.nodes, np.zeros((CHUNKS, TALLY))
        set_off(nodes, self.wall, dt, tally)  # v += f/m dt/2, wall, x += v dt
        self._answer(dt)  # G, J, sigma, f
        arrive(nodes, self.wall, dt, tally)  # v += f/m dt/2, wall
        self.tally += tally.sum(axis=0)

    # --- what the driver and the outputs ask ---

    def weakest(self) -> str:
        element = int(self.limits.weakest[self.limits.critical.argmin()])
        if element < 0:
            return ""
        x, y, z = self.nodes.position[self.body.cells[element]].mean(axis=0)
        state = "is turned inside out" if self.limits.critical.min() <= 0.0 else "limits it"
        return f"element {element}, at ({x:.3g}, {y:.3g}, {z:.3g}) mm, {state}"

    def totals(self) -> Totals:
        moving, straining = np.zeros((CHUNKS, 5)), np.zeros((CHUNKS, 6))
        sum_nodes(self.nodes, moving)
        sum_elements(self.elements, self.law, self.blank, straining)
        kinetic, mass, *momentum = moving.sum(axis=0)
        moving_along = np.array(self.form.moving)
        stored, dissipated, viscous, hourglass, eroded, hypoelastic = (float(sum_) for sum_ in straining.sum(axis=0))
        return Totals(
            kinetic=float(kinetic),
            stored=stored,
            dissipated=dissipated,
            hypoelastic=hypoelastic,
            viscous=viscous,
            hourglass=hourglass,
            eroded=eroded,
            contact=0.0 - float(self.tally[3]),
            friction=0.0 - float(self.tally[4]),
            momentum=moving_along * momentum,
            impulse=moving_along * self.tally[:3],
            mass=float(mass),
        )

    def positions(self) -> Array:
        if self.lost() == 0:
            return self.nodes.position
        found = self.nodes.position.copy()
        found[self._loose()] = np.nan
        return found

    def lost(self) -> int:
        return len(self.elements.alive) - int(np.count_nonzero(self.elements.alive))

    def lost_mass(self) -> float:
        return self.law.density * float(self.elements.volume[self.elements.alive == 0].sum())

    def _loose(self) -> NDArray[np.bool_]:
        """Return which nodes belong to deleted elements only."""
        loose = np.ones(len(self.nodes.mass), bool)
        loose[self.body.cells[self.elements.alive > 0]] = False
        return loose

    def snapshot(self) -> dict[str, Field]:
        nodes, elements = self.nodes, self.elements
        stress = self._mean(elements.stress)
        fields = {
            "position": Field(nodes.position, "mm"),
            "displacement": Field(nodes.position - self.body.position, "mm"),
            "velocity": Field(nodes.velocity, "m/s"),
            "lost": Field(self._loose().astype(np.uint8), "1"),
            "stress": Field(stress, "MPa", "cells"),
            "von_mises": Field(von_mises_of(stress), "MPa", "cells"),
            "pressure": Field(-stress[:, :3].mean(axis=1), "MPa", "cells"),
            "jacobian": Field(elements.jacobian, "1", "cells"),
            "scaled_jacobian": Field(self.form.scaled_jacobians(nodes.position, self.body.cells), "1", "cells"),
            "viscous_pressure": Field(elements.viscous_pressure, "MPa", "cells"),
            "dissipated_energy": Field(self._mean(elements.dissipated), "mJ/mm^3", "cells"),
            "hourglass_energy": Field(elements.hourglass_work / elements.volume.sum(axis=1), "mJ/mm^3", "cells"),
            "deleted": Field((elements.alive == 0).astype(np.uint8), "1", "cells"),
        }
        fields |= history_fields(self.law, self._mean(elements.history), "cells")
        return {name: field._replace(values=np.array(field.values)) for name, field in fields.items()}

    def _mean(self, values: Array) -> Array:
        """Average over each element's points by their volume."""
        weight = self.elements.volume / self.elements.volume.sum(axis=1, keepdims=True)
        return np.einsum("ek,ek...->e...", weight, values)

    def state(self) -> dict[str, Rows]:
        named = {**self.nodes._asdict(), **self.elements._asdict()}
        moving = {name: rows for name, rows in named.items() if name not in CONSTANT}
        return {**moving, "critical": self.limits.critical, "tally": self.tally}

    def restore(self, state: dict[str, Rows]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]
