"""What the waves of a run did and how far it can be believed: reflection, energy, impacts, the summary."""
