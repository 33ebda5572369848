"""Dry friction and locks of a march."""

import math

import numpy as np

from study import Unreadable as Refused

class Dry:
    """One friction: its joint, the maps of its slip (one or two linear forms of scalars), and how it goes."""

    def __init__(self, joint, maps, names, mu, preload, rows, scale):
        self.joint, self.maps, self.names, self.mu, self.preload, self.rows = joint, np.array(maps), names, mu, preload, rows
        self.scale = scale            # of the reported force, for a unit of mu N
        self.going = None             # None: sticks; else the direction in which it slides
        self.resting = False          # a rigid lock holds its joint

    def limit(self, mu):
        """mu (preload + N) with the multipliers of this instant."""
        return self.mu * (self.preload + (np.linalg.norm(mu[self.rows]) if self.rows else 0.0))


class Lock:
    """One of a joint's locks. `side` is +1 where the values below it are free; `met` says that the configuration given lies on it."""

    def __init__(self, joint, t, start):
        self.joint = joint
        self.at, self.kind, self.k, self.c = t["at"], t["kind"], t["stiffness"], t["damping"]
        self.met = abs(self.at - start) <= 1e-9 * (1 + abs(start))
        if self.met and t["side"] is None:
            raise Refused("a joint that starts on its lock, of no side")
        self.side = {"below": 1.0, "above": -1.0}[t["side"]] if self.met else math.copysign(1.0, self.at - start)
        self.held = False             # of one that the start lies on: until velocities or forces open it
        self.done = False             # a latch that holds: the law of the joint has ended

    @property
    def rigid(self):
        return self.k == 0.0


class ReadsFriction:
    def _read_friction(self):
        m = self.model
        for j in m.joints:
            f = j.friction
            if f is None:
                continue
            mu, preload, radius = f["mu"], f["preload"], f["radius"]
            rows = j.row_numbers if f["reaction"] else []
            way = lambda k: m.way_map[k]
            if j.type == "revolute":
                self.dry.append(Dry(j, [radius * way(j.way)], [j.name], mu, preload, rows[: 3 if m.space else 2], [radius]))
            elif j.type == "prismatic":
                self.dry.append(Dry(j, [way(j.way)], [j.name], mu, preload, rows[: 2 if m.space else 1], [1.0]))
            elif j.type == "strut":
                self.dry.append(Dry(j, [way(j.way)], [j.name], mu, preload, [], [1.0]))
            elif j.type == "screw":
                a = math.atan2(j.lead / (2 * math.pi), radius)
                turn, slide = m.thread_map[j.name]
                s = math.cos(a) ** 2 * turn + math.sin(a) * math.cos(a) / radius * slide
                worth = radius / math.cos(a) ** 2
                self.dry.append(Dry(j, [worth * s], [j.name], mu, preload, rows[2:3], [worth]))
            elif j.type == "cylindrical":
                self.dry.append(Dry(j, [way(j.ways[0]), radius * way(j.ways[1])], [j.name], mu, preload, rows[:2], [1.0, radius]))
            elif j.type == "planar":
                self.dry.append(Dry(j, [way(j.ways[0]), way(j.ways[1])], [j.name], mu, preload, rows[:1], [1.0, 1.0]))
            elif j.type == "universal":
                for k, which in enumerate(("first", "second")):
                    self.dry.append(Dry(j, [radius * way(j.ways[k])], [f"{j.name}.{which}"], mu, preload, rows[:3], [radius]))
            else:
                raise Refused(f"friction in {j.type}")
