"""Effects hidden in the simulated plant of a real node graph, found again from the recorded bags."""
