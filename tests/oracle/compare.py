"""Runs the command on a study, reads its tables, and holds them against the oracle."""

import pathlib
import re
import resource
import signal
import subprocess
import tempfile

import numpy

import judge_curve
import judge_methods
import judge_response
import judge_rest
import judge_transient
import statics
from structure.model import read_model
from study import Study, Unreadable
from verdicts import Table, Verdict

ORACLE_SECONDS = 20
COMMAND_SECONDS = 20
COMMAND_BYTES = 300_000_000  # of a file of results
TOO_SLOW, TOO_LARGE = "the command takes too long", "the command writes too much"


class _OutOfTime(Exception):
    pass


def _alarm(*_):
    raise _OutOfTime


def run_command(command, path, folder):
    """With limits on its processor time and on what it writes; ended by a signal beyond."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (COMMAND_BYTES, COMMAND_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (COMMAND_SECONDS, COMMAND_SECONDS + 1))
    return subprocess.run([str(command), "run", str(path), "-o", str(folder), "--jobs", "1"], capture_output=True,
                          text=True, preexec_fn=limit)


def judge(path, command, folder=None):
    """Verdicts of all analyses of a study. Those that the command refuses, or which take it too long, are taken out, and the
    others judged."""
    apart = []
    while True:
        verdicts = _judge(path, command, folder)
        named = [v for v in verdicts if v.outcome == "refused"]
        line = re.search(r"toml:(\d+):", named[0].what) if named else None
        if line and _without(path, int(line.group(1))):
            apart.append(Verdict("?", "refused", "refused", named[0].what))
        elif verdicts[0].what in (TOO_SLOW, TOO_LARGE) and _without(path, _line_of(path, verdicts[0].analysis)):
            apart.append(verdicts[0])
        else:
            return apart + verdicts


def _line_of(path, analysis):
    lines = pathlib.Path(path).read_text().splitlines()
    return next((i + 1 for i, text in enumerate(lines) if text == f'name = "{analysis}"'), 0)


def _without(path, line):
    """Takes the analysis at a line out of the study; whether any is left."""
    lines = pathlib.Path(path).read_text().splitlines(keepends=True)
    begins = [i for i, text in enumerate(lines) if text.startswith("[[analysis]]")]
    at = [i for i in begins if i < line]
    if not at or len(begins) < 2:
        return False
    end = next((i for i in begins if i > at[-1]), len(lines))
    pathlib.Path(path).write_text("".join(lines[:at[-1]] + lines[end:]))
    return True


def _judge(path, command, folder):
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(folder or scratch)
        done = run_command(command, path, folder)
        at_last = (re.findall(r"^(\S+): .* of .*", done.stderr, re.MULTILINE) or ["all"])[-1]
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return [Verdict(at_last, "too long", "skipped", TOO_SLOW)]
        if "File too large" in done.stderr:
            failed = re.search(r'analysis "([^"]*)" failed: .*File too large', done.stderr)
            return [Verdict(failed.group(1) if failed else at_last, "too long", "skipped", TOO_LARGE)]
        message = " ".join(line for line in done.stderr.splitlines() if "error" in line or done.returncode == 2)[-600:]
        study = Study(path)
        study.told = done.stderr
        if done.returncode == 2:
            return [Verdict("all", "all", "refused", message)]
        if done.returncode < 0:
            return [Verdict("all", "all", "differs", f"the command died of signal {-done.returncode}")]
        try:
            model = read_model(study)
        except (Unreadable, numpy.linalg.LinAlgError) as why:
            return [Verdict("all", "all", "skipped", str(why))]
        verdicts = []
        pairs = {}
        for analysis in study.raw["analysis"]:
            name, kind = analysis["name"], analysis["type"]
            table = folder / f"{name}.csv"
            signal.signal(signal.SIGPROF, _alarm)
            signal.setitimer(signal.ITIMER_PROF, ORACLE_SECONDS)
            try:
                told = re.search(rf'analysis "{re.escape(name)}" failed: (.*)', done.stderr)
                if told and kind != "static":
                    verdicts.append(Verdict(name, kind, "failed", told.group(1)[:200]))
                    continue
                if not table.exists() or len(table.read_text().splitlines()) < 2:
                    verdicts.append(_without_rows(model, analysis, message))
                    continue
                verdicts.append(_JUDGES[kind](study, model, analysis, Table(table), pairs))
            except Unreadable as why:
                verdicts.append(Verdict(name, kind, "skipped", str(why)))
            except (numpy.linalg.LinAlgError, ArithmeticError, ValueError, RecursionError) as why:
                verdicts.append(Verdict(name, kind, "skipped", f"the oracle fails: {type(why).__name__} {why}"))
            except _OutOfTime:
                verdicts.append(Verdict(name, kind, "skipped", "out of time"))
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0)
        return [v for v in verdicts if v]


def _without_rows(model, analysis, message):
    """The command gave no answer; is there one?"""
    name, kind = analysis["name"], analysis["type"]
    if kind == "static":
        try:
            statics.equilibrium(model)
        except Unreadable:
            return Verdict(name, kind, "agrees", "neither finds an equilibrium")
        return Verdict(name, kind, "failed", "an equilibrium exists: " + message)
    return Verdict(name, kind, "failed", message)


_JUDGES = {"static": judge_rest.static, "modes": judge_rest.natural_modes, "transient": judge_transient.transient,
           "frequency_response": judge_response.frequency_response, "damper_curve": judge_curve.damper_curve,
           "method_study": judge_methods.method_study}
