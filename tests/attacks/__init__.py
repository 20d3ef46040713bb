"""Malformed files of every type: made from valid ones, read and used. `fuzz.py` is the command."""
