# Who is studied, which settings shape a job, which code it depends on.
import json
import re
import sys
import time

sys.path.insert(0, str(Path(workflow.basedir) / "workflow"))

import yaml
from imports import modules
from snakemake.exceptions import WorkflowError

STARTED = time.time()

# A system is whatever has a record: an actuator of the config or a case of config/cases.
ACTUATORS = {actuator["name"]: actuator for actuator in config["actuators"]}
CASES = {path.stem: path for path in sorted(Path("config/cases").glob("*.yaml"))}
# Folders of results/ that belong to no system.
RESERVED = {"benchmark", "discrepancy", "figures", "log", "tables", "trials"}


def check_names():
    """Every system has a name, and with it a folder of results, of its own."""
    taken = set(RESERVED)
    for file, field, name in [
        *(
            ("config/config.yaml", "actuators.name", actuator["name"])
            for actuator in config["actuators"]
        ),
        *((path, "name of the file", name) for name, path in CASES.items()),
    ]:
        if name in taken:
            raise WorkflowError(
                f"{file}: {field}: {name!r} is taken. Give each actuator and case another name."
            )
        taken.add(name)


check_names()


def load_case(path):
    """A case file, checked before anything runs; its sections as if they were the config's."""
    schemas = Path(workflow.basedir) / "workflow/schemas"
    try:
        case = yaml.safe_load(path.read_text())
        validate(case, schemas / "case.schema.yaml")
        own = {name: config[name] | case[name] for name in config.keys() & case.keys()}
        validate(config | own, schemas / "config.schema.yaml")
    except (yaml.YAMLError, WorkflowError) as error:
        raise WorkflowError(f"{path} is no valid case.", error) from error
    return case


CASE = {name: load_case(path) for name, path in CASES.items()}


wildcard_constraints:
    system="[A-Za-z0-9_-]+",
    actuator="|".join(ACTUATORS),
    case="|".join(CASES) or "no-case",


def of_every_actuator(pattern):
    """The file ``pattern`` of each actuator."""
    return expand(pattern, actuator=ACTUATORS)


def settings(*sections, **own_leaves):
    """The seed, the system's name and these sections of the config, as JSON for a stage.

    A case's own sections override the config's, key by key; ``own_leaves`` are the job's.
    """

    def resolve(wildcards):
        name = next(
            (
                wildcards.get(key)
                for key in ("system", "actuator", "case")
                if wildcards.get(key)
            ),
            None,
        )
        own = CASE.get(name, {})
        leaves = {
            section: (
                config[section] | own.get(section, {})
                if isinstance(config[section], dict)
                else config[section]
            )
            for section in sections
        }
        return json.dumps(
            {"seed": config["seed"], "system": name} | leaves | own_leaves,
            sort_keys=True,
        )

    return resolve


def failures(folder, since):
    """How the logs that end in an error and are younger than ``since`` end, each with its name."""
    ends = []
    for log in sorted(Path(folder).rglob("log/*.log")):
        lines = log.read_text().splitlines()
        young = log.stat().st_mtime >= since
        if young and lines and re.search(r"[Ee]rror\b", lines[-1]):
            ends.append(f"{log}: {lines[-1]}")
    return "\n".join(ends)
