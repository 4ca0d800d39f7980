"""Control with decisions at fixed sampling intervals."""
