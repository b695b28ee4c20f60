"""The observables of a run, one file for each: gauges, sensors, forces and others that a case can ask for.

    gauge, sensor, runup, overtopping, flux, phreatic, force, bank, armour, paddle, ledger    those of series.nc
    snapshot    the surface (`Profile`) and the fields, for surface.nc and fields.vtkhdf
    levels, points, faces    levels of columns, pressure between cell centres, places on the faces of bodies, for these

They follow the protocol of `houle.flow.observer`: an `Instrument` as the case gives it, an `Observer` of all
instruments of a kind in a flow.

Everything is placed once; a sample is a few operations on slices of the grid. Levels and volumes are those of the
positions, at the ends of steps; velocities and pressures are older (`houle.fields.Field.instant`). To add an
observable, write a file like gauge.py and its table in `houle.case.tables.observed`: the case file, `houle check`,
`houle describe fields` and the writers find both.
"""
