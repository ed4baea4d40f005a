"""The judge of the fault campaign (``make faults`` runs it): its laws, its device and its proxy."""

import asyncio
import struct
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from benchmarks.faults import laws
from benchmarks.faults.campaign import Campaign
from benchmarks.faults.client import Client, processes
from benchmarks.faults.examples import examples
from benchmarks.faults.modbus_frame import Frame, read_frame
from benchmarks.faults.plain_module import PlainModule, ReadBack, tag, to_counts
from benchmarks.faults.proxy import FaultProxy
from benchmarks.faults.run import Outcome, _tripping
from benchmarks.faults.schedule import DeviceFault, HostFault, LinkFault, Schedule, loads
from benchmarks.faults.strategies import draw
from benchmarks.faults.trace import Applied, Trace
from benchmarks.faults.verdicts import Verdict, Verdicts

RATE = 50
PLAN = Schedule("plain", low=1.0, high=3.0, duration=1.0)


def ran(tmp_path, volts, schedule=PLAN, status=0, watched=12.0, recorded=True):
    """Return the outcome of a run that applied ``volts`` sample by sample, from time 0 on."""
    applied = [
        Applied(k / RATE, float(v), to_counts(v), tag(k), k) for k, v in enumerate(volts, start=0)
    ]
    requests = [(entry.time, {0: entry.counts}) for entry in applied]
    end = len(volts) / RATE
    if recorded:
        wanted = round(schedule.duration * RATE)
        first = next(k for k, v in enumerate(volts) if v >= schedule.low)
        played = applied[first : first + wanted]
        write(tmp_path, [a.volts for a in played], [a.displacement for a in played])
    return Outcome(
        schedule=schedule, trace=Trace(applied), folder=tmp_path, requests=requests, origin=0.0,
        exit_time=end, status=status, over=end, until=end + watched,
    )  # fmt: skip


def write(tmp_path, volts, tags, quality=None):
    quality = np.zeros(len(volts), np.uint8) if quality is None else quality
    variables = {"voltage": volts, "displacement_counts": tags, "quality": quality}
    xr.Dataset({name: ("time", np.asarray(v)) for name, v in variables.items()}).to_netcdf(
        tmp_path / "record.nc"
    )


def plan(end=0.0):
    """Return a ramp to 1 V, a second of 1 to 1.98 V, and the ramp to ``end``."""
    return np.concatenate(
        [np.linspace(0, 1, 6)[:-1], 1 + np.arange(RATE) / RATE, np.linspace(1.98, end, 12)]
    )


def test_a_run_without_fault_breaks_no_law(tmp_path):
    assert laws.broken(ran(tmp_path, plan())) == []


def test_a_voltage_that_stays_on_is_noticed(tmp_path):
    broken = laws.broken(ran(tmp_path, plan(end=0.4)))
    assert {sentence.split(":")[0] for sentence in broken} == {
        "not zero in time", "driven after exit",
    }  # fmt: skip


def test_a_late_write_after_the_end_is_noticed(tmp_path):
    outcome = ran(tmp_path, plan())
    outcome.trace.applied.append(Applied(outcome.over + 3, 1.5, to_counts(1.5), 0, 0))
    outcome.trace.applied.append(Applied(outcome.over + 3.1, 0.0, 0, 0, 0))
    (sentence,) = laws.broken(outcome)
    assert sentence.startswith("driven after exit: 1.50 V from 3.0 s")


def test_a_killed_command_must_leave_zero_behind_as_well(tmp_path):
    killed = HostFault("signal", 0.5, signal="SIGKILL")
    schedule = Schedule("plain", low=1.0, high=3.0, duration=1.0, host=(killed,))
    outcome = ran(tmp_path, plan()[:30], schedule, status=-9)
    assert any(sentence.startswith("not zero in time") for sentence in laws.broken(outcome))


@pytest.mark.parametrize(("length", "noticed"), [(1.0, False), (12.0, True)])
def test_a_voltage_held_through_a_long_stop_is_noticed(tmp_path, length, noticed):
    stop = HostFault("signal", 0.5, length, signal="SIGSTOP")
    schedule = Schedule("plain", low=1.0, high=3.0, duration=1.0, host=(stop,))
    outcome = ran(tmp_path, plan(), schedule)
    at = 30
    later = [
        Applied(e.time + length * (k >= at), e.volts, e.counts, e.displacement, e.index)
        for k, e in enumerate(outcome.trace.applied)
    ]
    outcome.trace.applied[:] = later
    outcome.exit_time += length
    outcome.over += length
    outcome.until += length
    found = [s for s in laws.broken(outcome) if s.startswith("not zero in time")]
    assert bool(found) == noticed


