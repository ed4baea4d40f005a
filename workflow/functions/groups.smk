# Groups of figures and tables. One job makes a group from the same files, so that Python starts and
# the files are read once for all its members.
import re
from dataclasses import dataclass, field
from functools import reduce
from operator import getitem

import yaml


@dataclass
class Group:
    """Figures or tables that one job makes.

    sources: the files that they are made from, as of a rule's input
    path: where each goes, without the ending; {name} stands for its name
    system: whose they are, as the report says
    among: the systems that {system} may stand for
    members: the lines of the group in workflow/figures.yaml or tables.yaml, by name
    """

    sources: object
    path: str
    system: str
    among: list = field(default_factory=lambda: [*ACTUATORS, *CASES])
    members: dict = field(default_factory=dict)

    def files(self, *kinds, **wildcards):
        """The members of these kinds, one kind after the other."""
        paths = [
            f"{self.path.replace('{name}', name)}.{kind}"
            for kind in kinds
            for name in self.members
        ]
        return expand(paths, **wildcards) if wildcards else paths

    def reported(self, room, kind):
        """The members of a kind, each with its caption, category and labels of the report."""
        files = self.files(kind)
        for place, (name, entry) in enumerate(self.members.items()):
            files[place] = report(
                files[place],
                caption=f"../report/{room}/{name}.rst",
                category=entry["category"],
                labels={"figure": entry["label"], "system": self.system},
            )
        return files

    def modules(self, room):
        """The modules of the members, one each."""
        return [f"dea.{room}.{name}" for name in self.members]


def of_one(datasets, folder, among):
    """A group of figures of one system, whose files go to this folder."""
    return Group(
        sources=[f"results/{{system}}/{dataset}.nc" for dataset in datasets],
        path=f"results/figures/{folder}/{{name}}_{{system}}",
        system="{system}",
        among=list(among),
    )


def pages(name, datasets, path, systems, most):
    """Groups of at most so many systems each: NAME, then NAME_2, whose paths end in _page2."""
    starts = range(0, len(systems), most)
    found = {}
    for number, first in enumerate(starts, start=1):
        shown = systems[first : first + most]
        found[name if number == 1 else f"{name}_{number}"] = Group(
            sources=expand(
                "results/{system}/{dataset}.nc", system=shown, dataset=datasets
            ),
            path=path if number == 1 else f"{path}_page{number}",
            system="all" if len(starts) == 1 else f"{shown[0]} to {shown[-1]}",
        )
    return found


def filled(room, groups):
    """The groups with their members, which the table of the room lists.

    A further page has the members of the first.
    """
    table = Path(workflow.basedir, "workflow", f"{room}.yaml").read_text()
    for name, entry in yaml.safe_load(table).items():
        for group in entry["of"]:
            for page in groups:
                if page == group or re.fullmatch(rf"{group}_\d+", page):
                    groups[page].members[name] = entry
    return groups


def figure_settings(group):
    """The resolution, and each figure of a group with the settings that it alone needs, as JSON."""
    figures = [
        (
            name,
            {
                key.rpartition(".")[2]: reduce(getitem, key.split("."), config)
                for key in entry.get("settings", [])
            },
        )
        for name, entry in group.members.items()
    ]
    resolution = config["figures"]["resolution"]
    return json.dumps({"resolution": resolution, "figures": figures})
