"""A steady shock in a laterally confined elastic column that bulk viscosity spreads: profile, jump and loss.

The column's axial stress is p(J) = -M ln J with M = K + 4G/3, in the present and the undeformed area alike. A shock
that brings material of speed u to rest runs at D, in material coordinates, with

    u = D (1 - J1),    rho0 D^2 (1 - J1) = p(J1)        (mass and momentum; Rankine & Hugoniot)

Within it p + q = rho0 D^2 (1 - J): the Rayleigh line. So q(J) is known whatever the viscosity, and the viscosity says
how fast J falls there: q = A Jdot + B Jdot^2, with q = rho l |d| (linear c + quadratic l |d|) and rho = rho0 / J,
d = Jdot / J, c = c0 sqrt(J) and l = h J, or l = h of a grid that does not deform. The work of q is what the jump costs
more than the elastic energy, e(J) = M (J ln J - J + 1).
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import root_scalar


class Shock(NamedTuple):
    """Density g/mm^3, modulus M MPa, speed of impact mm/ms, edge of a cell mm; and whether cells deform."""

    density: float
    modulus: float
    speed: float
    cell: float
    follows: bool = True

    @property
    def behind(self) -> float:
        """J behind the front."""

        def excess(jacobian: float) -> float:  # rho u^2 = p (1 - J)
            return self.density * self.speed**2 + self.modulus * np.log(jacobian) * (1 - jacobian)

        return float(root_scalar(excess, bracket=(0.1, 1 - 1e-9)).root)

    @property
    def front(self) -> float:
        """D [mm/ms]."""
        return self.speed / (1 - self.behind)

    def steepest(self, linear: float, quadratic: float) -> float:
        """Return the greatest |dv/dX| = -Jdot [1/ms]."""
        jacobian = np.linspace(self.behind, 1.0, 10_001)[1:-1]  # at both ends q = 0
        q = self.density * self.front**2 * (1 - jacobian) + self.modulus * np.log(jacobian)
        length = self.cell * (jacobian if self.follows else 1.0)
        sound = np.sqrt(self.modulus / self.density * jacobian)
        a = self.density / jacobian * length * linear * sound / jacobian
        b = self.density / jacobian * quadratic * (length / jacobian) ** 2
        return float((2 * q / (a + np.sqrt(a * a + 4 * b * q))).max())

    @property
    def loss(self) -> float:
        """Energy that the viscosity takes per undeformed volume [mJ/mm^3]."""
        j = self.behind
        return 0.5 * self.density * self.speed**2 - self.modulus * (j * np.log(j) - j + 1)
