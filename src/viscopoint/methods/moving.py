"""What bodies of all methods have in common: a material, interactions, their sums, and how points are shown."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from viscopoint.errors import InputError
from viscopoint.integrators import central_differences
from viscopoint.interactions.planes import Interaction
from viscopoint.interactions.rows import FRICTION_WORK, NORMAL_WORK
from viscopoint.kernels.arrays import AnyArray, Array
from viscopoint.kernels.slabs import CHUNKS
from viscopoint.materials import Material
from viscopoint.materials.block import MaterialBlock
from viscopoint.model import points
from viscopoint.model.body import Body
from viscopoint.model.method import Field, Totals, history_fields, von_mises_of
from viscopoint.model.nodes import SUMS
from viscopoint.model.points import MaterialState, VolumeState, sum_energies

FIELDS = {  # what snapshots may show; a material's history fields have other names
    "position", "displacement", "velocity", "stress", "von_mises", "pressure", "jacobian", "scaled_jacobian",
    "viscous_pressure", "dissipated_energy", "hourglass_energy", "lost", "deleted",
}  # fmt: skip


class MovingBody(central_differences.Body, ABC):
    """A body on its way through the steps of ``integrators.central_differences``."""

    planes: Any  # what acts on it

    def __init__(self, body: Body, material: Material, time_step_factor: float) -> None:
        self.body, self.material = body, material
        self.block = MaterialBlock(material)
        _check_names(self.block)
        self._alone: central_differences.CentralDifferences | None = None  # of ``advance``
        self.time_step_factor = time_step_factor
        self.sound = float(np.sqrt(material.p_wave_modulus / material.density))  # of the undeformed material, mm/ms

    @property
    def interactions(self) -> Sequence[Interaction]:
        """What acts on it from outside."""
        return self.planes.interactions

    @property
    def external_work(self) -> float:
        """What interactions did on the body since the start; below zero: what they took [mJ]."""
        return float(self.reactions[:, [NORMAL_WORK, FRICTION_WORK]].sum())

    @property
    def reactions(self) -> Array:
        """What each interaction did to the body since the start (``interactions.rows.REACTIONS``)."""
        return self.planes.reactions

    @reactions.setter
    def reactions(self, place: Array) -> None:
        self.planes.reactions = place

    def advance(self, dt: float) -> None:
        """Advance this body alone by one step [ms]."""
        if self._alone is None or not self._alone.drives(self):
            self._alone = central_differences.CentralDifferences((self,))
        self._alone.advance(dt)

    @abstractmethod
    def states(self) -> tuple[MaterialState, VolumeState, Array]:
        """Return what the material has at the points, what they share, and their reference volumes [mm^3]."""

    @abstractmethod
    def sum_motion(self, sums: Array) -> None:
        """Fill the rows of ``sums[chunk, 5]`` with kinetic energy, mass and momentum."""

    @property
    @abstractmethod
    def resultant(self) -> Sequence[float]:
        """1 along axes along which the whole body has a momentum, else 0."""

    def hourglass_energy(self) -> float:
        """Return what the control of hourglass modes has taken [mJ]."""
        return 0.0

    def totals(self) -> Totals:
        moving, straining = np.empty((CHUNKS, SUMS)), np.empty((CHUNKS, points.SUMS))
        self.sum_motion(moving)
        sum_energies(*self.states(), self.block.code, straining)
        kinetic, mass, *momentum = np.add.reduce(moving).tolist()
        energies, reactions = np.add.reduce(straining).tolist(), np.add.reduce(self.reactions)
        along = np.array(self.resultant)
        return Totals(
            kinetic=kinetic,
            stored=energies[points.STORED_ENERGY],
            dissipated=energies[points.DISSIPATED_ENERGY],
            hypoelastic=energies[points.HYPOELASTIC_WORK],
            viscous=energies[points.VISCOUS_WORK],
            hourglass=self.hourglass_energy(),
            eroded=energies[points.ERODED_ENERGY],
            contact=0.0 - float(reactions[NORMAL_WORK]),
            friction=0.0 - float(reactions[FRICTION_WORK]),
            momentum=along * momentum,
            impulse=along * reactions[:3],
            mass=mass,
        )

    @abstractmethod
    def state(self) -> dict[str, AnyArray]:
        """Return exactly what ``restore`` needs to go on as if nothing had happened."""

    def restore(self, state: dict[str, AnyArray]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]

    def fields_of_points(self, position: Array, velocity: Array, lost: AnyArray) -> dict[str, Field]:
        """Return all fields of material points."""
        material, shared, _ = self.states()
        fields = {
            "position": Field(position, "mm"),
            "displacement": Field(position - self.body.position, "mm"),
            "velocity": Field(velocity, "m/s"),
            "stress": Field(material.stress, "MPa"),
            "von_mises": Field(von_mises_of(material.stress), "MPa"),
            "pressure": Field(-material.stress[:, :3].mean(axis=1), "MPa"),
            "jacobian": Field(shared.jacobian, "1"),
            "viscous_pressure": Field(shared.viscous_pressure, "MPa"),
            "dissipated_energy": Field(material.dissipated, "mJ/mm^3"),
            "lost": Field(lost, "1"),
        }
        return self.shown(fields, material.history)

    def shown(
        self, fields: dict[str, Field], history: Array, on: Literal["points", "cells"] = "points"
    ) -> dict[str, Field]:
        """Return copies of a snapshot's fields, and the material's history beside them."""
        assert fields.keys() <= FIELDS  # or a history field could take the name
        fields |= history_fields(self.block.history_fields, history, on)
        return {name: field._replace(values=np.array(field.values)) for name, field in fields.items()}


def _check_names(block: MaterialBlock) -> None:
    """Raise ``InputError`` if a name of the material's history is that of something else."""
    names = [field.name for field in block.history_fields]
    for name in names:
        if name in FIELDS or names.count(name) > 1:
            kind = type(block.material).__name__
            raise InputError(f"material {kind}: history field '{name}': another field has this name; take another")
