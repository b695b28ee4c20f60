"""What a run writes. Every file is written whole under a temporary name, then renamed: kill -9 leaves readable files.

For the runner (all failures of the file system raise OutputError, one message with path and cure):

    out = Outputs(directory, case, grid)         # writes nothing yet; case: .gauge, .sensor, .case.title, .case.name, .hash
    out.truncate_after(time)                     # resume only: go on with the files there, rows and frames after `time` dropped
    out.append_series(time, sample)              # sample: dict of Simulation.sample(): eta, pressure, velocity and ledger scalars
    out.append_frame(frame)                      # a row of surface.nc and a frame of fields.vtkhdf
    out.commit()                                 # everything appended so far is in the files; call it before each checkpoint
    out.commit_if_due(seconds=5.0)               # the same, at most once per so many seconds of wall time: call it every step
    out.close()                                  # commit, and pack fields.vtkhdf into one file

    save_checkpoint(directory, step, state, meta) -> Path       # state: dict of arrays and scalars; meta: dict that JSON can hold
    load_newest(directory) -> Checkpoint | None                 # .path .step .state .meta; skips a damaged file
    checkpoints(directory) -> list[Path]                        # newest first

    collect(case, threads) -> dict                              # the manifest at the start of a run
    write_manifest(directory, manifest) -> Path                 # run.json, atomically; read_manifest(directory) -> dict
    read_series(directory), read_surface(directory) -> xarray.Dataset (in memory; the files are closed)
    read_fields(directory) -> FieldsReader: .times, .frame(i) -> Frame

Pictures (houle.output.pictures; imports matplotlib, so import it late) and films (houle.output.movie):

    write_pictures(directory, case, grid, series, surface, fields, reference=None, times=None) -> list[Path]     # all that apply
    surface_picture / pressure_picture / ledger_picture / gauges_picture     # one each, with an output path
    movie.write_movie(path, case, grid, fields, rate=25)                     # OutputError with a cure when imageio-ffmpeg is missing

A new writer: copy surface.py, add it to Outputs.
"""
