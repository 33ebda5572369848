"""Structures of the oracle: their matrices, loads and contacts, all dense."""
