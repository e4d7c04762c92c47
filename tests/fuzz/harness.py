"""Fuzzes one kind of input, in a process of its own; ``test_fuzz`` runs this program.

    python tests/fuzz/harness.py cases scratch --inputs 20000

An input is laid down in ``scratch/inside`` and given to the code that reads it. It may be taken, or refused with
``InputError``; all else is a defect: another exception, a wait of more than five seconds, a message that would act on a
terminal, a program started, or anything written outside. What was found is in ``scratch/result.json``.

A target is a file in ``targets/``: it offers ``MODULES``, whose coverage atheris follows, and ``Target``.
"""

import argparse
import importlib
import importlib.util
import json
import os
import random
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from choices import Choices, Covered, Drawn

CORPUS, LONGEST = 64, 4096  # how many beginnings atheris has, and bytes of choices that make one input
CANARY = "nobody may touch this\n"


class Target(Protocol):
    """What is fuzzed."""

    def lay(self, choices: Choices) -> str:
        """Lay down an input by some choices, and describe it."""
        ...

    def check(self) -> None:
        """Give the input to the code; raise ``InputError`` or return, or it is a defect."""
        ...


def main() -> None:
    """Fuzz, write down what was found, and leave."""
    given = _arguments()
    sys.dont_write_bytecode = True
    inside, outside = given.folder / "inside", given.folder / "outside"
    for folder in (inside, outside):
        folder.mkdir(parents=True)
    (outside / "canary.txt").write_text(CANARY)
    (outside / "canary.toml").write_text(CANARY)
    fuzz = _atheris if given.engine == "atheris" else _hypothesis
    fuzz(given, inside)


def _arguments() -> Any:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", help="the name of a file in targets/")
    parser.add_argument("folder", type=Path, help="an empty folder for inputs and the result")
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--seeds", type=Path, help="a run folder to begin from, if the target takes one")
    parser.add_argument("--engine", choices=("atheris", "hypothesis"), default=engine())
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def engine() -> str:
    """Return what follows the code's coverage, if it is installed."""
    return "atheris" if importlib.util.find_spec("atheris") else "hypothesis"


def _begun(given: Any, inside: Path) -> tuple[Any, Callable[[Choices], None]]:
    """Return the watch, and what runs one input."""
    from watch import Watch, tree

    from viscopoint.errors import ViscopointWarning

    target: Target = importlib.import_module(f"targets.{given.target}").Target(inside, given.seeds)
    watch, before = Watch(inside), tree(given.folder / "outside")
    warnings.simplefilter("error")  # a user would see them
    warnings.simplefilter("ignore", ViscopointWarning)  # which are meant for users

    def one(choices: Choices) -> None:
        watch.run(target.check, target.lay(choices))
        if watch.counts["inputs"] == given.inputs:
            if tree(given.folder / "outside") != before:
                watch.counts["escapes"] += 1
                watch.defects["escapes: outside"] = {
                    "told": str(tree(given.folder / "outside")),
                    "input": "",
                    "times": 1,
                }
            found = {"engine": given.engine, **watch.counts, "slowest": watch.slowest, "defects": watch.defects}
            (given.folder / "result.json").write_text(json.dumps(found, indent=1))

    return watch, one


def _hypothesis(given: Any, inside: Path) -> None:
    from hypothesis import HealthCheck, Phase, seed, settings, strategies
    from hypothesis import given as given_by

    watch, one = _begun(given, inside)

    @seed(given.seed)
    @settings(
        max_examples=given.inputs, database=None, deadline=None, phases=[Phase.generate],
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
    )  # fmt: skip
    @given_by(strategies.data())
    def run(data: Any) -> None:
        one(Drawn(data))

    while watch.counts["inputs"] < given.inputs:
        run()


def _atheris(given: Any, inside: Path) -> None:
    atheris: Any = importlib.import_module("atheris")
    modules = _modules(given.target)
    with atheris.instrument_imports(include=modules, enable_loader_override=False):
        for name in modules:
            importlib.import_module(name)
    watch, one = _begun(given, inside)
    corpus = given.folder / "corpus"
    corpus.mkdir()
    dice = random.Random(given.seed)
    for number in range(CORPUS):
        (corpus / f"{number}").write_bytes(dice.randbytes(dice.randint(16, LONGEST // 2)))

    def run(data: bytes) -> None:
        one(Covered(atheris.FuzzedDataProvider(data)))
        if watch.counts["inputs"] >= given.inputs:
            os._exit(0)  # libFuzzer does not return

    limits = [
        f"-max_len={LONGEST}",
        "-len_control=0",
        "-timeout=0",
        "-rss_limit_mb=0",
        f"-artifact_prefix={given.folder}/",
    ]
    atheris.Setup([sys.argv[0], *limits, f"-seed={given.seed}", "-verbosity=0", str(corpus)], run)
    atheris.Fuzz()


def _modules(target: str) -> list[str]:
    """Return the modules whose coverage is followed, without importing them."""
    import ast

    text = (Path(__file__).parent / "targets" / f"{target}.py").read_text()
    for statement in ast.parse(text).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "MODULES":
            return list(ast.literal_eval(statement.value))
    return []


if __name__ == "__main__":
    main()
