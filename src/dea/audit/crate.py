"""The results as a Workflow Run RO-Crate (Provenance Run profile): files, and what made each.

https://www.researchobject.org/workflow-run-crate/profiles/provenance_run_crate. What a job said of
itself (:mod:`dea.provenance`) becomes an action; what is not known is left out.
"""

import json
import os
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from rocrate.model.computationalworkflow import ComputationalWorkflow
from rocrate.model.contextentity import ContextEntity
from rocrate.model.entity import Entity
from rocrate.rocrate import ROCrate

from dea import provenance
from dea.audit.manifest import Manifest, collect
from dea.audit.verify import verify
from dea.errors import InputError

WORKFLOW = Path("Snakefile")
# All files that say what the workflow does, beside the code of its jobs.
PARTS = ("workflow", "config", "environment.txt", "LICENSE", "CITATION.cff")
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
EXTERNAL = Path("external")  # where the crate keeps files from outside of the project
# Not in the context of RO-Crate 1.1, on which the profiles rest.
TERMS = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}


class JobTimes(NamedTuple):
    """When a job ran: its start and end in s since 1970."""

    start: float
    end: float


def write(folder: Path, spans: Mapping[str, JobTimes]) -> None:
    """Write the crate of all results to ``folder``, which holds copies of its files.

    Parameters
    ----------
    spans
        By the path of a product, when its job ran; without one, the times are left out.

    Raises
    ------
    InputError
        If a result is not what its job made, or a source not what it was made from: the crate
        would hold another file than it says.
    """
    manifest = collect()
    if findings := verify(manifest):
        path, problem = findings[0]
        raise InputError(problem, file=path, remedy="`make audit` says what to do")
    _Crate(manifest, spans).crate.write(folder)


class _Crate:
    """The crate while it is put together; ``entities`` hold its files by their paths."""

    def __init__(self, manifest: Manifest, spans: Mapping[str, JobTimes]) -> None:
        self.manifest, self.spans = manifest, spans
        self.crate = ROCrate(version="1.1")
        self.crate.metadata.extra_contexts.append(TERMS)
        self.entities: dict[str, Entity] = {}
        self.tools: dict[str, Entity] = {}
        self._root()
        workflow = self._workflow()
        actions = [self._action(identity) for identity in sorted(manifest.jobs)]
        workflow["hasPart"] = list(self.tools.values())
        self._run(workflow, actions)

    def _root(self) -> None:
        root = self.crate.root_dataset
        root["name"] = "Results of dea-study"
        root["description"] = (
            "Models of dielectric elastomer actuators, with what made each file: its job, settings,"
            " inputs, code and environment."
        )
        root["license"] = self._context("https://spdx.org/licenses/MIT", "CreativeWork", name="MIT")
        root["conformsTo"] = [
            self._context(url, "CreativeWork", name=name, version=url.rpartition("/")[2])
            for url, name in PROFILES.items()
        ]
        for part in map(Path, PARTS):
            found = [part] if part.is_file() else part.rglob("*")
            for file in sorted(found):
                if file.is_file() and "__pycache__" not in file.parts:
                    self._file(str(file))

    def _workflow(self) -> Entity:
        kinds = ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"]
        workflow = self.crate.add_workflow(
            WORKFLOW, WORKFLOW.name, main=True, lang="snakemake", cls=ComputationalWorkflow,
            properties={"@type": kinds, "name": "dea-study"},
        )  # fmt: skip
        rules = sorted({job["rule"] for job in self.manifest.jobs.values()})
        workflow["step"] = []
        for position, rule in enumerate(rules):
            self.tools[rule] = self._context(f"#rule-{rule}", "SoftwareApplication", name=rule)
            step = self._context(
                f"#step-{rule}", "HowToStep", name=rule, position=str(position),
                workExample=self.tools[rule],
            )  # fmt: skip
            workflow.append_to("step", step)
        return workflow

    def _action(self, identity: str) -> Entity:
        """Add one job, its tool's code and environment, and its settings."""
        job = self.manifest.jobs[identity]
        products = [p for p, one in self.manifest.products.items() if one["job"] == identity]
        tool, run = self.tools[job["rule"]], job["run"]
        tool["hasPart"] = [self._file(path) for path in job["code"]]
        tool["softwareRequirements"] = self._file("environment.txt")
        tool["version"] = run["commit"]
        settings = self._context(
            f"#settings-{identity}", "PropertyValue", name="settings",
            value=json.dumps(job["settings"], sort_keys=True),
        )  # fmt: skip
        facts: dict[str, Any] = {
            "name": job["name"],
            "identifier": identity,
            "description": " ".join(["python -m", *job["command"]]),
            "instrument": tool,
            "object": [*map(self._file, provenance.sources(job, run)), settings],
            "result": [self._file(path) for path in products],
            "actionStatus": {"@id": "http://schema.org/CompletedActionStatus"},
        }
        spans = [self.spans[path] for path in products if path in self.spans]
        if spans:
            facts["startTime"], facts["endTime"] = (_date(time) for time in spans[0])
        return self._context(f"#job-{identity}", "CreateAction", **facts)

    def _run(self, workflow: Entity, actions: Iterable[Entity]) -> None:
        """Add the run as a whole: the engine that organised the jobs, one by one."""
        engine = self._context(
            "#snakemake", "SoftwareApplication", name="Snakemake", url="https://snakemake.github.io",
            version=version("snakemake"),
        )  # fmt: skip
        controls = [self._control(action) for action in actions]
        made = [self.entities[path] for path in self.manifest.products]
        config = [entity for path, entity in self.entities.items() if path.startswith("config/")]
        run = self._context(
            "#run", "CreateAction", name="run of the study", instrument=workflow, object=config,
            result=made,
        )  # fmt: skip
        self._context(
            "#organise", "OrganizeAction", name="organisation of the run", instrument=engine,
            object=controls, result=run,
        )  # fmt: skip
        self.crate.root_dataset["mentions"] = [run]

    def _control(self, action: Entity) -> Entity:
        step = self.crate.dereference(f"#step-{action['instrument']['name']}")
        name, reference = f"run of {action['name']}", action.id.replace("#job-", "#control-")
        return self._context(reference, "ControlAction", name=name, object=action, instrument=step)

    def _file(self, path: str) -> Entity:
        """Return the entity of a file or folder of the project, which is added once."""
        if path not in self.entities:
            known = self.manifest.products.get(path, {}).get("sha256")
            sha = known or provenance.digest(Path(path))
            place = _place(path, sha)
            if Path(path).is_dir():
                self.entities[path] = self.crate.add_dataset(path, place)
            else:
                facts = {"contentSize": str(Path(path).stat().st_size), "sha256": sha}
                self.entities[path] = self.crate.add_file(path, place, properties=facts)
        return self.entities[path]

    def _context(self, reference: str, kind: str, /, **properties: Any) -> Entity:
        entity = ContextEntity(self.crate, reference, properties={"@type": kind})
        for name, value in properties.items():
            entity[name] = value
        added: Entity = self.crate.add(entity)
        return added


def _place(path: str, sha: str) -> Path:
    """Return where in the crate a file or folder lies, which may be outside of the project."""
    place = Path(os.path.relpath(path))
    # The hash keeps two of one name apart.
    return EXTERNAL / sha[:12] / place.name if place.parts[0] == os.pardir else place


def _date(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec="seconds")
