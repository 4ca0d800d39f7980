"""Arrays with meanings and units, and their NetCDF files."""
