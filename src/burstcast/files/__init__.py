"""Arrays with meanings and units, and NetCDF files of them."""
