"""Many loops: grids and random draws of spec values, on this machine or a Dask cluster."""
