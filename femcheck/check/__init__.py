"""One design checked: its solid at 27 pressure combinations, compared with the beam."""
