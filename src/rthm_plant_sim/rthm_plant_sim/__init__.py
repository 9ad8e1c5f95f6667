"""Simulated physical substructure of a hybrid test, and the place of a driver for real hardware."""
