"""Hold the tables of keys in docs/reference/study-file.md equal to what the study file's keys declare of themselves.

Usage: write_key_tables.py RUBATO ROOT [--fix]. Between a line `<!-- keys: slider -->` and the next `<!-- -->` stands the
table of the keys of [[slider]], made of what `rubato schema` prints; `analysis transient step` is the table within a
key of an analysis of that type, `$sweep` a definition, `base_motion but force` leaves out what is as in [[force]]. Fails where a table is out of date, or where a table of the study
file has no such block; with --fix, writes them.
"""
import json
import pathlib
import re
import subprocess
import sys

rubato, root = sys.argv[1], pathlib.Path(sys.argv[2])
page = root / "docs" / "reference" / "study-file.md"
schema_of_study = json.loads(subprocess.run([rubato, "schema"], check=True, capture_output=True, text=True).stdout)

REFERENCES = {"quantity": "number", "between": "two names", "method": "method", "method_name": "name",
              "values": "list or range", "frequency_range": "range", "sweep": "table"}


def entries(schema, one):
    """How many of what a list has: "2 to 3 numbers"."""
    least, most = schema.get("minItems", 0), schema.get("maxItems")
    if most is None:
        return f"list of {one}s"
    if least == most:
        return f"{least} {one}s"
    return f"list of up to {most} {one}s" if least < 2 else f"{least} {'or' if most == least + 1 else 'to'} {most} {one}s"


def value(schema):
    """What a key takes, in a word or two."""
    if "$ref" in schema:
        return REFERENCES[schema["$ref"].removeprefix("#/$defs/")]
    if "enum" in schema:
        return ", ".join(f"`\"{word}\"`" for word in schema["enum"])
    if "const" in schema:
        return f"`\"{schema['const']}\"`"
    if "oneOf" in schema:
        return " or ".join(map(value, schema["oneOf"]))
    if schema["type"] == "array":
        items = schema["items"]
        if any("enum" in one for one in items.get("oneOf", [])):
            return "list of words or tables"
        one = value(items)
        return "list of " + one if "enum" in items else entries(schema, "table" if "table" in one else one.split()[-1])
    if schema["type"] == "object":
        inner = schema.get("additionalProperties")
        return "table by name" if isinstance(inner, dict) else "table"
    words = {"string": "text", "boolean": "true or false", "integer": "whole number"}
    if isinstance(schema["type"], list):
        return "name" if "integer" in schema["type"] else "formula of t"
    return words[schema["type"]]


def rows(schema, known, prefix=""):
    for key, inner in schema["properties"].items():
        if known.get(key) == inner or (prefix == "" and inner.get("const")):  # the type of an analysis
            continue
        definition = schema_of_study["$defs"].get(inner.get("$ref", "").removeprefix("#/$defs/"), {})
        told = {} if definition is schema_of_study["$defs"]["quantity"] else definition
        meaning, default = inner.get("description", told.get("description", "")), ""
        found = re.search(r" ?\(default: (.*)\)$", meaning)
        if found:
            meaning, default = meaning[: found.start()], found[1]
        meaning = re.sub(r"\[?\[\[?\w+\]\]|\[matrices\]", r"`\g<0>`", meaning)
        if key in schema.get("required", []):
            default = "needed"
        yield f"| `{prefix}{key}` | {value(inner)} | {default} | {meaning.replace('|', chr(92) + '|')} |".replace("|  |", "| |")
        one, *others = inner.get("oneOf", [inner])
        is_one_or_a_list = len(others) == 1 and others[0].get("items") == one
        if one.get("type") == "object" and "properties" in one and (inner is one or is_one_or_a_list):
            yield from rows(one, {}, f"{prefix}{key}.")


def as_table(schema):
    """The object that a schema allows, perhaps beside something else, or in a list."""
    if schema.get("type") == "array":
        return as_table(schema["items"])
    if "properties" in schema:
        return schema
    return next(one for one in schema["oneOf"] if "properties" in one)


def find(path):
    if path[0].startswith("$"):
        found = schema_of_study["$defs"][path[0][1:]]
        if len(path) > 1:
            found = next(one for one in found["oneOf"] if "properties" in one)
        return as_table(found)
    if path[0] != "analysis":
        found = as_table(schema_of_study["properties"][path[0]])
    else:
        types = schema_of_study["properties"]["analysis"]["items"]["oneOf"]
        found = next(one for one in types if one["properties"]["type"]["const"] == path[1])
        found = {"properties": {key: one for key, one in found["properties"].items() if key != "name"},
                 "required": found.get("required", [])}
        path = path[1:]
    for key in path[1:]:
        found = as_table(found["properties"][key])
    return found


def written(match):
    path, _, known = match[1].partition(" but ")
    seen.add(tuple(path.split()))
    known = find(known.split())["properties"] if known else {}
    lines = ["| key | value | default | meaning |", "|---|---|---|---|", *rows(find(path.split()), known)]
    return f"<!-- keys: {match[1]} -->\n\n" + "\n".join(lines) + "\n\n<!-- -->\n"


seen = set()
before = page.read_text()
after = re.sub(r"<!-- keys: ([^>]*?) -->\n.*?<!-- -->\n", written, before, flags=re.DOTALL)
tables = {(key,) for key, one in schema_of_study["properties"].items() if key not in ("title", "parameters", "analysis")}
tables |= {("analysis", one["properties"]["type"]["const"]) for one in schema_of_study["properties"]["analysis"]["items"]["oneOf"]}
missing = sorted(" ".join(path) for path in tables - seen)
if missing:
    sys.exit(f"{page} has no table of the keys of {', '.join(missing)}")
if after != before and "--fix" in sys.argv[3:]:
    page.write_text(after)
elif after != before:
    sys.exit(f"{page} is not what the keys say; run tools/write_key_tables.py RUBATO ROOT --fix")
print(f"{len(seen)} tables of keys")
