"""Keys that are hashes of content."""

from __future__ import annotations

import hashlib
import json

KEY_LENGTH = 32


def content_hash(content: object) -> str:
    """Hexadecimal hash of any JSON value."""
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:KEY_LENGTH]
