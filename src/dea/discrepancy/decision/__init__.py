"""From fitted candidates to a name, several, none, or "unknown"."""

from dea.discrepancy.decision.adequacy import share_of
from dea.discrepancy.decision.confirmation import confirmed
from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.decision.extension import best_extension, proven_alone, sure_alone
from dea.discrepancy.decision.naming import decide
from dea.discrepancy.decision.priors import with_priors_checked
from dea.discrepancy.decision.rivals import same_class
from dea.discrepancy.decision.small_drift import without_small_drift

__all__ = [
    "Decision",
    "Reason",
    "Status",
    "best_extension",
    "confirmed",
    "decide",
    "proven_alone",
    "same_class",
    "share_of",
    "sure_alone",
    "with_priors_checked",
    "without_small_drift",
]
