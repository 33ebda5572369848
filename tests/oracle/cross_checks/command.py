"""Runs of the command, and their tables."""

import resource
import signal
import subprocess

import numpy

from compare import Table

SECONDS = 10  # of processor time


class NoAnswer(Exception):
    """The command refuses the study, says that it failed, or takes too long: `outcome` is `refused`, `failed` or `skipped`."""

    def __init__(self, outcome, why):
        super().__init__(why)
        self.outcome = outcome


class Wrong(Exception):
    """The command dies, or says nothing of an answer that is missing."""


def run(command, study, results, *words, jobs=1):
    """Runs it; NoAnswer where it ends otherwise than with 0."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    done = subprocess.run([str(command), "run", str(study), "-o", str(results), "--jobs", str(jobs), "--yes", "--quiet",
                           *map(str, words)], capture_output=True, text=True, preexec_fn=limit)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise NoAnswer("skipped", f"the command takes more than {SECONDS} s")
    if done.returncode < 0 or done.returncode not in (0, 2, 3):
        raise Wrong(f"the command ended with {done.returncode}: {done.stderr[-300:]}")
    if done.returncode:
        raise NoAnswer("refused" if done.returncode == 2 else "failed", done.stderr.strip()[-400:])
    return results


def table(results, name):
    path = results / f"{name}.csv"
    if not path.exists():
        raise Wrong(f"no table {name}.csv, and exit status 0")
    return Table(path)


POSITIONS = (".position [m]", ".angle [rad]")


def coordinates(table):
    """(name, is_rotation) of those that a transient or a static state has columns of."""
    return [(head[: -len(word)], word == POSITIONS[1]) for head in table.head for word in POSITIONS if head.endswith(word)]


def motions(table, names, order=0):
    """Positions [rows x names], or with order 1 and 2 their rates."""
    words = [(".position [m]", ".angle [rad]"), (".velocity [m/s]", ".angular_velocity [rad/s]"),
             (".acceleration [m/s2]", ".angular_acceleration [rad/s2]")][order]
    return numpy.array([table.column(name + words[turns]) for name, turns in names]).T
