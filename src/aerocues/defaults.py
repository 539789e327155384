"""Defaults of functions, and of the commands of the same name: light enough for their help."""

from __future__ import annotations

TIMED_PAIRS = 5
"""Pairs that `run` times alone."""
CALL_TIMEOUT = 600.0
"""CPU seconds of one call of a method."""
STAGE_TIMEOUT = 1800.0
"""CPU seconds of one stage of a reconstruction."""
RACE_SECONDS = 300.0
RACE_WIDTH = 1000
"""Pixels: recommending is to be quick, and rankings hardly differ from those of larger images."""
RACE_PAIRS = 24
"""More represent a dataset better, and leave time to measure fewer combinations on each."""
SURE = 0.95
"""Probability of the leader at which a race ends."""
FLIGHT_KEYPOINTS = 8000
"""Strongest keypoints of an image that races and reconstructions keep."""
RECONSTRUCTED = 10
"""Best combinations of results that are reconstructed."""
SIZE, SUN = "1000x665", "140,48"
"""Of a simulated flight: pixels; azimuth and elevation in degrees."""
TUNING_PAIRS = 16
RESAMPLES = 1000
TOP_K = 5
"""Places that count for the probability of being among the best."""
SHORTLIST = 10
PICTURED = 4
"""Combinations that the report shows pictures of."""
MEGABYTES = 15.0
LEAST_MEMORY = 0.5
"""Gigabytes: a worker starts with 0.15, and needs 0.3 for the quickest methods on 600 pixels."""
