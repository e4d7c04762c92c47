"""The state of the package's sources, as far as it can change a result."""

import functools
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

from viscopoint.kernels import outside

if TYPE_CHECKING:
    from viscopoint.case.case import Case

# These only read run folders, or time what others compute: neither compiled code nor results depend on them.
READERS = ("command_line", "figures", "comparison", "reproduction", "report", "bench")


@functools.cache
def digest() -> str:
    """Return a hash of the sources that compute and write results."""
    package = Path(__file__).parents[1]
    result = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        place = source.relative_to(package)
        if place.parts[0] not in READERS:
            result.update(str(place).encode())
            result.update(source.read_bytes())
    return result.hexdigest()[:16]


def sources_of(case: "Case") -> str:
    """Return a hash of all sources that compute and write the results of a case, laws of users included."""
    others = outside.hashed((type(case.material), type(case.material.build()), type(case.method)))
    return f"{digest()}+{others}" if others else digest()
