"""Reconstructs scenes with COLMAP from any combination, and evaluates the models."""
