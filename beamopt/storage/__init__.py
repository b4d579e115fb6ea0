"""Files: written and read, claimed folders, locks, journals, tables, checked keys."""
