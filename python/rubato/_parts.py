"""Methods that add the tables of a study one by one, made of what the keys of study files say of themselves."""
from __future__ import annotations

import inspect
import json
from collections.abc import Mapping
from typing import Any, Dict, List, Optional, Tuple

from . import _rubato
from .errors import StudyError

__all__ = ["Parts"]

_schema = json.loads(_rubato.schema())["properties"]


def _keys_of(items: Mapping, keys: Optional[Mapping] = None) -> Tuple[Dict[str, Mapping], List[str]]:
    """The keys of a table with what they say, and which of them are required. Of a table of several types those of the type
    that `keys` have; all where they have none."""
    if "oneOf" not in items:
        return items["properties"], items.get("required", [])
    types = {one["properties"]["type"]["const"]: one for one in items["oneOf"]}
    if keys is not None and keys.get("type") in types:
        chosen = types[keys["type"]]
        return chosen["properties"], chosen["required"]
    every: Dict[str, Mapping] = {}
    for one in items["oneOf"]:
        every.update(one["properties"])
    return {**every, "type": {"description": ", ".join(types)}}, ["name", "type"]


def _checked(table: str, items: Mapping, given: Optional[Mapping], keys: Dict[str, Any]) -> Dict[str, Any]:
    """The keys that were given, without those that are None."""
    entries = {key: value for key, value in {**(given or {}), **keys}.items() if value is not None}
    known = list(_keys_of(items, entries)[0])
    for key in entries:
        if key not in known:
            raise StudyError(f"a {table} has no key \"{key}\"{_rubato.suggestion(str(key), known)}", key=f"{table}.{key}")
    return entries


def _signature(items: Mapping) -> inspect.Signature:
    keys, required = _keys_of(items)
    kind = inspect.Parameter
    given = [kind("self", kind.POSITIONAL_OR_KEYWORD), kind("given", kind.POSITIONAL_ONLY, default=None)]
    names = [kind(key, kind.KEYWORD_ONLY, default=None) for key in sorted(keys, key=lambda key: key not in required)]
    return inspect.Signature([given[0].replace(kind=kind.POSITIONAL_ONLY), given[1], *names])


def _documentation(does: str, table: str, items: Mapping, description: str) -> str:
    keys, required = _keys_of(items)
    lines = [f"{does}: {description}." if description else f"{does}.", "", "Keys, also as a dictionary:", ""]
    lines += [f"{key}{' (required)' if key in required else ''}\n    {said.get('description', '')}"
              for key, said in keys.items()]
    return "\n".join(lines + ["", f"Raises StudyError for a key that a {table} does not have, with the nearest that it has."])


class Parts:
    """``add_slider(...)`` adds a ``[[slider]]``, ``set_damping(...)`` gives the study its ``[damping]``."""

    def _append(self, table: str, entries: Mapping, is_list: bool) -> None:
        raise NotImplementedError

    def set_parameters(self, given: Optional[Mapping] = None, /, **values: Any) -> None:
        """Gives the study its parameters: numbers, or formulas of those before them."""
        self._append("parameters", {**(given or {}), **values}, False)


def _adding(table: str, items: Mapping, description: str) -> Any:
    def add(self, given: Optional[Mapping] = None, /, **keys: Any) -> None:
        self._append(table, _checked(table, items, given, keys), True)
    add.__name__, add.__signature__ = f"add_{table}", _signature(items)  # type: ignore[attr-defined]
    add.__doc__ = _documentation(f"Adds a [[{table}]]", table, items, description)
    return add


def _setting(table: str, items: Mapping, description: str) -> Any:
    def give(self, given: Optional[Mapping] = None, /, **keys: Any) -> None:
        self._append(table, _checked(table, items, given, keys), False)
    give.__name__, give.__signature__ = f"set_{table}", _signature(items)  # type: ignore[attr-defined]
    give.__doc__ = _documentation(f"Gives the study its [{table}]", table, items, description)
    return give


def _make() -> None:
    for table, schema in _schema.items():
        said = schema.get("description", "")
        choices = [schema, *schema.get("oneOf", [])]
        items = next((one["items"] for one in choices if one.get("type") == "array" and (
            "properties" in one["items"] or "oneOf" in one["items"])), None)
        entries = next((one for one in choices if one.get("type") == "object" and "properties" in one), None)
        if items is not None:
            setattr(Parts, f"add_{table}", _adding(table, items, said))
        elif entries is not None:
            setattr(Parts, f"set_{table}", _setting(table, entries, said))


_make()
