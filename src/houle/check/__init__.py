"""Checks: whether a case makes sense, what its waves and drag are, and what it will cost. Nothing here runs it.

A rule stands in one of three places, by what it has to look at:

    one key                  a field or validator of its table, `case/tables/`
    two keys of the file     `case/tables/whole.py`: dimensions, names, tables that exclude each other
    the case in its tank     here: shapes, grid, waves and clock together

    finding      what a check finds
    rules        CHECKS, all the checks in order; what concerns shapes, grid, clock and instruments
    waves        theory, wave makers and sponges
    boundaries   gates, open sides, pistons and absorbing walls
    machine      whether this machine has the memory, and every cell a number
    cost         particles, steps, minutes, memory and disk
    drag         the drag of every porous body, in all conventions
    gauges       when gauges read steady waves
    wave_theory  whether a theory can carry its wave, and a grid
    report       `houle check` on the terminal

The case as polygons is `case/section.py`, what acts on its water `case/acting.py`: pictures need them, too.
"""
