"""Bouc-Wen elements and nonlinear springs: laws, motions by DOP853 from event to event, equilibria along a path of loads, periodic motions
by shooting."""
