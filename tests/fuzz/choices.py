"""Where a fuzzed input comes from: choices, drawn by atheris, which follows the code's coverage, or by hypothesis."""

from collections.abc import Sequence
from typing import Any, Protocol, TypeVar

T = TypeVar("T")


class Choices(Protocol):
    """What an input is made by."""

    def integer(self, low: int, high: int) -> int:
        """Choose a number from low to high, both included."""
        ...

    def data(self, most: int) -> bytes:
        """Choose up to so many bytes."""
        ...


class Covered:
    """Choices of atheris: it changes the bytes behind them, and keeps those that led to code not seen before."""

    def __init__(self, provider: Any) -> None:
        self.provider = provider

    def integer(self, low: int, high: int) -> int:
        return self.provider.ConsumeIntInRange(low, high)

    def data(self, most: int) -> bytes:
        return self.provider.ConsumeBytes(self.integer(0, most))


class Drawn:
    """Choices of hypothesis."""

    def __init__(self, data: Any) -> None:
        self.drawn = data

    def integer(self, low: int, high: int) -> int:
        from hypothesis import strategies

        return self.drawn.draw(strategies.integers(low, high))

    def data(self, most: int) -> bytes:
        from hypothesis import strategies

        return self.drawn.draw(strategies.binary(max_size=most))


def one_of(choices: Choices, things: Sequence[T]) -> T:
    return things[choices.integer(0, len(things) - 1)]


def chance(choices: Choices, percent: int) -> bool:
    return choices.integer(0, 99) >= 100 - percent
