"""Bulk viscosity: a pressure that spreads a shock over a few cells (von Neumann & Richtmyer; as in DYNA3D)."""

import math
from typing import NamedTuple

from viscopoint.jit import inline


class BulkViscosity(NamedTuple):
    """q = rho l |d| (linear c + quadratic l |d|) while the volume rate d = tr D is negative."""

    linear: float  # Q2 of DYNA3D
    quadratic: float  # Q1 of DYNA3D


@inline
def viscous_speed(viscosity: BulkViscosity, length: float, sound: float, rate: float) -> float:
    """Return q / (rho l |d|) in compression, else 0 [mm/ms]."""
    return viscosity.linear * sound - viscosity.quadratic * length * rate if rate < 0.0 else 0.0


@inline
def signal_speed(sound: float, damping: float) -> float:
    """Return the speed that bounds the stable step, length / speed, with bulk viscosity [mm/ms] (DYNA3D)."""
    return damping + math.sqrt(damping * damping + sound * sound)
