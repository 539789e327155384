"""Reconstructs scenes with COLMAP from any combination, and judges the models."""
