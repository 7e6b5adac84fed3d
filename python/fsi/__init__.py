"""Reads, measures and draws what runs of the LAMMPS FSI package leave behind.

Lengths are in metres, times in seconds, pressures in pascal, unless a docstring says otherwise.
Needs numpy and matplotlib, nothing else.
"""
