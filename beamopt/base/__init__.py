"""Arrays, errors, compiled kernels, random streams, tasks: imported by every folder."""
