"""The parts of `generate.py`: random studies of structures. Each class adds to the one before; the order of draws is what a seed means."""
