"""Benchmarks: ratios measured in one run, never asserted. `sh run bench [NAME]`."""
