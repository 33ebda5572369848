"""Sliders whose normal load is written as one that changes, and stays the same: `by_time` and `by_law` rewrite a study.

Each is a law of the general route then, and answers as the slider of the closed one does in what takes both.
"""

import copy


def by_time(tables, _parts):
    """`normal_load` as a formula of t; steady responses refuse t."""
    tables = _changed(tables, lambda part: part["type"] in ("static", "modes", "transient"))
    for slider in tables["slider"] if tables else []:
        slider["normal_load"] = f"({slider['normal_load']}) + 0*t"
    return tables


def by_law(tables, _parts):
    """The force of a law that pushes as another one pulls: what presses is a force of the step."""
    tables = _changed(tables, lambda part: part["type"] in ("static", "modes", "transient") or (
        part.get("solver") == "time_marching" and "sweep" not in part))  # parameters of linear limits are others
    laws = []
    for i, slider in enumerate(tables["slider"] if tables else []):
        load = slider["normal_load"]
        slider["normal_load"] = {"law": f"push{i}"}
        laws += [{"name": f"push{i}", "between": slider["between"], "force": f"({load}) + 0*u"},
                 {"name": f"pull{i}", "between": slider["between"], "force": f"-({load}) + 0*u"}]
    return tables and {**{k: v for k, v in tables.items() if k != "analysis"}, "nonlinear_spring": laws, "analysis": tables["analysis"]}


def _changed(tables, takes):
    """None where there is nothing to rewrite."""
    if "slider" not in tables or "body" in tables:
        return None
    tables = copy.deepcopy(tables)
    tables["analysis"] = [part for part in tables["analysis"] if takes(part)]
    return tables if tables["analysis"] else None
