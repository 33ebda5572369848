"""Rubato: time integration and steady responses of structures and mechanisms.

>>> import rubato
>>> study = rubato.Study("study.toml")
>>> results = study.run(N0=35)
>>> results["frf"].amplitude.sel(coordinate="blade2").plot()
>>> results.report("report.html")
"""
from . import _rubato, plot
from .errors import AnalysisError, Error, Interrupted, OutputError, StudyError, StudyWarning
from .results import Results
from .study import Check, Study

__version__: str = _rubato.version
__all__ = ["AnalysisError", "Check", "Error", "Interrupted", "OutputError", "Results", "Study", "StudyError",
           "StudyWarning", "plot"]
