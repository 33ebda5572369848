"""Write the type stubs of the methods that add parts to a study: of what the keys of study files say of themselves.

Usage: write_part_stubs.py PACKAGE. Reads the schema from the extension module in the folder PACKAGE, and writes _parts.pyi
beside it. The build calls it.
"""
import json
import pathlib
import sys

sys.path.insert(0, sys.argv[1])
import _rubato

file = pathlib.Path(sys.argv[1]) / "_parts.pyi"
schema = json.loads(_rubato.schema())["properties"]
HEAD = '''# Made by write_part_stubs.py from the keys of study files.
from collections.abc import Mapping, Sequence
from typing import Any, Literal, Optional, Union

Value = Union[float, str]

class Parts:
    def set_parameters(self, given: Optional[Mapping[str, Value]] = ..., /, **values: Value) -> None: ...
'''


def type_of(said):
    if "$ref" in said:
        return {"quantity": "Value", "between": "Sequence[str]"}.get(said["$ref"].removeprefix("#/$defs/"), "Any")
    if "const" in said:
        return f"Literal[{json.dumps(said['const'])}]"
    if "enum" in said and all(isinstance(word, str) for word in said["enum"]):
        return f"Literal[{', '.join(map(json.dumps, said['enum']))}]"
    if "oneOf" in said:
        types = list(dict.fromkeys(type_of(one) for one in said["oneOf"]))
        return "Any" if "Any" in types else types[0] if len(types) == 1 else f"Union[{', '.join(types)}]"
    simple = {"string": "str", "boolean": "bool", "integer": "int", "number": "float", "object": "Mapping[str, Any]"}
    if said.get("type") == "array":
        return f"Sequence[{type_of(said['items'])}]"
    return simple.get(said.get("type"), "Any") if isinstance(said.get("type"), str) else "Any"


def keys_of(items):
    """The keys with their types, and the required ones. A table of several types has the keys of all."""
    if "oneOf" not in items:
        return {key: type_of(said) for key, said in items["properties"].items()}, set(items.get("required", []))
    keys = {}
    for one in items["oneOf"]:
        for key, said in one["properties"].items():
            kind = type_of(said)
            keys[key] = kind if keys.get(key, kind) == kind else "Any"
    words = [one["properties"]["type"]["const"] for one in items["oneOf"]]
    return {**keys, "type": f"Literal[{', '.join(map(json.dumps, words))}]"}, {"name", "type"}


def method(verb, table, items):
    keys, required = keys_of(items)
    lines = [f"    def {verb}_{table}(self, given: Optional[Mapping[str, Any]] = ..., /, *,"]
    lines += [f"        {key}: {kind if key in required else f'Optional[{kind}]'} = ...," for key, kind in keys.items()]
    return "\n".join([*lines, "    ) -> None: ..."]) + "\n"


text = HEAD
for table, said in schema.items():
    choices = [said, *said.get("oneOf", [])]
    items = next((one["items"] for one in choices if one.get("type") == "array"
                  and ("properties" in one["items"] or "oneOf" in one["items"])), None)
    entries = next((one for one in choices if one.get("type") == "object" and "properties" in one), None)
    if items or entries:
        text += method("add" if items else "set", table, items or entries)
file.write_text(text)
