"""``summary.json``: how a run ended, and its results at the snapshots."""

import math
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from viscopoint.methods.fem.forms import quality
from viscopoint.model.build import Model, mass_in_words
from viscopoint.model.energy_balance import UNITS, Row
from viscopoint.model.method import FailureHints
from viscopoint.model.simulation import LOSSES, Outcome

KEYS = {
    "wall_time": "wall_time [s]",
    "initial_energy": "initial_kinetic_energy [mJ]",
    "mass": "mass [g]",
    "mass_error": "mass_error [%]",
    "energy_error": "energy_error [%]",
    "hourglass_share": "hourglass_share [%]",
    "momentum_error": "momentum_error [N ms]",
    "least_jacobian": "least_scaled_jacobian",
    "smallest_edge": "smallest_edge [mm]",
}


ENDED = ("complete", LOSSES, "stopped")  # statuses of runs that are not to go on
DOUBTFUL_MASS, DOUBTFUL_HOURGLASSING = 0.5, 5.0  # %, beyond which a result is marked


class MeshQuality(BaseModel):
    """How far the worst elements are from cubes or squares."""

    model_config = ConfigDict(populate_by_name=True, strict=True, alias_generator=lambda name: KEYS.get(name, name))

    least_jacobian: float  # scaled: 1 for a brick, 0 where an element degenerates
    greatest_aspect: float  # longest edge over shortest
    smallest_edge: float


class Summary(BaseModel):
    """What the file holds; its keys carry their units."""

    model_config = ConfigDict(populate_by_name=True, strict=True, alias_generator=lambda name: KEYS.get(name, name))

    status: Literal["running", "complete", "complete with losses", "stopped", "interrupted"]
    reason: str = ""  # why it is not complete, or what was lost
    signal: str = ""  # that interrupted it
    points: int  # material points, or nodes
    elements: int = 0
    mesh: MeshQuality | None = None  # at the start
    mass: float = Field(default=math.nan, gt=0.0)  # of the body that is computed
    mass_error: float = 0.0  # its excess over the rod's
    steps: int = 0
    wall_time: float = 0.0  # of all steps but the first, which may compile
    initial_energy: float = Field(default=1.0, gt=0.0)
    energy_error: float = 0.0  # greatest ever
    momentum_error: float = 0.0  # greatest ever
    hourglass_share: float = 0.0  # greatest ever, see ``energy_balance.Row``
    warnings: list[str] = []  # what makes the numbers less than they seem
    units: dict[str, str] = UNITS
    snapshots: list[dict[str, int | float | None]] = Field(default_factory=list)  # history rows; null: not a number

    @classmethod
    def of_start(cls, model: Model) -> "Summary":
        """Return the summary of a run that goes on."""
        body, doubtful = model.body, 100.0 * abs(model.mass_error) > DOUBTFUL_MASS
        return cls(
            status="running",
            points=len(body.position),
            elements=len(body.cells),
            mesh=MeshQuality(**quality(body.position, body.cells)._asdict()) if len(body.cells) else None,
            mass=model.mass,
            mass_error=100.0 * model.mass_error,
            warnings=[f"{mass_in_words(model)}; take {model.case.method.finer}"] if doubtful else [],
        )

    def ended(self, outcome: Outcome, initial_energy: float, advice: FailureHints) -> "Summary":
        """Return the summary of the run when it has ended; ``advice`` is its method's."""
        doubts = [f"{outcome.reason}; {advice.lost}"] if outcome.status == LOSSES else []
        if outcome.hourglass_share > DOUBTFUL_HOURGLASSING and "hourglass" not in outcome.reason:
            told = f"hourglass control took {outcome.hourglass_share:.1f} % of the internal energy"
            doubts.append(f"{told}: {advice.hourglassing}")
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
                "hourglass_share": outcome.hourglass_share,
                "warnings": [*self.warnings, *doubts],
                "snapshots": [
                    {name: value if math.isfinite(value) else None for name, value in row._asdict().items()}
                    for row in outcome.rows
                ],
            }
        )

    @property
    def is_complete(self) -> bool:
        """Whether the run came to its end, with or without losses."""
        return self.status in ("complete", LOSSES)

    def rows(self) -> list[Row]:
        """Return the history's rows at the snapshots; raise ``TypeError`` if the file's are others."""
        return [Row(**_with_nan(row)) for row in self.snapshots]


def _with_nan(row: dict[str, Any]) -> dict[str, Any]:
    return {name: math.nan if value is None else value for name, value in row.items()}
