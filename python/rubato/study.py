"""Studies: what is read, checked and run."""
from __future__ import annotations

import numbers
import os
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import Any, Callable, Dict, Iterable, List, Optional, Tuple, Union

from . import _rubato
from ._parts import Parts
from ._progress import Bar
from ._toml import key_at, table_of, toml_of
from .errors import AnalysisError, Interrupted, StudyError, StudyWarning
from .results import Results

__all__ = ["Check", "Study"]

Value = Union[float, str]
_look = 0.05  # [s]: how often a run that goes on lets Python hear of Ctrl-C and shows how far it is


@dataclass(frozen=True)
class Check:
    """What a run would do, as :meth:`Study.check` found it."""

    title: str
    summary: str  #: of the model: ``5 coordinates, 2 sliders``
    parameters: Dict[str, float]  #: with their values
    analyses: Dict[str, str]  #: what each would do: ``transient, generalized_alpha, 12000 steps of 0.005 s``
    facts: List[str] = field(default_factory=list)  #: about a finite element model
    warnings: List[str] = field(default_factory=list)  #: values that are hardly meant, and what a run would warn of

    def __str__(self) -> str:
        lines = [self.title, f"  {self.summary}", *(f"  [model] {fact}" for fact in self.facts)]
        lines += [f"  {name} = {value:g}" for name, value in self.parameters.items()]
        lines += [f"  {name}: {summary}" for name, summary in self.analyses.items()]
        return "\n".join(lines + [f"warning: {text}" for text in self.warnings])

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        printer.text(str(self))


