"""A run from the first word to the last file: stretches, checkpoints, progress, failure."""
