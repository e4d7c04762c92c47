"""Finds the parts (laws, shape functions, outputs) that a package folder holds."""

import importlib
import pkgutil


def import_all(package: str) -> None:
    """Import every module of a package, so that each can register what it brings."""
    for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
        importlib.import_module(f"{package}.{module.name}")
