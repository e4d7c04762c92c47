"""``summary.json``: how a run ended, and its results at the snapshots."""

import math
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from viscopoint.body import Body
from viscopoint.fem.forms import quality
from viscopoint.ledger import UNITS, Row
from viscopoint.simulation import Outcome

KEYS = {
    "wall_time": "wall_time [s]",
    "initial_energy": "initial_kinetic_energy [mJ]",
    "energy_error": "energy_error [%]",
    "momentum_error": "momentum_error [N ms]",
    "least_jacobian": "least_scaled_jacobian",
    "smallest_edge": "smallest_edge [mm]",
}


class MeshQuality(BaseModel):
    """How far the worst elements are from cubes or squares."""

    model_config = ConfigDict(populate_by_name=True, strict=True, alias_generator=lambda name: KEYS.get(name, name))

    least_jacobian: float  # scaled: 1 for a brick, 0 where an element degenerates
    greatest_aspect: float  # longest edge over shortest
    smallest_edge: float


class Summary(BaseModel):
    """What the file holds; its keys carry their units."""

    model_config = ConfigDict(populate_by_name=True, strict=True, alias_generator=lambda name: KEYS.get(name, name))

    status: Literal["running", "complete", "stopped", "interrupted"]
    reason: str = ""  # why it is not complete
    signal: str = ""  # that interrupted it
    points: int  # material points, or nodes
    elements: int = 0
    mesh: MeshQuality | None = None  # at the start
    steps: int = 0
    wall_time: float = 0.0  # of all steps but the first, which may compile
    initial_energy: float = Field(default=1.0, gt=0.0)
    energy_error: float = 0.0  # greatest ever
    momentum_error: float = 0.0  # greatest ever
    units: dict[str, str] = UNITS
    snapshots: list[dict[str, int | float | None]] = Field(
        default_factory=list
    )  # rows of the ledger; null: not a number

    @classmethod
    def of_start(cls, body: Body) -> "Summary":
        """Return the summary of a run that goes on."""
        mesh = MeshQuality(**quality(body.position, body.cells)._asdict()) if len(body.cells) else None
        return cls(status="running", points=len(body.position), elements=len(body.cells), mesh=mesh)

    def ended(self, outcome: Outcome, initial_energy: float) -> "Summary":
        """Return the summary of the run when it has ended."""
        return self.model_copy(
            update={
                "status": outcome.status,
                "reason": outcome.reason,
                "signal": outcome.signal,
                "steps": outcome.steps,
                "wall_time": outcome.wall_time,
                "initial_energy": initial_energy,
                "energy_error": 100.0 * outcome.energy_error,
                "momentum_error": outcome.momentum_error,
                "snapshots": [
                    {name: value if math.isfinite(value) else None for name, value in row._asdict().items()}
                    for row in outcome.rows
                ],
            }
        )

    def rows(self) -> list[Row]:
        """Return the ledger's rows at the snapshots; raise ``TypeError`` if the file's are others."""
        return [Row(**_with_nan(row)) for row in self.snapshots]


def _with_nan(row: dict[str, Any]) -> dict[str, Any]:
    return {name: math.nan if value is None else value for name, value in row.items()}
