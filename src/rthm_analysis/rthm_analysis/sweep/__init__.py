"""Many loops: grids and draws of spec values."""
