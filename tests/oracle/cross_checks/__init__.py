"""The command against itself: an answer found by two ways that share little. See `analyses_against_each_other.py`."""
