"""Numbers as text for a page: 16 bits each, in base64.

A value is ``low + step code``; so it is wrong by half a step at most. One code is kept for values that are missing.
"""

from base64 import b64decode, b64encode
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices

MISSING = 65_535
BYTES_PER_VALUE = 2 * 4 / 3  # in base64


class Packed(NamedTuple):
    """An array, packed."""

    low: float
    step: float
    codes: str  # base64 of unsigned 16-bit numbers, the low byte first

    def values(self) -> Array:
        """Return what the page will show; not-a-number where a value is missing."""
        codes = np.frombuffer(b64decode(self.codes), "<u2")
        return np.where(codes == MISSING, np.nan, self.low + self.step * codes.astype(float))


def pack(values: NDArray[np.floating]) -> Packed:
    """Pack values over their own range; those that are not finite go missing."""
    there = np.isfinite(values)
    low = float(values[there].min(initial=np.inf)) if there.any() else 0.0
    high = float(values[there].max(initial=-np.inf)) if there.any() else 0.0
    step = high / (MISSING - 1) - low / (MISSING - 1)  # their difference may be too large for a float
    codes = np.full(len(values), MISSING, "<u2")
    if step > 0.0:
        codes[there] = np.rint((values[there] - low) / step).clip(0, MISSING - 1)
    else:
        codes[there] = 0
    return Packed(low, step, b64encode(codes.tobytes()).decode("ascii"))


def pack_indices(indices: Indices) -> str:
    """Return base64 of unsigned 32-bit numbers, the low byte first."""
    return b64encode(indices.astype("<u4").tobytes()).decode("ascii")
