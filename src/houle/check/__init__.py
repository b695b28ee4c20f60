"""Pre-flight: whether a case makes sense, what its waves are, and what it will cost."""
