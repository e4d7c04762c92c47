"""Rules between several keys of a case, each checked as soon as its own keys are right.

So that all faults of a case come out at once: a rule on ``rod.radius`` and ``method.cell`` is checked even where the
material is wrong.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from viscopoint.errors import Fault

Check = Callable[..., str | None]


class Rule(NamedTuple):
    """``check`` gets the values of ``keys`` and says what is wrong, if anything is; the first key is to blame."""

    keys: tuple[str, ...]
    check: Check


RULES: list[Rule] = []


def rule(*keys: str) -> Callable[[Check], Check]:
    """Register the decorated check of some keys."""

    def register(check: Check) -> Check:
        RULES.append(Rule(keys, check))
        return check

    return register


def broken(values: Mapping[str, Any]) -> Iterator[Fault]:
    """Check all rules whose keys are among ``values``."""
    for keys, check in RULES:
        if all(key in values for key in keys):
            wrong = check(*(values[key] for key in keys))
            if wrong:
                yield Fault(keys[0], wrong)
