"""Concealed effects at one of two dofs or between them, of a plant alone and on two motors."""
