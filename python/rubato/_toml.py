"""A dictionary as the TOML text of a study, with the key of each place in it."""
from __future__ import annotations

import datetime
import json
import math
import numbers
import os
import re
from collections.abc import Mapping
from typing import Any, List, Optional, Tuple

from .errors import StudyError

_bare = re.compile(r"[A-Za-z0-9_-]+\Z")


def _text(value: str) -> str:
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        raise ValueError("a text that is no Unicode") from None
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _number(value: float) -> str:
    if math.isnan(value):
        return "nan"
    return repr(value) if math.isfinite(value) else "inf" if value > 0 else "-inf"


class _Writer:
    """Lines of TOML. `places` are the lines, columns and keys of what was written, in rising order."""

    def __init__(self) -> None:
        self.lines: List[str] = []
        self.line = ""
        self.places: List[Tuple[int, int, str]] = []

    def add(self, text: str) -> None:
        self.line += text

    def end(self) -> None:
        self.lines.append(self.line)
        self.line = ""

    def note(self, path: str) -> None:
        self.places.append((len(self.lines) + 1, len(self.line) + 1, path))

    def key(self, key: Any, path: str) -> str:
        if not isinstance(key, str):
            raise StudyError(f"a key is a text, not {key!r}", key=path or None)
        path = f"{path}.{key}" if path else key
        self.note(path)
        self.add(key if _bare.match(key) else _text(key))
        return path

    def value(self, value: Any, path: str) -> None:
        self.note(path)
        if hasattr(value, "tolist"):  # numbers and arrays of numpy, and what wraps them
            value = value.tolist()
        if isinstance(value, str):
            try:
                self.add(_text(value))
            except ValueError as fault:
                raise StudyError(str(fault), key=path) from None
        elif isinstance(value, bool):
            self.add("true" if value else "false")
        elif isinstance(value, numbers.Integral):
            if not -2**63 <= int(value) < 2**63:
                raise StudyError(f"{value} is too large for a whole number; write it with a point", key=path)
            self.add(str(int(value)))
        elif isinstance(value, numbers.Real):
            self.add(_number(float(value)))
        elif isinstance(value, os.PathLike):
            self.value(os.fspath(value), path)
        elif isinstance(value, Mapping):
            self.add("{ ")
            for number, (key, item) in enumerate(value.items()):
                self.add(", " if number else "")
                inner = self.key(key, path)
                self.add(" = ")
                self.value(item, inner)
            self.add(" }")
        elif isinstance(value, (list, tuple, range)):
            self.add("[")
            for number, item in enumerate(value):
                self.add(", " if number else "")
                self.value(item, f"{path}[{number}]")
            self.add("]")
        else:
            what = "a date" if isinstance(value, (datetime.date, datetime.time)) else f"a {type(value).__name__}"
            raise StudyError(f"{what} has no place in a study; give numbers, texts, truth values, lists and "
                             "dictionaries", key=path)

    def entry(self, key: Any, value: Any, path: str) -> None:
        inner = self.key(key, path)
        self.add(" = ")
        self.value(value, inner)
        self.end()

    def table(self, head: str, entries: Mapping, path: str) -> None:
        self.note(path)
        self.add(head)
        self.end()
        for key, value in entries.items():
            self.entry(key, value, path)
        self.end()


def _is_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(isinstance(item, Mapping) for item in value)


def toml_of(study: Mapping) -> Tuple[str, List[Tuple[int, int, str]]]:
    """The text, and the lines, columns (from 1) and keys of all that stands in it, in rising order."""
    writer = _Writer()
    tables = []
    for key, value in study.items():
        if isinstance(key, str) and (isinstance(value, Mapping) or _is_tables(value)):
            tables.append((key, value))
        else:
            writer.entry(key, value, "")
    for key, value in tables:
        name = key if _bare.match(key) else _text(key)
        if isinstance(value, Mapping):
            writer.table(f"[{name}]", value, key)
        else:
            for number, entries in enumerate(value):
                writer.table(f"[[{name}]]", entries, f"{key}[{number}]")
    return "\n".join(writer.lines) + "\n", writer.places


def table_of(entries: Mapping, path: str, head: str, line: int) -> Tuple[str, List[Tuple[int, int, str]]]:
    """The same of one more table, whose head (`[[slider]]`) stands on a line."""
    writer = _Writer()
    writer.table(head, entries, path)
    return "\n".join(writer.lines) + "\n", [(at + line - 1, column, key) for at, column, key in writer.places]


def key_at(places: List[Tuple[int, int, str]], line: Optional[int], column: Optional[int]) -> Optional[str]:
    """The key of a place in the text; None where there is no place."""
    if line is None:
        return None
    before = [key for at, begin, key in places if at == line and begin <= (column or 1)]
    return before[-1] if before else next((key for at, _, key in places if at == line), None)
