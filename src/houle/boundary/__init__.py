"""Boundaries of the water: gates, moving walls, open sides, makers of waves, relaxation zones and sponges."""
