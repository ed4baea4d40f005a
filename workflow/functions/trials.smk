def every_batch(pattern):
    """The file ``pattern`` of each batch of a set's campaign."""

    def resolve(wildcards):
        batch = TRIALS["batch"]
        starts = NUMBERS[::batch]
        ends = [min(first + batch, NUMBERS.stop) - 1 for first in starts]
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


def trial_results():
    """Every figure and table of the campaign's set."""
    suffix = "" if TRIALS["set"] == "reporting" else f"_{TRIALS['set']}"
    return FIGURES["trials"].files("png", "pdf", suffix=suffix) + TABLES[
        "trials"
    ].files("csv", "md", "tex", suffix=suffix)


def scores_of(wildcards):
    return f"results/trials/{trial_set(wildcards)}/scores.nc"
