"""Concealed components, motion in and force out, with equations of the benchmark's own."""
