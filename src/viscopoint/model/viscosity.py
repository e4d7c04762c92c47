"""Bulk viscosity: a pressure that spreads a shock over a few cells (von Neumann & Richtmyer; as in DYNA3D)."""

import math
from typing import NamedTuple

from viscopoint.kernels.jit import inline


class BulkViscosity(NamedTuple):
    """q = rho l |d| (linear c + quadratic l |d|) while the volume rate d = tr D is negative."""

    linear: float  # Q2 of DYNA3D
    quadratic: float  # Q1 of DYNA3D


@inline
def viscous_speed(viscosity: BulkViscosity, length: float, sound: float, rate: float) -> float:
    """Return q / (rho l |d|) in compression, else 0 [mm/ms]."""
    return viscosity.linear * sound - viscosity.quadratic * length * rate if rate < 0.0 else 0.0


@inline
def viscous_pressure(
    viscosity: BulkViscosity, density: float, length: float, sound: float, rate: float
) -> tuple[float, float]:
    """Return q [MPa] and q / (rho l |d|) [mm/ms]."""
    damping = viscous_speed(viscosity, length, sound, rate)
    return density * length * abs(rate) * damping, damping


@inline
def signal_speed(sound: float, damping: float) -> float:
    """Return the speed that bounds the stable step, length / speed, with bulk viscosity [mm/ms] (DYNA3D)."""
    return damping + math.sqrt(damping * damping + sound * sound)


@inline
def longest_step(viscosity: BulkViscosity, stable: float, length: float, sound: float, damping: float) -> float:
    """Return the longest step of a finite element [ms].

    Its highest frequency is 2 sound / ``stable``; the viscosity's ``length`` is that of one edge, so that what swells
    along all three is damped by the ratio of the two more strongly. The linear term counts also where the element
    expands now: in the next step it may not.
    """
    return stable / signal_speed(sound, max(damping, viscosity.linear * sound) * length / stable)
