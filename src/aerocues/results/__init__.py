"""The results folder: schema, rows, reading, importing and exporting."""
