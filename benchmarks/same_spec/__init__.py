"""Simulations, with the sensors' noise, diagnosed with the very spec that was simulated."""
