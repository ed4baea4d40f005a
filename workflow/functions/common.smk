# Who is studied, which settings shape a job, which code it depends on.
import json
import re
import time

import imports

from dea.audit import collect, withdraw
from dea.configuration.bench import (
    BENCH,
    plain_settings,
    read_bench,
    served_settings,
)
from dea.configuration.case import read_cases, simulation_of
from dea.configuration.named_files import check_actuators, check_files
from dea.configuration.record import is_part_of
from dea.configuration.study import check_names, check_study
from dea.configuration.study import settings as written

STARTED = time.time()


def catalogue(folder):
    """The names in a folder of the simulations, each of which has a file."""
    paths = Path("src/dea/simulation", folder).glob("[!_.]*.py")
    return sorted(path.stem for path in paths)


EFFECTS, DEVICES = catalogue("effects"), catalogue("devices")


def configuration():
    """The checked study, virtual actuators and cases; a mistake ends it before anything runs."""
    try:
        study = check_study(config)
        bench = read_bench(BENCH)
        check_actuators(study, list(bench.actuators), BENCH)
        check_names(study, DEVICES, EFFECTS)
        check_files(study)
        return study, bench, read_cases("config/cases", study)
    except InputError as error:
        raise WorkflowError(str(error)) from None


STUDY, VIRTUAL_BENCH, _cases = configuration()
# Numbers of the command line, which Snakemake hands over as text, are numbers from here on.
config.update(written(STUDY))

# A system is whatever has a record: an actuator of the config or a case of config/cases.
ACTUATORS = {actuator["name"]: actuator for actuator in config["actuators"]}
CASES = {path.stem: path for path in _cases}
CASE = {path.stem: written(case) for path, case in _cases.items()}


wildcard_constraints:
    system="|".join([*ACTUATORS, *CASES]),
    actuator="|".join(ACTUATORS),
    case="|".join(CASES) or "no-case",


def of_every_actuator(pattern):
    """The file ``pattern`` of each actuator."""
    return expand(pattern, actuator=ACTUATORS)


def device_file(wildcards):
    """The description of the device that drives an actuator."""
    return ACTUATORS[wildcards.actuator]["device"]


def device_content(wildcards):
    return imports.content(device_file(wildcards))


def settings(*keys):
    """The seed, the system's name and these keys of the config, as JSON for a stage.

    A key is a section, or one of its own, as `gfrf.tracker`, so that an edit of another one does
    not rerun the job; an optional one that is not given is left out. A case has its own sections.
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
        own = config | CASE.get(name, {})
        leaves = {}
        for section, _, key in (each.partition(".") for each in keys):
            if not key:
                leaves[section] = own[section]
            elif key in own[section]:
                leaves.setdefault(section, {})[key] = own[section][key]
        return json.dumps(
            {"seed": config["seed"], "system": name} | leaves, sort_keys=True
        )

    return resolve


def modules(*names, files=()):
    """A list of the code of a job: of these modules, of all that they import, and these files.

    The list of installed packages is on it, since another version of a package is other code.
    """
    code = [*imports.modules(*names), *files, imports.environment()]
    return imports.listed(code)


def stage(command):
    """The shell command that runs a stage, which keeps what made its products.

    It refuses code that the rule's ``code`` does not list. Its log names the job.
    """
    code = 'DEA_CODE="$(cut -c 67- {input.code:q})"'
    # In bash this is the rule's name; `snakemake --lint` takes a plain {rule} for a foreign variable.
    named = "DEA_RULE=${{0:+{rule}}}"
    return f"DEA_JOB={{log:q}} {named} {code} python -m dea.stages.{command}"


def failures(folder, since):
    """The last error in each log that is younger than ``since``, with the log's name."""
    last = []
    for log in sorted(Path(folder).rglob("log/*.log")):
        if log.stat().st_mtime >= since:
            errors = re.findall(r"^\S*[Ee]rror: .*", log.read_text(), re.MULTILINE)
            last += [f"{log}: {line}" for line in errors[-1:]]
    return "\n".join(last)
