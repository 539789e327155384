"""The figures of the page as Plotly figures, for notebooks and programs."""
