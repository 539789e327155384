"""``python -m aerocues``."""

from __future__ import annotations

from aerocues.cli import main

if __name__ == "__main__":
    main()