class Study(Parts):
    """A study of a structure or a mechanism.

    Parameters
    ----------
    source
        The path of a study file (TOML), or a dictionary as TOML would give it. Numbers and arrays of numpy serve as
        numbers and lists; a text in a numeric place is a formula of the parameters. SI units. Without it the study is
        empty, to be built part by part: ``study.add_coordinate(name="mass", mass=1.0)``.
    folder
        Where the tables, matrices and meshes lie that a dictionary names; the working folder unless given. A file has its
        own.

    Raises
    ------
    StudyError
        Where it cannot be read or is no study, with the line of the file, or the key of the dictionary.

    The study is read once: later changes of the file, or of the dictionary, change nothing. What is added is read when it is
    first needed.
    """

    def __init__(self, source: Union[str, os.PathLike, Mapping, None] = None, *,
                 folder: Union[str, os.PathLike, None] = None):
        if source is None or isinstance(source, Mapping):
            text, places = toml_of(source or {})
            self._begin(text if source else "", "study", os.fspath(folder or "."), places, 0)
            if source:
                self._ready()
            return
        if folder is not None:
            raise StudyError("a study file has its own folder; `folder` is for dictionaries and texts")
        path = os.fspath(source)
        if isinstance(path, str) and "\n" in path:
            raise StudyError("this is a text, not the path of a study file; call rubato.Study.from_text(text)")
        handle = _rubato.Study.read(path)
        self._begin(handle.text, handle.file, str(handle.folder), [], handle.text.count("\n") + 1)
        self._handle = handle

    @classmethod
    def from_text(cls, text: str, *, name: str = "study.toml", folder: Union[str, os.PathLike] = ".") -> "Study":
        """A study from the text of a study file. `name` stands for the file in messages; `folder` is where the tables,
        matrices and meshes lie that it names."""
        study = cls._from_parts(text, name, os.fspath(folder), [], text.count("\n") + 1)
        study._ready()
        return study

    @classmethod
    def _from_parts(cls, *parts: Any) -> "Study":
        study = cls.__new__(cls)
        study._begin(*parts)
        return study

    def _begin(self, text: str, name: str, folder: str, places: List[Tuple[int, int, str]], own_lines: int) -> None:
        self._text, self._name, self._folder = text, name, folder
        self._places = places  # keys of what did not come as text
        self._own_lines = own_lines  # of the text that somebody wrote; 0: nobody did
        self._handle: Optional[Any] = None
        self._results: Optional[Results] = None

    def __reduce__(self):
        return Study._from_parts, (self._text, self._name, self._folder, self._places, self._own_lines)

    def _ready(self) -> Any:
        """The study as the library has read it."""
        if self._handle is None:
            if not self._text:
                raise StudyError("the study is empty; add parts to it, such as study.add_coordinate(name=\"mass\", mass=1.0)")
            try:
                self._handle = _rubato.Study.from_text(self._text, self._name, self._folder)
            except StudyError as fault:
                raise self._at_key(fault) from None
        return self._handle

    def _append(self, table: str, entries: Mapping, is_list: bool) -> None:
        name = re.escape(table)
        top = re.split(r"^\s*\[", self._text, maxsplit=1, flags=re.MULTILINE)[0]
        head = rf"^\s*\[\[\s*{name}\s*\]\]" if is_list else rf"^\s*\[\s*{name}\s*[\].]"
        count = len(re.findall(head, self._text, re.MULTILINE))
        if re.search(rf"^\s*{name}\s*[=.]", top, re.MULTILINE):
            raise StudyError(f"the study gives \"{table}\" a value in place, to which nothing can be added; write it as "
                             + (f"[[{table}]]" if is_list else f"[{table}]"), key=table)
        if count and not is_list:
            raise StudyError(f"the study has its [{table}] already", key=table)
        text = self._text if not self._text or self._text.endswith("\n") else self._text + "\n"
        added, places = table_of(entries, f"{table}[{count}]" if is_list else table,
                                 f"[[{table}]]" if is_list else f"[{table}]", text.count("\n") + 1)
        self._text, self._handle = text + added, None
        self._places = self._places + places

    def _key(self, line: Optional[int], column: Optional[int]) -> Optional[str]:
        return key_at(self._places, line, column)

    def _at_key(self, fault: StudyError) -> StudyError:
        """With the key instead of a line of a text that nobody wrote."""
        key = fault.key or self._key(fault.line, fault.column)
        return StudyError(fault.message, key=key) if key or not self._own_lines else fault

    def _at_key_in_text(self, message: str) -> str:
        place = re.match(r"(?:.*?):(\d+):(\d+): ", message)
        key = self._key(int(place[1]), int(place[2])) if place else None
        return f"{key}: {message[place.end():]}" if place and key else message

    @property
    def title(self) -> str:
        return self._ready().title

    @property
    def text(self) -> str:
        """The study as TOML, as it is kept with the results; of a dictionary, what it was written as."""
        return self._text

    @property
    def parameters(self) -> Dict[str, float]:
        """The parameters with the values of the study, which :meth:`run` takes as keywords."""
        try:
            return self._ready().parameters()
        except StudyError as fault:
            raise self._at_key(fault) from None

    @property
    def analyses(self) -> List[str]:
        """The names of the analyses."""
        return self._ready().analyses

    @property
    def results(self) -> Optional[Results]:
        """What the last run has computed, also of one that was interrupted or failed; None before the first run."""
        return self._results

    def check(self, *, only: Union[str, Iterable[str], None] = None, parameters: Optional[Mapping[str, Value]] = None,
              **values: Value) -> Check:
        """Evaluates and assembles the study, and plans its analyses, without running them.

        Takes parameters as :meth:`run` does. Raises StudyError where a run would.
        """
        run, interrupt = self._go(only, parameters, values, 0, True, None)
        if interrupt:
            raise interrupt
        outline = run.outline()
        doubts = [self._at_key_in_text(text) for text in outline["doubts"]]
        planned = [f'analysis "{name}": {text}' for name, _, texts in outline["analyses"] for text in texts]
        return Check(outline["title"], outline["summary"], outline["parameters"],
                     {name: summary for name, summary, _ in outline["analyses"]}, outline["facts"], doubts + planned)

    def run(self, *, only: Union[str, Iterable[str], None] = None, jobs: int = 0,
            progress: Union[bool, Callable[[str, float, float, str], None]] = False, strict: bool = True,
            parameters: Optional[Mapping[str, Value]] = None, **values: Value) -> Results:
        """Runs the analyses of the study: ``study.run(N0=35, jobs=2, progress=True)``.

        Parameters
        ----------
        only
            Names of the analyses to run, or one; all unless given.
        jobs
            So many analyses at a time, and sweeps on so many threads; 0: one analysis, on all cores. Results do not
            depend on it.
        progress
            True shows a line with the time left; a function is called with the analysis, what is done, what there is
            in all and the unit of both (``steps``, ``points``), some times a second.
        strict
            Whether an analysis that failed raises AnalysisError, once all have run. Else its ``status`` says so.
        parameters
            Values of parameters by name, for names that are also arguments of this method.
        **values
            Values of parameters, which replace those of the study: numbers, or formulas of numbers (``"2*pi"``).

        Raises
        ------
        StudyError
            For a name that is no parameter, with the nearest that is, for values that are no finite numbers, and for a
            study that cannot run. Nothing was computed then.
        AnalysisError
            Where the mathematics failed; its ``results`` have what was computed.
        Interrupted
            After Ctrl-C, a KeyboardInterrupt whose ``results`` have what was computed.

        What should be known of the results is told by StudyWarning, and is among their attributes.
        """
        show = Bar() if progress is True else progress if callable(progress) else None
        self._results = None
        run, interrupt = self._go(only, parameters, values, jobs, False, show)
        if isinstance(show, Bar):
            show.end()
        self._results = results = Results(run, self.title, self._called(only, parameters, values, jobs))
        if interrupt:
            raise Interrupted("stopped; `results` of this exception, and of the study, have what was computed",
                              results) from None
        for text in run.outline()["doubts"]:
            warnings.warn(self._at_key_in_text(text), StudyWarning, stacklevel=2)
        for name, text in run.warnings():
            warnings.warn(f'analysis "{name}": {text.replace("--set ", "")}', StudyWarning, stacklevel=2)
        failed = [f'analysis "{name}" failed: {results.message(name)}' for name in results
                  if results.status(name) != "done"]
        if failed and strict:
            raise AnalysisError("\n".join(failed), results)
        for text in failed:
            warnings.warn(text, StudyWarning, stacklevel=2)
        return results

    def _go(self, only, parameters, values, jobs, checks_only, show) -> Tuple[Any, Optional[KeyboardInterrupt]]:
        """Runs in a thread of the library, while this one hears of Ctrl-C."""
        if isinstance(jobs, bool) or not isinstance(jobs, numbers.Integral) or not 0 <= jobs <= 1024:
            raise StudyError(f"jobs is a whole number from 0 to 1024, not {jobs!r}")
        names = [] if only is None else [only] if isinstance(only, str) else list(only)
        run = _rubato.Run(self._ready(), _settings(parameters, values), names, int(jobs), checks_only)
        interrupt: Optional[KeyboardInterrupt] = None
        try:
            while not run.wait(_look):
                if show:
                    for stage in run.progress()[-1:]:
                        show(*stage)
        except BaseException as fault:  # a signal's handler may raise anything
            run.stop()
            _wait_out(run)
            if not isinstance(fault, KeyboardInterrupt):
                raise
            interrupt = fault
        if not interrupt:
            try:
                run.require_success()
            except StudyError as fault:
                raise self._at_key(fault) from None
        return run, interrupt

    def _called(self, only, parameters, values, jobs) -> str:
        """How the run was called, for the provenance of results."""
        words = [f"{name}={value!r}" for name, value in {**(parameters or {}), **values}.items()]
        words += [f"only={only!r}"] if only is not None else []
        return f"rubato.Study({self._name!r}).run({', '.join(words + ([f'jobs={jobs}'] if jobs else []))})"

    def __repr__(self) -> str:
        try:
            return f"<rubato.Study {self.title!r}: {', '.join(self.analyses) or 'no analyses'}>"
        except (StudyError, AttributeError):
            return "<rubato.Study, which cannot run yet>"

    def _repr_html_(self) -> str:
        try:
            values = ", ".join(f"{escape(name)} = {value:g}" for name, value in self.parameters.items())
        except StudyError as fault:
            return f"a study, which cannot run yet: {escape(str(fault))}"
        return (f"<b>{escape(self.title)}</b><br>analyses: {escape(', '.join(self.analyses)) or 'none'}"
                + (f"<br>parameters: {values}" if values else ""))


def _wait_out(run: Any) -> None:
    while True:
        try:
            if run.wait(1.0):
                return
        except KeyboardInterrupt:  # it stops already
            continue


def _settings(parameters: Optional[Mapping[str, Value]], values: Mapping[str, Value]) -> List[Tuple[str, Value]]:
    settings: List[Tuple[str, Value]] = []
    for name, value in {**(parameters or {}), **values}.items():
        if not isinstance(name, str):
            raise StudyError(f"the name of a parameter is a text, not {name!r}")
        if isinstance(value, str):
            settings.append((name, value))
            continue
        try:
            if isinstance(value, (bool, complex)) or getattr(value, "shape", ()) != ():
                raise TypeError
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            hint = "; `sweep` of an analysis takes several values" if hasattr(value, "__len__") else ""
            raise StudyError(f"parameter \"{name}\" is one number or a formula, not {value!r}{hint}") from None
        if number != number or number in (float("inf"), float("-inf")):
            raise StudyError(f"parameter \"{name}\" is {number}; give a finite number")
        settings.append((name, number))
    return settings
