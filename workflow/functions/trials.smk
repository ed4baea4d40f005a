def every_batch(pattern):
    """The file ``pattern`` of each batch of a set's campaign."""

    def resolve(wildcards):
        starts = range(0, COUNT, BATCH)
        ends = [min(first + BATCH, COUNT) - 1 for first in starts]
        return expand(
            f"results/trials/{{set}}/{{first:04d}}-{{last:04d}}/{pattern}",
            zip,
            set=[trial_set(wildcards)] * len(ends),
            first=starts,
            last=ends,
        )

    return resolve


def trial_set(wildcards):
    """The set of a file: the reporting set's results carry no suffix, the tuning set's do."""
    return wildcards.get("set") or wildcards.suffix.lstrip("_") or "reporting"


def trial_results(suffix):
    """Every figure and table of a set."""
    return expand(
        "results/figures/trials_{name}{suffix}.{kind}",
        name=["confusion", "risk_coverage", "strength", "gap"],
        suffix=suffix,
        kind=["png", "pdf"],
    ) + expand(
        "results/tables/{name}{suffix}.{kind}",
        name=["trials", "trials_effects"],
        suffix=suffix,
        kind=["csv", "md", "tex"],
    )


def scores_of(wildcards):
    return f"results/trials/{trial_set(wildcards)}/scores.nc"
