"""The loop as a drawing: what is where, which way things flow, and how old they are when they are used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.timing import TimingResult

if TYPE_CHECKING:
    from rthm_core.spec import Spec

WIDTH, HEIGHT = 1120, 348
BLOCK_WIDTH, BLOCK_HEIGHT = 204, 84
LABEL_WIDTH, LABEL_HEIGHT = 130, 62

PLACES = {
    "motor": (8, 16),
    "plant": (272, 16),
    "sampling": (550, 16),
    "numerical": (908, 16),
    "controller": (272, 236),
}
"""Left upper corners of the blocks."""

ARROWS = {
    "force": (((212, 58), (272, 58)), None),
    "motion": (((476, 58), (550, 58)), None),
    "tau2": (((754, 58), (908, 58)), (829, 58)),
    "tau1": (((652, 100), (652, 258), (476, 258)), (652, 178)),
    "tau3": (((1010, 100), (1010, 300), (476, 300)), (1010, 200)),
    "tau4": (((272, 278), (110, 278), (110, 100)), (110, 190)),
}
"""Way of each signal, and where the label of a link is."""

BESIDE = {PLACES["motor"]: (10, 0, "start"), PLACES["sampling"]: (-10, 17, "end")}
"""Where the words on a block stand beside the arrow beneath it: distances and anchor."""

SIGNALS = ((242, 48, "F"), (512, 48, "x_1, v_1"), (560, 250, "x_1"), (740, 292, "F_d"), (204, 270, "u_d"))
"""Names of the signals, and where they stand."""


PLANT_PLACES = {"force": (8, 16), "plant": (320, 16), "sampling": (632, 16)}
"""Left upper corners of the blocks of a plant alone."""


@dataclass(frozen=True)
class Mark:
    """Words beneath a block or a link, and whether it stands in the foreground."""

    words: str
    located: bool


def draw_loop(spec: Spec, timing: TimingResult, marks: Mapping[str, Mark] | None = None) -> str:
    """Loop of a spec as SVG, with its delays and the ages that were measured.

    `marks` are what to say of blocks (as in `PLACES`) and links (as in `ARROWS`).
    """
    parts = [_arrow(points) for points, _ in ARROWS.values()]
    parts += [_block(key, PLACES[key], title, lines) for key, (title, lines) in _blocks(spec).items()]
    parts += [_label(name, place, spec, timing) for name, (_, place) in ARROWS.items() if place]
    parts += [_mark(*_box(key), mark) for key, mark in (marks or {}).items()]
    parts += [_word(x, y, signal) for x, y, signal in SIGNALS]
    return _svg(WIDTH, HEIGHT, "The loop with its delays", parts)


def draw_plant(spec: Spec, marks: Mapping[str, Mark]) -> str:
    """Plant under known forces as SVG, with what to say of its blocks."""
    assert spec.plant is not None
    blocks = {
        "force": ("Known forces", ["as recorded"]),
        "plant": ("Plant", [_body(spec.plant), _effects(spec, "plant")]),
        "sampling": ("Sensors", [", ".join(spec.plant.dofs)]),
    }
    parts = [_arrow(((x - 108, 58), (x, 58))) for x, _ in (PLANT_PLACES["plant"], PLANT_PLACES["sampling"])]
    parts += [_block(key, PLANT_PLACES[key], title, lines) for key, (title, lines) in blocks.items()]
    boxes = {key: (*PLANT_PLACES[key], BLOCK_WIDTH, BLOCK_HEIGHT) for key in blocks}
    parts += [_mark(*boxes[key], mark) for key, mark in marks.items() if key in boxes]
    return _svg(844, 132, "The plant and its sensors", parts)


def _svg(width: int, height: int, words: str, parts: Sequence[str]) -> str:
    return (
        f'<div class="wide"><svg class="loop" viewBox="0 0 {width} {height}" style="max-width: {width}px" '
        f'role="img" aria-label="{words}">'
        '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7"'
        f' orient="auto"><path d="M0 0 L10 5 L0 10 z" class="tip"/></marker></defs>'
        f"{''.join(parts)}</svg></div>"
    )


def _box(key: str) -> tuple[int, int, int, int]:
    """Left, top, width and height of a block or of the label of a link."""
    if key in PLACES:
        return (*PLACES[key], BLOCK_WIDTH, BLOCK_HEIGHT)
    middle = ARROWS[key][1]
    assert middle is not None
    return middle[0] - LABEL_WIDTH // 2, middle[1] - LABEL_HEIGHT // 2, LABEL_WIDTH, LABEL_HEIGHT


def _blocks(spec: Spec) -> dict[str, tuple[str, list[str]]]:
    loop = spec.loop()
    timing, actuator = loop.timing, loop.actuator
    poles = actuator.motor_poles
    motor = f"h(s): {_numbers(poles)} rad/s" if poles else "h(s) = 1"
    return {
        "motor": ("Motor and wire", [motor, f"k = {_numbers(spec.k_tot)} N/m"]),
        "plant": ("Physical substructure", [_body(loop.plant), _effects(spec, "plant")]),
        "sampling": ("Data acquisition", [f"Td1 {_ms(timing.td1)}", _noise(spec)]),
        "numerical": ("Numerical substructure", [_body(loop.numerical), f"Td2 {_ms(timing.td2)}"]),
        "controller": (
            "Controller",
            ["u_d = x_1 + F_d / k", f"Td3 {_ms(timing.td3)}, Td4 {_ms(timing.td4)}"],
        ),
    }


def _body(body: object) -> str:
    n = body.n  # type: ignore[attr-defined]
    diagonal = [
        [f"{getattr(body, name)[i * n + i]:g}" for i in range(min(n, 3))] for name in ("mass", "stiffness")
    ]
    more = " …" if n > 3 else ""
    return f"M {', '.join(diagonal[0])}{more} kg, K {', '.join(diagonal[1])}{more} N/m"


def _effects(spec: Spec, block: str) -> str:
    kinds = [effect.kind.replace("_", " ") for effect in spec.effects if effect.block == block]
    return ", ".join(kinds[:2]) + (" …" if len(kinds) > 2 else "")


def _noise(spec: Spec) -> str:
    noise = spec.noise
    return f"noise {noise.position:g} m, {noise.velocity:g} m/s" if noise.position or noise.velocity else ""


def _numbers(values: tuple[float, ...] | None) -> str:
    return ", ".join(f"{value:.4g}" for value in values or ())


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.4g} ms"


def _block(key: str, place: tuple[int, int], title: str, lines: list[str]) -> str:
    x, y = place
    middle = x + BLOCK_WIDTH / 2
    box = f'<rect x="{x}" y="{y}" width="{BLOCK_WIDTH}" height="{BLOCK_HEIGHT}" rx="10" class="block {key}"/>'
    head = f'<text x="{middle}" y="{y + 28}" class="name">{escape(title)}</text>'
    return (
        box
        + head
        + "".join(
            f'<text x="{middle}" y="{y + 50 + 18 * k}" class="detail">{_lowered(line)}</text>'
            for k, line in enumerate(lines)
            if line
        )
    )


def _mark(x: int, y: int, width: int, height: int, mark: Mark) -> str:
    """Words beneath a box, and a frame around one in the foreground."""
    frame = (
        f'<rect x="{x - 4}" y="{y - 4}" width="{width + 8}" height="{height + 8}" rx="12" class="frame"/>'
        if mark.located
        else ""
    )
    kind = "mark located" if mark.located else "mark"
    dx, dy, anchor = BESIDE.get((x, y), (0, 0, "middle"))
    place = f'x="{x + width / 2 + dx}" y="{y + height + 20 + dy}" style="text-anchor: {anchor}"'
    return f'{frame}<text {place} class="{kind}">{escape(mark.words)}</text>'


def _arrow(points: tuple[tuple[int, int], ...]) -> str:
    way = " ".join(f"{x},{y}" for x, y in points)
    return f'<polyline points="{way}" class="way" marker-end="url(#tip)"/>'


def _word(x: int, y: int, text: str) -> str:
    return f'<text x="{x}" y="{y}" class="signal">{_lowered(text)}</text>'


def _lowered(text: str) -> str:
    """Text with what follows an underscore as a subscript."""
    head, *tails = escape(text).split("_")
    lowered = (
        f'<tspan dy="4" class="index">{tail[:1]}</tspan><tspan dy="-4">{tail[1:]}</tspan>' for tail in tails
    )
    return head + "".join(lowered)


def _label(name: str, place: tuple[int, int], spec: Spec, timing: TimingResult) -> str:
    """Delay of a link, and beneath it what was measured."""
    x, y = place
    asked = f"τ{name[-1]} = {_ms(getattr(spec.loop().timing, name))}"
    link = timing.links.get(name)
    known = link.age[np.isfinite(link.age)] if link is not None else np.empty(0)
    measured = f"at use {_ms(float(known.mean()))}" if known.size else "not recorded"
    excess = link.excess[np.isfinite(link.excess)] if link is not None else np.empty(0)
    late = f"excess p99 {1e3 * float(np.quantile(excess, 0.99)):.3f} ms" if excess.size else ""
    left, top = x - LABEL_WIDTH // 2, y - LABEL_HEIGHT // 2
    box = f'<rect x="{left}" y="{top}" width="{LABEL_WIDTH}" height="{LABEL_HEIGHT}" rx="8" class="link"/>'
    texts = ((-12, "delay", asked), (5, "measured", measured), (21, "measured", late))
    return box + "".join(
        f'<text x="{x}" y="{y + dy}" class="{kind}">{escape(text)}</text>' for dy, kind, text in texts
    )
