"""The command line, called in this process."""

from pathlib import Path

from typer.testing import CliRunner

from viscopoint.command_line.cli import app


def call(*words: str | Path) -> tuple[int, str, str]:
    """Return exit code, output and messages."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr
