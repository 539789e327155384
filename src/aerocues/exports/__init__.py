"""Using a combination elsewhere: as a program, in files of other tools, as their settings."""
