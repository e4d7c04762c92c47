"""The array types of the package.

Kernels compute in double, whatever they read: rows go through ``read_row``, ``tensors.read`` or a workspace, lone
numbers through ``numpy.float64`` where another one in single meets them (``float`` leaves single as it is in kernels).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
AnyArray = NDArray[Any]
Real = type[Any]  # one of ``PRECISIONS``

PRECISIONS: dict[str, Real] = {"double": np.float64, "single": np.float32}  # of what points and elements keep
