"""The answers of a run, one row each: value, interval, published formula and laboratory tests beside it.

table       a row
structure   the sea and the section that a row is compared for, in numbers
sea         the sea of a case
outline     the section of a case in front of a crest
formulas    published formulas and laboratory tests beside an answer
overtopping, runup, walls, reflection, pressures   one kind of answer each
record      all rows of a run, answers.csv and answers.png
"""
