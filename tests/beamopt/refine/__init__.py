"""Tests of the rooms that refine a section."""
