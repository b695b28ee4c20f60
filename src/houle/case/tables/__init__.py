"""The tables of a case file, one model each: keys, units, ranges. They know the file, not the physics of the whole."""
