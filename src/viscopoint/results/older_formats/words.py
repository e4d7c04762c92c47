"""Run folders of older formats, in today's words; what they did not measure is not a number."""

from typing import Any

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.model.body import Body

LAST = 7  # the newest format that is older
LAST_OF_OTHER_NODES = 6  # the last in which the outermost nodes of a mesh stood on the circumference
UNGUARDED, ANY = ("mass_error", "lost_share", "hourglass_share"), 1e9
ADDED = ("contact_radius", "hourglass_share", "lost_mass")  # quantities that came after it


def is_older(provenance: dict[str, Any]) -> bool:
    """Return whether a run folder's provenance is of an older format."""
    return provenance.get("format", LAST + 1) <= LAST


def has_other_nodes(provenance: dict[str, Any]) -> bool:
    """Return whether a run's mesh has other nodes than today's of the same case."""
    return provenance.get("format", LAST) <= LAST_OF_OTHER_NODES


def quantities(values: dict[str, Any], missing: Any) -> dict[str, Any]:
    """Return the quantities of a row, or columns of many, under their present names; ``missing`` for the others."""
    named = {"impact_face_radius" if name == "foot_radius" else name: value for name, value in values.items()}
    return dict.fromkeys(ADDED, missing) | named


def tables(case: dict[str, Any]) -> dict[str, Any]:
    """Return the tables of a case in present words, without the guards that there were not."""
    impact, guards, output = case.get("impact"), case.get("guards", {}), case.get("output")
    if isinstance(impact, dict) and impact.get("wall") == "symmetry":
        case = case | {"impact": impact | {"wall": "no-separation"}}
    if isinstance(output, dict) and isinstance(interval := output.get("history_interval"), str):
        every = 1 if interval.split()[:1] == ["0.0"] else interval
        case = case | {"output": {"history": {"every": every}}}
    return case | {"guards": dict.fromkeys(UNGUARDED, ANY) | guards} if isinstance(guards, dict) else case


def body(today: Body, position: Array) -> Body:
    """Return the body as it was: ``position`` is where its points were at the start.

    The outermost nodes of a mesh stood on the circumference.
    """
    surface = today.surface
    if len(today.cells) and len(surface.start):
        surface = surface._replace(start=np.full(len(surface.start), surface.radius))
    return today._replace(position=position, surface=surface)
