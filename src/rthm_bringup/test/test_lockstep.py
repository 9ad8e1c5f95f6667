"""Parts in granted windows do what the schedule says, in whatever order they are served."""

from __future__ import annotations

import random
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from rthm_bringup.run.lockstep import HELD, LockStep
from rthm_core.clock import NS, Rank
from rthm_core.link import Inbox, Link
from rthm_core.ros.agenda import NEVER, Agenda, Position
from rthm_core.ros.grants import NOTHING, PARTS, SOURCES, Done, Grant
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec, parameters, shipped_spec, spec_from_parameters

UNTIL = NS // 10
PAPER = {entry.name: entry.value for entry in parameters(shipped_spec("paper"))}
STATE, _, REFERENCE, COMMAND = SOURCES

PERIODS = st.sampled_from([0.0012, 0.002, 0.0031, 0.004, 0.005, 0.012, 0.0170003])
DELAYS = st.sampled_from([0.0, 0.0003, 0.0012, 0.004, 0.0081, 0.012, 0.0365])


@st.composite
def specs(draw: st.DrawFn) -> Spec:
    timing = {f"timing.{name}": draw(PERIODS) for name in ("td1", "td2", "td3")}
    timing |= {f"timing.tau{k}": draw(DELAYS) for k in (1, 2, 3, 4)}
    timing["timing.td4"] = draw(st.just(0.0) | PERIODS)
    effects: dict[str, Any] = {}
    for k in draw(st.sets(st.sampled_from([1, 2, 3, 4]))):
        effects |= {f"e{k}.block": f"link.tau{k}", f"e{k}.kind": "jitter", f"e{k}.std": 0.003}
    if draw(st.booleans()):
        effects |= {"lost.block": "link.tau3", "lost.kind": "loss", "lost.fraction": 0.3}
    names = {"effects": sorted({name.partition(".")[0] for name in effects})} if effects else {}
    return spec_from_parameters(PAPER | timing | effects | names)


class Sender:
    """A part without physics: it sends its clock, and notes which sample it uses when."""

    def __init__(self, name: str) -> None:
        self.name, self.agenda, self.sent = name, Agenda(UNTIL), dict.fromkeys(SOURCES, 0)
        self.listeners: list[tuple[str, list[int]]] = []
        self.inboxes: dict[str, tuple[Inbox, Link, list[int]]] = {}
        self.notes: list[tuple[int, ...]] = []

    def hear(self, topic: str, link: Link, *senders: Sender) -> Inbox:
        on_the_way: list[int] = []
        self.inboxes[topic] = (Inbox(), link, on_the_way)
        for sender in senders:
            sender.listeners.append((topic, on_the_way))
        return self.inboxes[topic][0]

    def send(self, topic: str, at: int) -> None:
        self.sent[topic] += 1
        for heard, on_the_way in self.listeners:
            if heard == topic:
                on_the_way.append(at)

    def work(self, grant: Grant, chance: random.Random) -> Done:
        for topic, (inbox, link, on_the_way) in self.inboxes.items():
            granted = grant.messages[SOURCES.index(topic)] - inbox.received
            taken = [on_the_way.pop(0) for _ in range(chance.randint(granted, len(on_the_way)))]
            for stamp in taken:
                inbox.push(stamp, link.due(stamp), stamp)
            inbox.received += len(taken)
        while self.agenda.next() < grant.bound:
            self.agenda.run(0)
        return self.done(grant.round)

    def done(self, round_: int) -> Done:
        return Done(PARTS.index(self.name), round_, self.agenda.next(), tuple(self.sent.values()))


def loop_of(spec: Spec) -> list[Sender]:
    """Plant, numerical substructure and controller, as their nodes use their agendas."""
    timing = spec.loop().timing
    links = {name: Link(spec, name) for name in ("tau1", "tau2", "tau3", "tau4")}
    plant, numerical, actuator = Sender("plant"), Sender("numerical"), Sender("actuator")
    td3, td4 = timing.ns("td3"), timing.ns("td4")
    held = {STATE: -1, REFERENCE: -1}

    def newest(part: Sender, topic: str, at: int, known: int) -> int:
        taken = part.inboxes[topic][0].take(at)
        return known if taken is None else taken[0]

    def motor(at: int, now: int) -> None:
        taken = commands.take(at)
        if taken:
            plant.notes.append((at, taken[0], plant.sent[STATE]))

    def update(at: int, now: int) -> None:
        update.held = newest(numerical, STATE, at, update.held)
        numerical.notes.append((at, update.held))
        numerical.send(REFERENCE, at)

    def command(at: int) -> None:
        actuator.notes.append((at, held[STATE], held[REFERENCE]))
        actuator.send(COMMAND, at)

    def control(at: int, now: int) -> None:
        held[STATE] = newest(actuator, STATE, at, held[STATE])
        command(at)

    def reference(at: int, now: int) -> None:
        before = held[REFERENCE]
        held[REFERENCE] = newest(actuator, REFERENCE, at, before)
        if at % td3 and (td4 or held[REFERENCE] != before):
            command(at)

    update.held = -1
    early = not td4 and links["tau3"].delay_ns > 0
    commands = plant.hear(COMMAND, links["tau4"], actuator)
    plant.agenda.when_due(commands, motor, lambda t: Rank.DELAY if early and t % td3 else Rank.CONTROL)
    plant.agenda.every("Td1", timing.ns("td1"), Rank.SAMPLE, lambda at, now: plant.send(STATE, at))
    numerical.hear(STATE, links["tau2"], plant)
    numerical.agenda.every("Td2", timing.ns("td2"), Rank.NUMERICAL, update)
    actuator.hear(STATE, links["tau1"], plant)
    references = actuator.hear(REFERENCE, links["tau3"], numerical)
    if td4:
        actuator.agenda.every("Td4", td4, Rank.CONTROL, reference)
    else:
        actuator.agenda.when_due(references, reference, lambda stamp: Rank.NUMERICAL)
    actuator.agenda.every("Td3", td3, Rank.CONTROL, control)
    for part in (plant, numerical, actuator):
        for inbox, _, _ in part.inboxes.values():
            inbox.received = 0
    return [plant, numerical, actuator]


