"""Checks: does a case make sense, what are its waves and its drag, and what will it cost? Nothing here runs it.

A rule stands in one of three places, by what it has to look at:

    one key                  a field or validator of its table, `case/tables/`
    two keys of the file     `case/tables/whole.py`: dimensions, names, tables that exclude each other
    the case in its tank     here: shapes, grid, waves and clock together

    finding      the result of a check
    rules        CHECKS, all checks in order; those of shapes, grid, clock and instruments
    waves        theory, wave makers and sponges
    boundaries   gates, open sides, pistons and absorbing walls
    answers      how many cells of water an overtopping wave is
    machine      whether this machine has the memory, and every cell a number
    cost         particles, steps, minutes, memory and disk
    drag         the drag of every porous body, in all conventions
    gauges       the time window in which gauges read steady waves
    wave_theory  is a wave inside the range of its theory, and does the grid resolve it
    report       `houle check` on the terminal

`case/section.py` holds the case as polygons, `case/acting.py` the places where makers act: pictures need them, too.
"""