def test_while_the_network_is_down_nothing_is_asked_for(tmp_path):
    cut = LinkFault("cut", 0.5, 9.0)
    schedule = Schedule("plain", low=1.0, high=3.0, duration=1.0, link=(cut,))
    outcome = ran(tmp_path, plan()[:30], schedule, status=1, watched=30.0)
    outcome.exit_time = outcome.over = 10.0
    outcome.trace.applied.append(Applied(9.9, 0.0, 0, 0, 0))
    assert laws.broken(outcome) == []


def test_a_burst_is_beyond_the_rate(tmp_path):
    outcome = ran(tmp_path, plan())
    outcome.requests[40:52] = [(0.8 + 0.001 * k, {0: to_counts(0.2 * k)}) for k in range(12)]
    assert any(sentence.startswith("beyond rate") for sentence in laws.broken(outcome))


def test_a_voltage_above_the_plan_is_beyond_range(tmp_path):
    volts = plan()
    volts[30] = 3.2
    found = laws.broken(ran(tmp_path, volts))
    assert any(sentence.startswith("beyond range") for sentence in found)


@pytest.mark.parametrize("flagged", [False, True])
def test_a_wrong_sample_is_noticed_unless_it_is_flagged(tmp_path, flagged):
    outcome = ran(tmp_path, plan(), recorded=False)
    volts, tags = 1 + np.arange(RATE) / RATE, [tag(5 + k) for k in range(RATE)]
    volts[7] += 0.01
    quality = np.zeros(RATE, np.uint8)
    quality[7] = 4 * flagged
    write(tmp_path, volts, tags, quality)
    found = laws.broken(outcome)
    assert found == [] if flagged else "wrong samples of quality 0: 1 of 50" in found[0]


def test_a_record_that_is_gone_is_noticed(tmp_path):
    (sentence,) = laws.broken(ran(tmp_path, plan(), recorded=False))
    assert sentence.startswith("record lost: 0 of 50")


def test_samples_held_beside_those_of_the_plan_stand_for_none_of_them(tmp_path):
    volts, tags = 1 + np.arange(RATE) / RATE, [tag(5 + k) for k in range(RATE)]
    outcome = ran(tmp_path, plan(), recorded=False)
    quality = np.zeros(RATE, np.uint8)
    quality[7] = laws.HELD
    write(tmp_path, volts, tags, quality)
    (sentence,) = laws.broken(outcome)
    assert sentence.startswith("record lost: 49 of 50")


@pytest.mark.parametrize(("mode", "lost"), [("buffered", False), ("polled", True)])
def test_what_a_buffer_plays_until_the_link_is_back_is_not_missed(tmp_path, mode, lost):
    down = LinkFault("exception", 0.6, 2.1, code=4)
    schedule = replace(PLAN, duration=3.0, mode=mode, link=(down,))
    volts = np.concatenate([np.linspace(0, 1, 6)[:-1], 1 + np.arange(150) / 100, np.zeros(1)])
    outcome = ran(tmp_path, volts, schedule, status=1, recorded=False)
    write(tmp_path, 1 + np.arange(20) / RATE, [tag(5 + k) for k in range(20)])
    found = [sentence for sentence in laws.broken(outcome) if sentence.startswith("record lost")]
    assert bool(found) == lost


@pytest.mark.parametrize("held", [0, 200])
def test_samples_that_a_killed_recorder_leaves_out_are_noticed(tmp_path, held):
    schedule = Schedule("plain", low=1.0, high=3.0, duration=3.0)
    volts = np.concatenate([np.linspace(0, 1, 6)[:-1], 1 + np.arange(150) / 100, np.zeros(1)])
    outcome = ran(tmp_path, volts, schedule, status=-9, recorded=False)
    left = np.append(volts[5:20], np.full(held, volts[19]))
    quality = np.repeat([0, laws.HELD], [15, held]).astype(np.uint8)
    write(tmp_path, left, [tag(k) for k in range(5, 5 + left.size)], quality)
    found = [sentence for sentence in laws.broken(outcome) if sentence.startswith("record lost")]
    assert found


def test_a_process_that_stays_is_noticed(tmp_path):
    outcome = ran(tmp_path, plan())
    outcome.left = [1]
    (sentence,) = laws.broken(outcome)
    assert sentence.startswith("does not end")


def request(pdu):
    return Frame(7, 1, pdu)


def write_output(counts):
    return request(struct.pack(">BHH", 6, 0, counts))


