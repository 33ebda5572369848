"""Tables of results as datasets: which columns are axes, and what lies on their grid."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

# What may head the rows of a table, besides parameters; the last varies fastest.
_axes = ("direction", "angular_frequency", "time")


def _first_values(values: np.ndarray) -> np.ndarray:
    """Each value once, in the order of their coming."""
    return values[np.sort(np.unique(values, return_index=True)[1])]


def _laid(keys: Sequence[np.ndarray], rows: int) -> Optional[Tuple[List[np.ndarray], int]]:
    """The values of each axis and how many rows each of their combinations has, where rows count all combinations in
    order, the last axis varying fastest; else None."""
    axes = [_first_values(key) for key in keys]
    shape = [len(axis) for axis in axes]
    combinations = math.prod(shape)
    if combinations == 0 or rows % combinations:
        return None
    repeats = rows // combinations
    for place, (key, axis) in enumerate(zip(keys, axes)):
        along = axis.reshape([-1 if i == place else 1 for i in range(len(axes))] + [1])
        if not np.array_equal(key.reshape(shape + [repeats]), np.broadcast_to(along, shape + [repeats])):
            return None
    return axes, repeats


def _words(values: np.ndarray, categories: Sequence[str]) -> np.ndarray:
    known = np.array([*categories, ""])
    return known[np.where(np.isnan(values), len(categories), values).astype(int)]


def _key_names(table: str, attributes: Mapping[str, str], has_modes: bool) -> List[str]:
    """The names that head the rows of a table of an analysis, whose main table has these attributes."""
    swept = [name for name in attributes.get("swept_parameters", "").split(", ") if name]
    if has_modes:
        return [*swept, "limit", "mode"]
    if attributes.get("type") != "damper_curve":
        return [*swept, *_axes]
    return swept if table == "optimum" else [*swept, attributes.get("parameter", ""), "peak"]


class _Rows:
    """How the rows of a table lie: their dimensions with sizes, and the coordinates along them."""

    def __init__(self, dimension: str, count: int):
        self.dimensions, self.shape = (dimension,), (count,)
        self.index: Dict[str, np.ndarray] = {}  # values of dimensions

    def lay(self, keys: Mapping[str, np.ndarray], has_samples: bool, is_listed: bool) -> None:
        """On the grid of the keys; else in lines over the last key, or in pieces of equal lengths. Swept parameters that
        were listed (cases, samples) make no grid, even where one would fit."""
        (row,), (count,) = self.dimensions, self.shape
        names = list(keys)
        if not names or count == 0:
            return
        found = None if is_listed else _laid([keys[name] for name in names], count)
        if found and found[1] == 1:
            self._take(names, found[0])
            return
        if len(names) == 1:
            return
        fast = _first_values(keys[names[-1]])
        if count % len(fast) == 0 and len(fast) > 1:
            lines = {name: keys[name].reshape(-1, len(fast)) for name in names}
            if (lines[names[-1]] == fast).all() and all((lines[n] == lines[n][:, :1]).all() for n in names[:-1]):
                self.dimensions = ("sample" if has_samples else "line", names[-1])
                self.shape = (count // len(fast), len(fast))
                self.index = {names[-1]: fast}
                return
        found = None if is_listed else _laid([keys[name] for name in names[:-1]], count)
        if found and found[1] > 1:
            self._take(names[:-1], found[0])
            self.dimensions += (row if row not in keys else "row",)
            self.shape += (found[1],)

    def _take(self, names: List[str], axes: List[np.ndarray]) -> None:
        self.dimensions, self.shape = tuple(names), tuple(len(axis) for axis in axes)
        self.index = dict(zip(names, axes))

    def along(self, values: np.ndarray) -> Tuple[Tuple[str, ...], np.ndarray]:
        """The dimensions and values of a coordinate: without those along which it does not change."""
        laid = values.reshape(self.shape)
        if len(self.shape) == 2 and self.dimensions[0] in ("sample", "line") and (laid == laid[:, :1]).all():
            return self.dimensions[:1], laid[:, 0]
        return self.dimensions, laid


def dataset_of(table: Optional[Sequence[Any]], main: Optional[Sequence[Any]], known: Dict[str, str]) -> Any:
    """A table of results as a dataset; an empty one where an analysis has none.

    `main` is the main table of its analysis, `known` what is known of that.
    """
    import xarray

    if table is None:
        return xarray.Dataset(attrs=known)
    name, row_dimension, attributes, blocks = table
    rows = _Rows(row_dimension, len(blocks[0][6]) if blocks else 0)
    labelled = {dimension for _, _, _, dimension, *_ in blocks if dimension}
    heads = {variable: values for variable, _, _, dimension, _, _, values in blocks
             if not dimension and variable not in labelled}
    settings = main[2] if main else attributes
    wanted = _key_names(name, settings, "mode" in heads)
    keys = {head: heads[head] for head in heads if head in wanted}
    is_listed = settings.get("sweep") in ("cases", "random") and any(
        swept in keys for swept in settings["swept_parameters"].split(", "))
    rows.lay(keys, "sample" in heads, is_listed)

    coordinates: Dict[str, Any] = {}
    variables: Dict[str, Any] = {}
    for variable, unit, description, dimension, labels, categories, values in blocks:
        notes = {"units": unit or "1", "long_name": description}
        if dimension:
            if dimension in coordinates and list(coordinates[dimension][1]) != labels:
                dimension = f"{variable}_{dimension}"  # other labels under the same name
            coordinates[dimension] = (dimension, np.array(labels))
            variables[variable] = (rows.dimensions + (dimension,), values.reshape(rows.shape + (len(labels),)), notes)
            continue
        if variable in rows.index:
            axis = rows.index[variable]
            coordinates[variable] = (variable, _words(axis, categories) if categories else axis, notes)
            continue
        shown = _words(values, categories) if categories else values
        if variable in wanted or variable in ("sample", row_dimension):
            dimensions, laid = rows.along(shown)
            coordinates[variable] = (dimensions, laid, notes)
        else:
            variables[variable] = (rows.dimensions, shown.reshape(rows.shape), notes)
    return xarray.Dataset(variables, coordinates, {**attributes, **known})
