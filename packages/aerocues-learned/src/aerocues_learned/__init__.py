"""Learned features and matchers for aerocues, by ONNX Runtime.

Nothing is downloaded and torch is not needed: the weights come with the package, but for those of
LIGHTGLUE (see `aerocues_learned.weights`). All take part on request only.
"""
