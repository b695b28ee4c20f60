"""The answers of a run, one row each: value, interval, published formula and laboratory tests beside it.

table       a row
structure   the sea, the section and the wall that rows are about
sea         the sea of a case
outline     the section of a case in front of a crest
given       the case, its series and its sea; questions without an answer
wall        a structure on which forces are observed
formulas, wall_formulas   published formulas and laboratory tests beside an answer
overtopping, runup, walls, stability, reflection, pressures, mound, bank, armour   one kind of answer each
record      all rows of a run, answers.csv
picture     answers.png
"""
