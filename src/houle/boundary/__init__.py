"""What acts on the water from outside: moving walls, open sides, wave makers, sponges."""
