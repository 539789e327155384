"""What a user asks of a dataset, whichever kind it is."""

from __future__ import annotations

from dataclasses import dataclass

from aerocues.datasets.fitting import check_settings


@dataclass(frozen=True)
class Options:
    """How images are paired and read.

    Parameters
    ----------
    pairs : str or None
        Text form of a pair strategy (see `parse_pairs`); None: the default of the dataset's kind.
    max_width : int or None
        Wider images are shrunk to this width in pixels.
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    """

    pairs: str | None = None
    max_width: int | None = None
    equalize: str = "none"

    def __post_init__(self) -> None:
        check_settings(self.max_width, self.equalize)

    def settings(self, **more: str) -> tuple[tuple[str, str], ...]:
        """The options as `Dataset.settings` records them, and what the kind of dataset adds."""
        width = "full" if self.max_width is None else str(self.max_width)
        return (*more.items(), ("max_width", width), ("equalize", self.equalize))
