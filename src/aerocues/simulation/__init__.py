"""Flights that never took place: procedural scenes, a software renderer, exact ground truth."""
