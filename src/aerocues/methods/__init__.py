"""What is combined: detectors, descriptors, norms and matchers."""
