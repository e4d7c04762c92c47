"""Finds the parts (materials, shape functions, outputs) that a package folder holds, and keeps them by name."""

import importlib
import pkgutil
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")
K = TypeVar("K")


class Registry(dict[str, T]):
    """What cases can choose from, by the name that they use."""

    def register(self, name: str) -> Callable[[K], K]:
        """Let cases choose the decorated class or function by ``name``."""

        def add(part: K) -> K:
            self[name] = part  # pyright: ignore[reportArgumentType]
            return part

        return add


def import_all(package: str) -> None:
    """Import every module of a package, so that each can register what it brings."""
    for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
        importlib.import_module(f"{package}.{module.name}")
