"""Shows results: one interactive page, figures for a paper, a short text."""
