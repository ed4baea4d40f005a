"""Random schedules, drawn by hypothesis."""

from dataclasses import replace

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from benchmarks.faults.plain_module import ReadBack
from benchmarks.faults.schedule import DeviceFault, HostFault, LinkFault, Schedule

ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGKILL")
STOPPING = ("SIGSTOP", "SIGTSTP")
FROM_TERMINAL = ("SIGINT", "SIGQUIT", "SIGHUP", "SIGTSTP")  # these go to the whole group
EXCEPTIONS = (4, 5, 6, 10, 11)


def _times(longest: float) -> st.SearchStrategy[float]:
    return st.integers(0, round(longest * 20)).map(lambda twentieth: twentieth / 20)


def link_faults(duration: float, longest: float) -> st.SearchStrategy[LinkFault]:
    """Return faults of the network and the gateway, of at most ``longest`` s."""
    start = _times(duration + 0.7)
    length = _times(longest).map(lambda seconds: max(seconds, 0.1))
    return st.one_of(
        st.builds(LinkFault, st.just("hold"), start, length),
        st.builds(LinkFault, st.just("exception"), start, length, st.sampled_from(EXCEPTIONS),
                  st.booleans()),
        st.builds(LinkFault, st.just("cut"), start, length, executed=st.booleans()),
        st.builds(LinkFault, st.just("refuse"), start, length),
        st.builds(LinkFault, st.just("delay"), start, length, st.integers(10, 400)),
        st.builds(LinkFault, st.sampled_from(["drop", "half_open"]), start),
    )  # fmt: skip


def host_faults(duration: float, longest: float) -> st.SearchStrategy[HostFault]:
    """Return signals, a slow or full disk and a stepped clock."""
    start = _times(duration + 0.5)
    length = _times(longest).map(lambda seconds: max(seconds, 0.1))

    def signals(names: tuple[str, ...], length: st.SearchStrategy[float]):  # type: ignore[no-untyped-def]
        return st.one_of(
            st.builds(HostFault, st.just("signal"), start, length, st.sampled_from(names)),
            st.builds(HostFault, st.just("signal"), start, length,
                      st.sampled_from([n for n in names if n in FROM_TERMINAL]), st.just(True)),
        )  # fmt: skip

    return st.one_of(
        signals(ENDING, st.just(0.0)),
        signals(STOPPING, length),
        st.builds(HostFault, st.sampled_from(["slow_sync", "full_disk"]), start, length),
        st.builds(HostFault, st.just("clock_step"), start, step=st.sampled_from([-3600.0, 3600.0])),
    )  # fmt: skip


def read_backs() -> st.SearchStrategy[ReadBack]:
    """Return true read-backs, and those wrong in each way, by little and by much."""
    return st.one_of(
        st.just(ReadBack()),
        st.builds(ReadBack, st.just("stuck"), st.sampled_from([0.0, 1.0, 2.0])),
        st.builds(ReadBack, st.just("clamped"), st.sampled_from([1.0, 2.0, 3.0])),
        st.builds(ReadBack, st.just("scaled"), st.sampled_from([0.001, 0.5, 0.9, 1.02, 2.0])),
        st.builds(ReadBack, st.just("offset"), st.sampled_from([0.01, 0.05, 0.3])),
        st.builds(ReadBack, st.just("noisy"), st.sampled_from([0.005, 0.02, 0.3])),
    )


def _seldom(wrong: st.SearchStrategy[ReadBack]) -> st.SearchStrategy[ReadBack]:
    """Return a wrong read-back in one of four runs: it ends most of them at the first ramp."""
    return st.integers(0, 3).flatmap(lambda n: wrong if n == 3 else st.just(ReadBack()))


def schedules(victim: str, duration: float, longest: float) -> st.SearchStrategy[Schedule]:
    """Return runs of ``duration`` s with none to five faults, of at most ``longest`` s each."""
    plain = victim == "plain"
    return st.builds(
        Schedule,
        victim=st.just(victim),
        mode=st.just("polled") if plain else st.sampled_from(["polled", "buffered"]),
        duration=st.just(duration),
        seed=st.integers(1, 1000),
        quarantine=st.just(longest + 0.5),
        both=st.booleans(),
        stuck_terminal=st.integers(0, 9).map(lambda n: n == 9),
        as_command=st.integers(0, 19).map(lambda n: n == 19),
        read_back=_seldom(read_backs()) if plain else st.just(ReadBack()),
        safety=st.booleans() if plain else st.just(False),
        link=st.lists(link_faults(duration, longest), max_size=2).map(tuple),
        host=st.lists(host_faults(duration, longest), max_size=1).map(tuple),
    ).flatmap(lambda schedule: _with_device_fault(schedule, duration))


def _with_device_fault(schedule: Schedule, duration: float) -> st.SearchStrategy[Schedule]:
    """Let something behind the module fail in half of the runs that watch it."""
    if not schedule.safety:
        return st.just(schedule)
    kinds = st.sampled_from(["none", "none", "none", "interlock", "current", "monitor"])
    fault = st.builds(DeviceFault, kinds, _times(duration))
    return fault.map(lambda f: schedule if f.kind == "none" else replace(schedule, device=(f,)))


def draw(
    victim: str, count: int, number: int, longest: float, duration: float = 2.5
) -> list[Schedule]:
    """Return ``count`` schedules; the same for the same seed ``number``."""
    drawn: list[Schedule] = []

    @seed(number)
    @settings(
        max_examples=count, phases=[Phase.generate], database=None, deadline=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(schedules(victim, duration, longest))
    def collect(schedule: Schedule) -> None:
        drawn.append(schedule)

    collect()
    return drawn[:count]