def test_the_module_obeys_and_names_each_write_by_its_displacement():
    module = PlainModule(ReadBack(), seed=1)
    assert module.answer(write_output(1000).pdu) == struct.pack(">BHH", 6, 0, 1000)
    both = struct.pack(">BHHHHBH", 23, 0, 1, 0, 1, 2, 2000)
    assert module.answer(both) == struct.pack(">BBH", 23, 2, 2000)
    several = struct.pack(">BHHBH", 16, 0, 1, 2, 3000)
    assert module.answer(several) == struct.pack(">BHH", 16, 0, 1)
    assert module.answer(struct.pack(">BHH", 4, 0, 2)) == struct.pack(">BBHH", 4, 4, tag(3), 3000)
    assert [a.counts for a in module.trace.applied] == [1000, 2000, 3000]
    assert module.answer(struct.pack(">BHH", 3, 5, 1)) == bytes([0x83, 2])
    assert module.answer(b"\x07") == bytes([0x87, 1])


@pytest.mark.parametrize(
    ("lie", "applied", "read"),
    [
        (ReadBack("clamped", 1.0), to_counts(1.0), to_counts(1.0)),
        (ReadBack("stuck", 0.0), to_counts(2.0), 0),
        (ReadBack("scaled", 0.5), to_counts(2.0), to_counts(1.0)),
        (ReadBack("offset", 0.5), to_counts(2.0), to_counts(2.5)),
    ],
)
def test_only_a_clamp_changes_what_is_put_out(lie, applied, read):
    module = PlainModule(lie, seed=1)
    module.answer(write_output(to_counts(2.0)).pdu)
    assert module.trace.applied[-1].counts == applied
    (value,) = struct.unpack(">H", module.answer(struct.pack(">BHH", 4, 1, 1))[2:])
    assert abs(value - read) <= 1


def through_proxy(*faults, wait, then=()):
    """Return the reply to a write, and what the module then has put out."""

    async def talk():
        module = PlainModule(ReadBack(), seed=1)
        proxy = FaultProxy(await module.start(), faults, lambda: None)
        port = await proxy.start()
        try:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(write_output(1000).encode())
            try:
                reply = await asyncio.wait_for(read_frame(reader), wait)
            except TimeoutError:
                reply = "none"
            writer.close()
            await asyncio.sleep(0.5)
            return reply, [a.counts for a in module.trace.applied]
        finally:
            await proxy.stop()
            await module.stop()

    return asyncio.run(talk())


def test_the_proxy_delivers_a_held_write_though_the_client_has_left():
    assert through_proxy(LinkFault("hold", 0.0, 0.3), wait=0.1) == ("none", [0, 1000])


@pytest.mark.parametrize("executed", [False, True])
def test_the_proxy_refuses_with_the_code_asked_for(executed):
    fault = LinkFault("exception", 0.0, 1.0, code=6, executed=executed)
    reply, applied = through_proxy(fault, wait=1)
    assert reply.pdu == bytes([0x86, 6])
    assert applied == ([0, 1000] if executed else [0])


@pytest.mark.parametrize("executed", [False, True])
def test_a_cut_link_loses_frames_or_delivers_them_late(executed):
    fault = LinkFault("cut", 0.0, 0.3, executed=executed)
    expected = [0, 1000] if executed else [0]
    assert through_proxy(fault, wait=0.1) == ("none", expected)


def test_the_module_answers_its_safety_registers():
    module = PlainModule(ReadBack(), seed=1)
    ask = struct.Struct(">BHH").pack
    module.answer(write_output(1000).pdu)
    assert module.answer(ask(2, 0, 1)) == bytes([2, 1, 1])
    assert module.answer(ask(4, 2, 1)) == struct.pack(">BBH", 4, 2, 0)
    assert module.answer(ask(5, 0, 0xFF00)) == ask(5, 0, 0xFF00)
    assert module.answer(ask(1, 0, 1)) == bytes([1, 1, 1])
    assert module.answer(ask(4, 2, 1)) == struct.pack(">BBH", 4, 2, 800)
    module.faults |= {"interlock", "monitor", "current"}
    assert module.answer(ask(2, 0, 1)) == bytes([2, 1, 0])
    assert module.answer(ask(4, 2, 2)) == struct.pack(">BBHH", 4, 4, 400, to_counts(2.0))


def test_a_trip_that_does_not_latch_is_noticed(tmp_path):
    opened = DeviceFault("interlock", 0.5)
    schedule = Schedule("plain", low=1.0, high=3.0, duration=1.0, safety=True, device=(opened,))
    outcome = ran(tmp_path, plan(), schedule)
    outcome.again = 1
    assert laws.broken(outcome) == []
    outcome.again = 0
    (sentence,) = laws.broken(outcome)
    assert sentence.startswith("does not latch")
    outcome.again, outcome.driven_again = 1, True
    (sentence,) = laws.broken(outcome)
    assert sentence.startswith("does not latch")


