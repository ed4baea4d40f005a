"""Whether results are what their jobs made: manifest, verification, recomputation."""

from dea.audit.manifest import Manifest, collect, withdraw
from dea.audit.verify import Finding, verify

__all__ = ["Finding", "Manifest", "collect", "verify", "withdraw"]
