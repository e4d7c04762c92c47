"""The finite element method as the driver sees it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viscopoint.interactions.planes import Interaction
from viscopoint.kernels.arrays import AnyArray, Array, Real
from viscopoint.materials import Material
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.forms import form_of
from viscopoint.methods.fem.internal_force import Limits, strain_elements
from viscopoint.methods.fem.mesh import slabs
from viscopoint.methods.fem.state import Elements, elements_at_rest
from viscopoint.methods.lagrangian import LagrangianBody
from viscopoint.model.body import Body
from viscopoint.model.method import FailureHints, Field, von_mises_of
from viscopoint.model.nodes import nodes_at_rest
from viscopoint.model.points import MaterialState, VolumeState
from viscopoint.model.viscosity import BulkViscosity, signal_speed

SHORT = 1e-9  # ms; in it strain is sudden for any material


@dataclass(frozen=True)
class Discretisation:
    """The choices that make a finite element method."""

    element: Element  # of ``fem.elements``
    time_step_factor: float  # share of the critical step to take
    viscosity: BulkViscosity
    delete_below: float = 0.0  # share of the first stable step below which elements are deleted; 0: none is
    real: Real = np.float64  # of the elements' state


class FiniteElementMethod(LagrangianBody):
    """A body of hexahedra, or of rings of quadrilateral section, moving at ``velocity`` [mm/ms] at the start."""

    failure_hints = FailureHints(
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
        self, body: Body, material: Material, interactions: Sequence[Interaction], choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:  # fmt: skip
        super().__init__(body, material, choices.time_step_factor)
        self.element, self.viscosity = choices.element, choices.viscosity
        self.form = form_of(body.cells)
        volume = self.form.point_volumes(body.position, body.cells)
        volume = volume if self.element.full else volume.sum(axis=1, keepdims=True)
        self.nodes = nodes_at_rest(body.position, material.density * body.volume, self.form.free(body.position))
        self.elements: Elements = elements_at_rest(
            body.cells, volume, self.block, self.element.hourglass_modes, choices.real
        )
        self.slabs = slabs(body.position, body.cells)
        self.act_on(interactions)
        count = len(self.slabs.start) - 1
        self.critical = np.full(count, np.inf)
        self.limits = Limits(self.critical, np.full(count, -1), -1.0)
        self._find_first_step(choices.delete_below)
        self.nodes.velocity[:] = velocity
        self._allow_for_impact()

    def _find_first_step(self, share: float) -> None:
        """Let elements at rest say how long a step they allow; some share of it is where they are deleted."""
        start = {name: rows.copy() for name, rows in self.state().items()}
        viscosity, self.viscosity = self.viscosity, BulkViscosity(0.0, 0.0)
        self.strain(SHORT)
        self.viscosity = viscosity
        self.restore(start | {"critical": self.critical})  # what rounding has left
        self.limits.limiting[:] = -1
        if share > 0.0:
            self.limits = self.limits._replace(delete_below=share * float(self.critical.min()))

    def _allow_for_impact(self) -> None:
        """Shorten the first step by what bulk viscosity and flight may do in it."""
        fastest = float(np.linalg.norm(self.nodes.velocity, axis=1).max())
        linear, quadratic = self.viscosity
        damping = np.sqrt(3.0) * (linear * self.sound + quadratic * fastest)  # of a cube that is struck
        self.critical[:] *= self.sound / (signal_speed(self.sound, damping) + fastest)

    def strain(self, dt: float) -> None:
        material = self.block.of_step(dt)
        strain_elements(
            self.nodes, self.elements, self.form.cell, self.element, self.slabs, self.limits, material, self.viscosity,
            dt,
        )  # fmt: skip

    # --- what the driver and the outputs ask ---

    @property
    def resultant(self) -> Sequence[float]:
        return self.form.moving

    def states(self) -> tuple[MaterialState, VolumeState, Array]:
        return self.elements.material, self.elements.shared, self.elements.volume

    def hourglass_energy(self) -> float:
        return float(self.elements.hourglass_work.sum(dtype=float))

    def own_state(self) -> dict[str, AnyArray]:
        return {
            "hourglass_force": self.elements.hourglass_force,
            "hourglass_work": self.elements.hourglass_work,
        }

    def limiting_element(self) -> str:
        element = int(self.limits.limiting[self.critical.argmin()])
        if element < 0:
            return ""
        x, y, z = self.nodes.position[self.body.cells[element]].mean(axis=0)
        state = "is turned inside out" if self.critical.min() <= 0.0 else "limits it"
        return f"element {element}, at ({x:.3g}, {y:.3g}, {z:.3g}) mm, {state}"

    def positions(self) -> Array:
        if self.lost() == 0:
            return self.nodes.position
        found = self.nodes.position.copy()
        found[self._loose()] = np.nan
        return found

    @property
    def alive(self) -> NDArray[np.bool_]:
        """Which elements are not deleted."""
        return self.elements.shared.alive > 0

    def lost(self) -> int:
        return len(self.alive) - int(np.count_nonzero(self.alive))

    def lost_mass(self) -> float:
        return self.material.density * float(self._volumes()[~self.alive].sum())

    def _volumes(self) -> Array:
        """Return the reference volume of each element's points, ``[e, k]`` [mm^3]."""
        return self.elements.volume.reshape(len(self.elements.corner), -1)

    def _loose(self) -> NDArray[np.bool_]:
        """Return which nodes belong to deleted elements only."""
        loose = np.ones(len(self.nodes.mass), bool)
        loose[self.body.cells[self.alive]] = False
        return loose

    def snapshot(self) -> dict[str, Field]:
        nodes, elements = self.nodes, self.elements
        material, shared = elements.material, elements.shared
        stress = self._mean(material.stress)
        fields = {
            "position": Field(nodes.position, "mm"),
            "displacement": Field(nodes.position - self.body.position, "mm"),
            "velocity": Field(nodes.velocity, "m/s"),
            "lost": Field(self._loose().astype(np.uint8), "1"),
            "stress": Field(stress, "MPa", "cells"),
            "von_mises": Field(von_mises_of(stress), "MPa", "cells"),
            "pressure": Field(-stress[:, :3].mean(axis=1), "MPa", "cells"),
            "jacobian": Field(shared.jacobian, "1", "cells"),
            "scaled_jacobian": Field(self.form.scaled_jacobians(nodes.position, self.body.cells), "1", "cells"),
            "viscous_pressure": Field(shared.viscous_pressure, "MPa", "cells"),
            "dissipated_energy": Field(self._mean(material.dissipated), "mJ/mm^3", "cells"),
            "hourglass_energy": Field(elements.hourglass_work / self._volumes().sum(axis=1), "mJ/mm^3", "cells"),
            "deleted": Field((~self.alive).astype(np.uint8), "1", "cells"),
        }
        return self.shown(fields, self._mean(material.history), "cells")

    def _mean(self, values: Array) -> Array:
        """Average over each element's points by their volume."""
        volume = self._volumes()
        weight = volume / volume.sum(axis=1, keepdims=True)
        return np.einsum("ek,ek...->e...", weight, values.reshape(*volume.shape, *values.shape[1:]))
