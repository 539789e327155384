"""Exact mutual nearest neighbours: what OpenCV's brute force answers, many times sooner."""
