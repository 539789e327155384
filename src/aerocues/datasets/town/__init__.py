"""The picture of a town that the package draws for itself."""
