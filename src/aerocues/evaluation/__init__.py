"""How combinations are measured."""
