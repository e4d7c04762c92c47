"""What the bits of a result depend on, beside the case and the package's sources.

Whoever runs a case again with the same of all this gets the same bits; with other software, another processor or other
settings of the compiler, numbers may differ in their last digits.
"""

import functools
import platform
from importlib import metadata
from typing import Any

import llvmlite.binding
from numba.core import config
from numba.core.registry import cpu_target

PACKAGES = ("numpy", "numba", "llvmlite")
SETTINGS = (  # of Numba, from its environment variables or its file of settings: they change compiled code
    "OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "ENABLE_AVX", "USING_SVML", "BOUNDSCHECK", "DISABLE_JIT",
    "LLVM_REFPRUNE_PASS", "LLVM_REFPRUNE_FLAGS",
)  # fmt: skip
KEYS = ("python", *PACKAGES, "llvm", "libc", "machine", "cpu", "cpu_features", "numba_settings")

NOT_THE_SAME = (
    "begun with other software or settings, or on another processor, so the last bits may not be those of a run that "
    "was never interrupted"
)


@functools.cache
def promise() -> dict[str, Any]:
    """Return all that the bits of results depend on here, by the names of ``KEYS``."""
    target: Any = cpu_target.target_context
    _, cpu, features = target.codegen().magic_tuple()  # what kernels are compiled for
    settings = {name: _plain(getattr(config, name)) for name in SETTINGS if hasattr(config, name)}
    return {
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in PACKAGES},
        "llvm": ".".join(map(str, llvmlite.binding.llvm_version_info)),
        "libc": " ".join(platform.libc_ver()).strip(),  # its exponentials
        "machine": platform.machine(),
        "cpu": cpu,
        "cpu_features": " ".join(word[1:] for word in features.split(",") if word.startswith("+")),
        "numba_settings": settings,
    }


def differences(earlier: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """Say which of ``KEYS`` are not the same in two records of provenance; what one lacks is not compared."""
    found: list[str] = []
    for key in KEYS:
        before, after = earlier.get(key), now.get(key)
        if before is None or after is None or before == after:
            continue
        if isinstance(before, dict) and isinstance(after, dict):
            names = [name for name in dict.fromkeys([*before, *after]) if before.get(name) != after.get(name)]
            found += [f"{key}: {name} {before.get(name)}, now {after.get(name)}" for name in names]
        elif key == "cpu_features":
            words, others = str(before).split(), str(after).split()
            told = [f"without {word}" for word in words if word not in others]
            found.append(f"{key}: now {', '.join([*told, *(f'with {word}' for word in others if word not in words)])}")
        else:
            found.append(f"{key}: {before}, now {after}")
    return found


def _plain(value: Any) -> str | int | None:
    """Return a setting as JSON has it."""
    return value if value is None or isinstance(value, str) else int(value)
