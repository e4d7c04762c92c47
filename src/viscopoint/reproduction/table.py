"""A reproduction as tables for the terminal."""

from collections.abc import Iterator

from rich.table import Table

from viscopoint.reproduction import Reproduction, agreement


def tables(made: Reproduction) -> Iterator[Table]:
    """Yield the statements with what was found, and how well MPM and FEM agree."""
    statements = Table("figure", "the paper says", "", "found", box=None)
    for said, found in made.findings:
        verdict = "[green]seen[/green]" if found.seen else "[red]not seen[/red]"
        statements.add_row(said.figure, said.words, verdict, found.measured)
    statements.add_row()
    yield statements
    for resolution, rows in made.agreement.items():
        title = f"MPM less FEM, {'half ' if resolution == 'fine' else ''}the paper's distances"
        table = Table(*agreement.HEAD, title=title, title_justify="left", box=None)
        for column in table.columns[2:]:
            column.justify = "right"
        for cells in agreement.differences(rows):
            table.add_row(*cells)
        table.add_row()
        yield table
