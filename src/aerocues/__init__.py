"""Choose local features for 3D reconstruction from drone images.

    import aerocues

    print(aerocues.recommend("photos").best)
    results = aerocues.run("photos", "ORB-*-HAM-BF,SIFT-SIFT-L2-BF", "results")
    aerocues.score(results)
    aerocues.reconstruct("photos", results=results, top=5)
    aerocues.write_report(results, "report.html")
    matched = aerocues.match("photos/1.jpg", "photos/2.jpg", "ORB-BEBLID-HAM-BF")

Functions take images, then combinations, then the place of the output; all else has a name. Images
are a dataset, its text form, a folder or files; results are `Results` or their path. What a caller
can mend raises `AerocuesError`. Everything is loaded when it is first used, so that importing the
package costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from aerocues.datasets.catalog import open_dataset
    from aerocues.datasets.dataset import Dataset
    from aerocues.errors import AerocuesError
    from aerocues.evaluation.dask_engine import DaskEngine
    from aerocues.evaluation.run import run
    from aerocues.exports.use import Used, use
    from aerocues.methods.arrays import Features, Keypoints, Matches
    from aerocues.methods.combination import Combination
    from aerocues.methods.plugins import register
    from aerocues.modelling.recommend import recommend
    from aerocues.modelling.reconstruct import reconstruct
    from aerocues.pipeline.pipeline import Pipeline
    from aerocues.pipeline.two_images import MatchedImages, features, match
    from aerocues.pipeline.upright import upright
    from aerocues.progress import Event
    from aerocues.reconstruction.models import Models
    from aerocues.report.figure import figure
    from aerocues.report.report import write_report
    from aerocues.results.importing import import_results
    from aerocues.results.measured_results import Results
    from aerocues.results.study import Study
    from aerocues.scoring.assessment import compare, score, validate
    from aerocues.scoring.compared import ComparedResults
    from aerocues.scoring.outcomes import Relations, relate_outcomes
    from aerocues.scoring.ranking import Ranking
    from aerocues.scoring.validation import Validation
    from aerocues.simulation.simulate import simulate
    from aerocues.tuning.choice import Choice, choose
    from aerocues.tuning.recommendation import Recommendation
    from aerocues.tuning.tune import Tuned, tune

    __version__: str

_MODULES = {
    "open_dataset": "datasets.catalog",
    "Dataset": "datasets.dataset",
    "features": "pipeline.two_images",
    "match": "pipeline.two_images",
    "upright": "pipeline.upright",
    "MatchedImages": "pipeline.two_images",
    "Pipeline": "pipeline.pipeline",
    "simulate": "simulation.simulate",
    "run": "evaluation.run",
    "DaskEngine": "evaluation.dask_engine",
    "Results": "results.measured_results",
    "import_results": "results.importing",
    "Study": "results.study",
    "score": "scoring.assessment",
    "Ranking": "scoring.ranking",
    "validate": "scoring.assessment",
    "Validation": "scoring.validation",
    "choose": "tuning.choice",
    "Choice": "tuning.choice",
    "compare": "scoring.assessment",
    "ComparedResults": "scoring.compared",
    "relate_outcomes": "scoring.outcomes",
    "Relations": "scoring.outcomes",
    "reconstruct": "modelling.reconstruct",
    "Models": "reconstruction.models",
    "write_report": "report.report",
    "figure": "report.figure",
    "recommend": "modelling.recommend",
    "Recommendation": "tuning.recommendation",
    "tune": "tuning.tune",
    "Tuned": "tuning.tune",
    "Combination": "methods.combination",
    "use": "exports.use",
    "Used": "exports.use",
    "register": "methods.plugins",
    "Keypoints": "methods.arrays",
    "Features": "methods.arrays",
    "Matches": "methods.arrays",
    "Event": "progress",
    "AerocuesError": "errors",
}

__all__ = [
    "AerocuesError",
    "Choice",
    "Combination",
    "ComparedResults",
    "DaskEngine",
    "Dataset",
    "Event",
    "Features",
    "Keypoints",
    "MatchedImages",
    "Matches",
    "Models",
    "Pipeline",
    "Ranking",
    "Recommendation",
    "Relations",
    "Results",
    "Study",
    "Tuned",
    "Used",
    "Validation",
    "__version__",
    "choose",
    "compare",
    "features",
    "figure",
    "import_results",
    "match",
    "open_dataset",
    "recommend",
    "reconstruct",
    "register",
    "relate_outcomes",
    "run",
    "score",
    "simulate",
    "tune",
    "upright",
    "use",
    "validate",
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
