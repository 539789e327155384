"""Numbers on their way into the page."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from aerocues.report.arrays import packed_bytes, packed_floats, plain
from tests.report.decoding import floats, numbers


@settings(max_examples=30)
@given(arrays.arrays(np.float32, arrays.array_shapes(max_dims=3, max_side=5)))
def test_floats_come_back_bit_for_bit(values: NDArray[np.float32]) -> None:
    np.testing.assert_array_equal(floats(packed_floats(values), *values.shape), values)


def test_what_does_not_lie_in_rows_is_packed_in_rows() -> None:
    values = np.arange(6).reshape(2, 3).T
    assert floats(packed_floats(values), 3, 2).tolist() == values.tolist()
    assert numbers(packed_bytes(values), 3, 2).tolist() == values.tolist()


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.123456789, 0.12346),
        (123456.0, 123460),
        (2.0, 2),
        (math.nan, None),
        (-math.inf, None),
        (np.float64(0.5), 0.5),
        (np.int64(30_000_123), 30_000_123),
        (np.array([[1.0, math.nan]]), [[1, None]]),
        ((1, {"a": Path("b/c")}), [1, {"a": "b/c"}]),
        (True, True),
        ("<b>", "<b>"),
    ],
)
def test_values_become_what_json_can_write(value: object, expected: object) -> None:
    assert plain(value) == expected


@pytest.mark.slow
@given(st.recursive(st.floats() | st.integers() | st.text() | st.none(), st.lists))
def test_anything_can_be_written_as_strict_json(value: object) -> None:
    json.dumps(plain(value), allow_nan=False)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_rounding_changes_little(value: float) -> None:
    assert plain(value) == pytest.approx(value, rel=1e-4)