def run(spec: Spec, seed: int, observers: list[str]) -> tuple[list[Sender], LockStep]:
    """Serve the parts in a random order until nothing is left to do."""
    chance = random.Random(seed)
    step, parts = LockStep(spec, UNTIL, observers), {part.name: part for part in loop_of(spec)}
    for name in observers:
        step.hear(Done(PARTS.index(name), 0, Position(NEVER, 0), NOTHING))
    for part in parts.values():
        step.hear(part.done(0))
    waiting = step.advance()
    while waiting:
        name = chance.choice(sorted(waiting))
        grant = waiting.pop(name)
        if name in observers:
            behind = max(sum(part.sent[topic] for part in parts.values()) for topic in SOURCES)
            assert behind - max(grant.messages) <= 4 * HELD
            step.hear(Done(PARTS.index(name), grant.round, Position(NEVER, 0), NOTHING))
        else:
            step.hear(parts[name].work(grant, chance))
        waiting |= step.advance()
    return list(parts.values()), step


@settings(max_examples=60, deadline=None)
@given(specs(), st.integers(0, 1000), st.sampled_from([[], ["recorder"]]))
def test_every_part_uses_the_samples_of_the_schedule(spec: Spec, seed: int, observers: list[str]) -> None:
    (plant, numerical, actuator), step = run(spec, seed, observers)
    assert step.finished
    schedule = Schedule(spec)
    numbers, states = schedule.references(0, UNTIL + 1)
    assert numerical.notes == [
        (int(k) * schedule.td2, max(int(sample) * schedule.td1, -1))
        for k, sample in zip(numbers, states, strict=True)
    ]
    commands = schedule.commands(0, UNTIL + 1)
    assert actuator.notes == [
        (int(at), max(int(s) * schedule.td1, -1), max(int(r) * schedule.td2, -1))
        for at, s, r in zip(commands.time, commands.state, commands.reference, strict=True)
    ]
    due, arriving = schedule.arrivals(0, UNTIL + 1)
    used = [(at, stamp) for at, stamp, _ in plant.notes]
    assert used == [(int(at), int(stamp)) for at, stamp in zip(due, arriving.time, strict=True)]
    assert plant.sent[STATE] == UNTIL // schedule.td1 + 1


def test_a_command_without_delay_reaches_the_motor_after_the_sample_of_its_instant() -> None:
    spec = spec_from_parameters(PAPER | {"timing.tau4": 0.0})
    (plant, _, _), _ = run(spec, 1, [])
    assert all(samples == at // 1_200_000 + 1 for at, _, samples in plant.notes)


def test_a_command_whose_delay_is_over_reaches_the_motor_before_the_sample_of_its_instant() -> None:
    spec = spec_from_parameters(PAPER | {"timing.tau4": 0.0012})
    (plant, _, _), _ = run(spec, 1, [])
    together = [(at, samples) for at, _, samples in plant.notes if at % 1_200_000 == 0]
    assert together
    assert all(samples == at // 1_200_000 for at, samples in together)


def test_windows_of_the_paper_are_as_long_as_the_loop_is() -> None:
    step = LockStep(shipped_spec("paper"), NS)
    for part in loop_of(shipped_spec("paper")):
        step.hear(part.done(0))
    grants = step.advance()
    assert {name: grant.bound.at for name, grant in grants.items()} == {
        "plant": 10_000_000,
        "numerical": 8_000_000,
        "actuator": 4_000_000,
    }
    assert step.advance() == {}
    assert not step.finished


def test_nothing_is_granted_before_everybody_has_greeted() -> None:
    step = LockStep(shipped_spec("paper"), NS, ["recorder"])
    for part in loop_of(shipped_spec("paper")):
        step.hear(part.done(0))
    assert step.advance() == {}
    assert list(step.silent()) == ["recorder"]


def test_time_stands_still_once_an_observer_holds_what_was_sent() -> None:
    step, parts = LockStep(shipped_spec("paper"), NS, ["recorder"]), loop_of(shipped_spec("paper"))
    recorder = PARTS.index("recorder")
    step.hear(Done(recorder, 0, Position(NEVER, 0), NOTHING))
    for part in parts:
        step.hear(part.done(0))
    grants = step.advance()
    step.stopping = True
    assert not step.settled
    chance = random.Random(1)
    for part in parts:
        step.hear(part.work(grants[part.name], chance))
    told = step.advance()
    assert list(told) == ["recorder"]  # a few samples that it lacks are enough, and nobody else goes on
    assert told["recorder"].messages == tuple(sum(part.sent[topic] for part in parts) for topic in SOURCES)
    assert not step.settled
    step.hear(Done(recorder, told["recorder"].round, Position(NEVER, 0), NOTHING))
    assert step.settled
    assert step.advance() == {}
    assert not step.finished
