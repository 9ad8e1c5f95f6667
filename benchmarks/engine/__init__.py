"""Speed and accuracy of the engine beside what one would take instead."""
