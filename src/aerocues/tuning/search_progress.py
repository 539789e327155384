"""What a search of parameters tells while it goes on."""

from __future__ import annotations

from aerocues.progress import Progress, StageProgress
from aerocues.tuning.grids import Setting
from aerocues.tuning.search import Finding


class SearchProgress:
    """Turns what happens in a search into events.

    Parameters
    ----------
    progress : callable or None
        Called with each event.
    total : int
        Search spaces.
    """

    def __init__(self, progress: Progress | None, total: int) -> None:
        self._done, self._total = 0, total
        self._reading = StageProgress(progress, "reading images", "images")
        self._searching = StageProgress(progress, "searching", "search spaces", total=total)
        self.read, self.watch = self._reading.count, self._searching.watch

    def found(self, finding: Finding) -> None:
        """A search space has been searched."""
        self._done += 1
        told = f"{setting_text(finding.best)}: {gain_text(finding)}" if finding.best else "default"
        reason = f"; {finding.why_not}" if finding.why_not else ""
        self._searching.tell(
            done=self._done,
            share=self._done / self._total,
            message=f"{self._done} of {self._total}: {finding.space.name}: {told}{reason}",
        )


def setting_text(setting: Setting) -> str:
    """``bytes=32, use_orientation=False``."""
    return ", ".join(f"{name}={value}" for name, value in setting.items()) or "default"


def gain_text(finding: Finding) -> str:
    """``+0.021 (+0.010 to +0.032)``: a gain with its 95 % interval."""
    return f"{finding.gain:+.3f} ({finding.low:+.3f} to {finding.high:+.3f})"
