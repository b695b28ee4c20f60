"""Results of a run: reflection, energy of the waves, quality of the waves, impacts, and the summary."""
