"""What a real-time hybrid test is: spec, clocks, links, substructures, energy and the exact engine."""