@pytest.mark.parametrize(("begins", "expected"), [(0.5, True), (0.95, False), (1.5, False)])
def test_a_trip_is_expected_where_the_output_is_on_during_a_fault(begins, expected):
    volts = [0.0, *[1.0] * 50, *[0.0] * 50, 2.4, 0.0]  # a late write drives it for a sample
    trace = Trace([Applied(k / RATE, v, to_counts(v), 0, 0) for k, v in enumerate(volts)])
    schedule = Schedule("plain", safety=True, device=(DeviceFault("monitor", begins),))
    assert _tripping(schedule, trace, 0.0, until=5.0) == expected
    cut = replace(schedule, link=(LinkFault("cut", begins + 0.05, 1.0),))
    assert not _tripping(cut, trace, 0.0, until=5.0)


def test_what_a_second_run_drives_is_judged_apart():
    trace = Trace([Applied(t, v, 0, 0, 0) for t, v in ((0.0, 1.0), (1.0, 0.0), (3.0, 2.0))])
    assert trace.before(2.0).spans(2.0) == [(0.0, 1.0, 1.0), (1.0, 2.0, 0.0)]
    assert trace.driven(4.0) == [(0.0, 1.0), (3.0, 4.0)]


def test_schedules_are_the_same_for_the_same_seed_and_can_be_run_again():
    drawn = draw("plain", 20, 5, 2.0)
    assert drawn == draw("plain", 20, 5, 2.0)
    assert len(drawn) == 20
    for schedule in [*drawn, *examples().values()]:
        assert loads(schedule.dumps()) == schedule


def test_the_processes_of_a_run_are_found_by_their_mark(tmp_path):
    async def start():
        client = Client(tmp_path, 1)
        environment = client.environment() | {"PATH": "/usr/bin:/bin"}
        process = await asyncio.create_subprocess_exec("sleep", "60", env=environment)
        await asyncio.sleep(0.1)
        found = processes(client)
        process.kill()
        await process.wait()
        return found == [process.pid], processes(client)

    assert asyncio.run(start()) == (True, [])


@pytest.mark.parametrize(
    ("victim", "share"),
    [("plain", 1 / 10), pytest.param("bench", 1 / 2, marks=pytest.mark.campaign)],
)
def test_the_command_keeps_the_laws_whatever_fails(victim, share, request):
    """Short plans, short faults, many at a time; ``make faults`` takes its time."""
    count = int(share * request.config.getoption("--fault-schedules"))
    schedules = draw(victim, count, number=1, longest=1.0, duration=1.0)
    verdicts = Campaign(at_a_time=16).judge(schedules)
    # Alone once more: beside other tests the host may keep a guardian waiting, not the judge.
    again = Campaign(at_a_time=1).judge([v.schedule for v in verdicts if v.broken])
    broken = [(v.schedule.dumps(), *v.broken) for v in again if v.broken]
    assert not broken, "\n".join(map(str, broken))
    assert sum(v.driven for v in verdicts) > 0.7 * count


def test_a_campaign_goes_on_from_the_verdicts_on_its_own_commit(tmp_path, monkeypatch):
    first, second = draw("plain", 2, 5, 2.0)
    verdict = Verdict(PLAN, ("zero within T: 1 V",), 1, driven=True)
    file = tmp_path / "plain" / "verdicts.jsonl"

    def kept(commit):
        monkeypatch.setattr("benchmarks.faults.verdicts.commit", lambda: commit)
        return Verdicts(file)

    kept("a").add(first, verdict)
    assert kept("a").on(first) == verdict
    assert kept("a").on(second) is None
    assert kept("b").on(first) is None
    kept("c-dirty").add(second, verdict)
    assert kept("c-dirty").on(second) is None


def test_what_a_broken_run_leaves_is_kept_beside_that_of_earlier_runs(tmp_path, monkeypatch):
    keep = tmp_path / "keep"
    (keep / "0001").mkdir(parents=True)
    (keep / "0001" / "broken").write_text("of the run before the interruption")
    (keep / "verdicts.jsonl").touch()

    async def without_record(schedule, number, folder, launcher, bench):
        folder.mkdir()
        return ran(folder, plan(), schedule, recorded=False)

    monkeypatch.setattr("benchmarks.faults.campaign.run", without_record)
    asyncio.run(Campaign(keep=keep)._once(PLAN, tmp_path))
    assert (keep / "0001" / "broken").read_text() == "of the run before the interruption"
    assert (keep / "0002" / "broken").read_text().startswith("record lost: 0 of 50")
