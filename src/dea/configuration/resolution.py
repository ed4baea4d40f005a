"""How an open diagnosis is resolved by further records: ``resolution`` of config/config.yaml."""

from dea.configuration.section import Count, Duration, NotNegative, Number, Positive, Section, key


class Resolution(Section):
    """Designed records that leave one explanation (docs/discrepancy.md)."""

    records: Count = key("designed records at most", default=3)
    first: Count = key(
        "samples of the first record that are begun from, at most: a longer one takes longer to"
        " diagnose, and the small errors of its laws outweigh what a short one tells",
        default=6000,
    )
    duration: Duration = key("longest duration of one", unit="s", default=120.0)
    level: Number = key(
        "probability at which the right explanation may be rejected, over all records together",
        default=0.01,
        gt=0,
        lt=1,
    )
    another: Number = key(
        "prior probability of an explanation that is not offered", default=0.1, gt=0, lt=1
    )
    rate: Positive | None = key(
        "largest change of the input per s; the device description's `safety.max_rate` holds too,"
        " and where neither is given, that of the first record",
        default=None,
    )
    output_margin: NotNegative = key(
        "how far a predicted output may leave the range of the first records, as a part of it",
        default=0.1,
    )
