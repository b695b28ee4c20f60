"""The tables of a case file, one model each, with keys, units and ranges. They do not know the physics of the whole."""
