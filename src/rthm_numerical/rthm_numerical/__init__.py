"""Numerical substructure of a hybrid test."""
