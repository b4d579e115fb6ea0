"""Subjects, cases, meshes and folders that checks and predictions stand on."""
