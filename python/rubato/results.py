"""Results of a run, as labelled arrays."""
from __future__ import annotations

import difflib
import os
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Union

from . import _rubato
from ._tables import dataset_of

if TYPE_CHECKING:
    import xarray

__all__ = ["Results"]


class Results(Mapping):
    """What the analyses of a study have computed: a mapping from their names to datasets of xarray.

    ``results["frf"]`` is the main table of the analysis `frf`, and ``results["response.energy"]`` another table of
    `response`, by the names of the command's CSV files. Dimensions, variables and units are those of ``results.nc``,
    but the rows of a sweep lie on its grid: ``results["frf"].amplitude`` is over the swept parameters, the angular
    frequency and the coordinates. Numbers are views of what the run has computed, without copies, and read-only.

    ``attrs`` of a dataset have what became of the analysis (``status``: ``done``, ``failed`` or ``interrupted``, with a
    ``message``), its settings and statistics; those of a variable its ``units`` and ``long_name``.
    """

    def __init__(self, run: "_rubato.Run", title: str, command: str):
        self._run, self._title, self._command = run, title, command
        self._analyses = {name: (status, message, attributes, {table[0]: table for table in tables})
                          for name, status, message, attributes, tables in run.analyses()}
        self._made: Dict[str, "xarray.Dataset"] = {}

    def status(self, analysis: str) -> str:
        """``done``, ``failed`` or ``interrupted``."""
        return self._of(analysis)[0]

    def message(self, analysis: str) -> str:
        """Why an analysis was not done; empty where it was."""
        return self._of(analysis)[1]

    def tables(self, analysis: str) -> List[str]:
        """The names of the other tables of an analysis: ``response.energy``."""
        return [f"{analysis}.{table}" for table in self._of(analysis)[3] if table]

    def _of(self, analysis: str):
        if analysis in self._analyses:
            return self._analyses[analysis]
        near = difflib.get_close_matches(str(analysis), list(self._analyses), 1)
        raise KeyError(f"no analysis \"{analysis}\"" + (f"; did you mean \"{near[0]}\"?" if near else "")
                       + f" (there are: {', '.join(self._analyses)})")

    def __getitem__(self, name: str) -> "xarray.Dataset":
        if name not in self._made:
            analysis, _, table = str(name).partition(".")
            status, message, attributes, tables = self._of(analysis)
            if table and table not in tables:
                raise KeyError(f"the analysis \"{analysis}\" has no table \"{table}\" (there are: "
                               f"{', '.join(self.tables(analysis)) or 'none'})")
            known = {"status": status, **({"message": message} if message else {}), **attributes, "study": self._title}
            self._made[name] = dataset_of(tables.get(table), tables.get(""), known)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._analyses)

    def __len__(self) -> int:
        return len(self._analyses)

    def __contains__(self, name: object) -> bool:
        analysis, _, table = str(name).partition(".")
        return analysis in self._analyses and (not table or table in self._analyses[analysis][3])

    def report(self, page: Union[str, os.PathLike] = "report.html") -> None:
        """Writes the report of the command: one HTML page that opens offline. Raises OutputError."""
        self._run.write_report(os.fspath(page), self._command)

    def write(self, folder: Union[str, os.PathLike]) -> None:
        """Writes what the command writes into a folder: ``results.nc``, a CSV file a table, and ``report.html``.

        Tables of a former run that these results do not have move to ``former/``. Raises OutputError, also where
        another run writes there, and StudyError for a folder that cannot be made.
        """
        self._run.write(os.fspath(folder), self._command)

    def plot(self, name: str, **options: Any) -> Any:
        """Draws a table with :func:`rubato.plot.plot`; returns the axes of matplotlib."""
        from . import plot
        if f"{name}.optimum" in self and "optimum" not in options:
            options["optimum"] = self[f"{name}.optimum"]
        return plot.plot(self[name], **options)

    def _rows(self):
        for name, (status, message, _, tables) in self._analyses.items():
            sizes = ", ".join(f"{dimension}: {size}" for dimension, size in self[name].sizes.items())
            yield name, status + (f": {message}" if message else ""), sizes, ", ".join(self.tables(name))

    def __repr__(self) -> str:
        lines = [f"  {name} ({sizes}): {status}" + (f"; also {others}" if others else "")
                 for name, status, sizes, others in self._rows()]
        return "\n".join([f"<rubato.Results of {self._title!r}", *lines]) + ">"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{text}</th>" for text in ("analysis", "status", "sizes", "other tables"))
        rows = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in self._rows())
        return f"<b>{escape(self._title)}</b><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
