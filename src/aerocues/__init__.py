"""Choose local features for 3D reconstruction from drone images.

    import aerocues

    dataset = aerocues.open_dataset("photos", max_width=1000)
    print(aerocues.recommend(dataset, "race").best)
    results = aerocues.run(dataset, "ORB-*-HAM-BF,SIFT-SIFT-L2-BF", "results")
    print(aerocues.score(results).frame("combination"))
    aerocues.reconstruct("photos", "models", results="results", top=5)
    aerocues.write_report(results, "report.html")

Everything here is loaded when it is first used, so that importing the package costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from aerocues.datasets.catalog import open_dataset
    from aerocues.datasets.dataset import Dataset
    from aerocues.errors import AerocuesError
    from aerocues.evaluation.dask_engine import DaskEngine
    from aerocues.evaluation.run import Limits, Observer, run
    from aerocues.methods.arrays import Features, Keypoints, Matches
    from aerocues.methods.combination import Combination
    from aerocues.methods.plugins import register
    from aerocues.modelling import reconstruct
    from aerocues.reconstruction.models import Models
    from aerocues.reconstruction.options import ReconstructionOptions
    from aerocues.reconstruction.protocol import ReconstructionProtocol
    from aerocues.report.report import write_report
    from aerocues.results.importing import import_results
    from aerocues.results.measured_results import Results
    from aerocues.scoring.measured import score
    from aerocues.scoring.outcomes import relate_outcomes
    from aerocues.scoring.ranking import Ranking
    from aerocues.tuning.recommend import RaceOptions, Recommendation, recommend
    from aerocues.tuning.tune import TuneOptions, tune

    __version__: str

_MODULES = {
    "open_dataset": "datasets.catalog",
    "Dataset": "datasets.dataset",
    "run": "evaluation.run",
    "Limits": "evaluation.run",
    "Observer": "evaluation.run",
    "DaskEngine": "evaluation.dask_engine",
    "Results": "results.measured_results",
    "import_results": "results.importing",
    "reconstruct": "modelling",
    "ReconstructionOptions": "reconstruction.options",
    "ReconstructionProtocol": "reconstruction.protocol",
    "Models": "reconstruction.models",
    "score": "scoring.measured",
    "relate_outcomes": "scoring.outcomes",
    "Ranking": "scoring.ranking",
    "write_report": "report.report",
    "recommend": "tuning.recommend",
    "RaceOptions": "tuning.recommend",
    "Recommendation": "tuning.recommend",
    "tune": "tuning.tune",
    "TuneOptions": "tuning.tune",
    "Combination": "methods.combination",
    "register": "methods.plugins",
    "Keypoints": "methods.arrays",
    "Features": "methods.arrays",
    "Matches": "methods.arrays",
    "AerocuesError": "errors",
}

__all__ = [
    "AerocuesError",
    "Combination",
    "DaskEngine",
    "Dataset",
    "Features",
    "Keypoints",
    "Limits",
    "Matches",
    "Models",
    "Observer",
    "RaceOptions",
    "Ranking",
    "Recommendation",
    "ReconstructionOptions",
    "ReconstructionProtocol",
    "Results",
    "TuneOptions",
    "__version__",
    "import_results",
    "open_dataset",
    "recommend",
    "reconstruct",
    "register",
    "relate_outcomes",
    "run",
    "score",
    "tune",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Load what is asked for."""
    from importlib import import_module, metadata

    if name == "__version__":
        return metadata.version("aerocues")
    if name not in _MODULES:
        raise AttributeError(f"module 'aerocues' has no attribute {name!r}")
    return getattr(import_module(f"aerocues.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
