"""A run, as who made or opened it has it."""

from pathlib import Path

from viscopoint.arguments import checked
from viscopoint.errors import InputError
from viscopoint.results.folder import FIGURES
from viscopoint.results.reader import Reader


class Run(Reader):
    """A run folder, finished or not, that can draw its figures."""

    @checked
    def draw(self, folder: str | Path | None = None) -> list[Path]:
        """Draw all figures into a folder, by default that of the run, and return their files."""
        from viscopoint.figures import draw_all  # and with it Matplotlib, for whoever draws

        if folder is not None:
            return draw_all(self, Path(folder))
        figures = self.folder / FIGURES
        if any(path.is_symlink() for path in (figures, *figures.glob("*"))):
            raise InputError(f"run folder {self.folder}: {FIGURES} has links, so figures would be drawn elsewhere")
        return draw_all(self, figures)
