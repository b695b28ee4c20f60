"""What is observed while a case runs, one file per observable.

    observer    what all of them have in common: `Instrument`, `Observer`, `Instruments`, `Stations`, `Site`
    gauge, sensor, runup, overtopping, flux, phreatic, force, paddle, ledger    the observables of series.nc
    profile, snapshot    the surface and the fields, for surface.nc and fields.vtkhdf

Everything is placed once; a sample is a few operations on slices of the grid. Levels and volumes are those of the
positions, at the ends of steps; velocities and pressures are older (`houle.fields.Field.instant`). To add an
observable, write a file like gauge.py and its table in `houle.case.tables.observed`: the case file, `houle check`,
`houle describe fields` and the writers find both.
"""
