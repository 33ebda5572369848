"""What goes wrong, as exceptions."""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from .results import Results

__all__ = ["AnalysisError", "Error", "Interrupted", "OutputError", "StudyError", "StudyWarning"]


class Error(Exception):
    """Whatever Rubato raises, but Interrupted."""


class StudyError(Error, ValueError):
    """A study, a value or a name that cannot be used. Nothing was computed.

    ``str()`` says where and what, and mostly the remedy.
    """

    def __init__(self, message: str, *, file: Optional[str] = None, line: Optional[int] = None,
                 column: Optional[int] = None, key: Optional[str] = None):
        self.message = message  #: without the place
        self.file = file  #: the study file, or the name that stands for a text; None: not known, or a dictionary
        self.line = line  #: from 1
        self.column = column  #: from 1
        self.key = key  #: of a study given as a dictionary: ``slider[0].stiffness``
        place = key or ":".join(str(part) for part in (file, line, column) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)

    def __reduce__(self):
        return _study_error, (self.message, self.file, self.line, self.column, self.key)


def _study_error(message, file, line, column, key):
    return StudyError(message, file=file, line=line, column=column, key=key)


class OutputError(Error):
    """Results could not be written: a full disk, permissions, another run that writes there."""


class AnalysisError(Error):
    """The mathematics of an analysis failed; the message says when, where and what to try."""

    def __init__(self, message: str, results: Optional["Results"] = None):
        self.results = results  #: everything that was computed
        super().__init__(message)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, or the stop button of a notebook, has ended a run at its next step."""

    def __init__(self, message: str, results: Optional["Results"] = None):
        self.results = results  #: everything that was computed until then; None: nothing
        super().__init__(message)


class StudyWarning(UserWarning):
    """Values that are hardly meant, and what should be known of results that are there."""
