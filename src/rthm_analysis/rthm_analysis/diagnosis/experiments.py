"""What to try next: the experiment that would tell apart what this recording cannot."""

from __future__ import annotations

LOOKS_AT = {
    "coulomb_friction": "a slow sweep back and forth with constant speed",
    "stribeck_friction": "starts from rest at several low speeds",
    "quadratic_drag": "the same motion at twice the amplitude",
    "cubic_stiffness": "static pulls to several displacements on both sides",
    "quadratic_stiffness": "static pulls to several displacements on both sides",
    "end_stop": "a slow push against the stop",
    "clearance": "a slow push through the gap on both sides",
    "bouc_wen": "slow loops of growing amplitude, force over displacement",
    "maxwell_branch": "a step that is held, to watch the force relax",
    "hidden_mode": "a slow sine sweep through the suspected resonance",
    "fluid_memory": "a slow sine sweep, and a decay in air",
    "harmonic_load": "a recording at rest, everything switched on",
    "constant_load": "a recording at rest, before and after turning the set-up over",
    "backlash": "slow reversals of the motor under a small load",
    "slack": "the same test with more pretension",
    "hardening": "static pulls at the wire to several elongations",
    "pulley_inertia": "a sine sweep of the motor with the dof locked",
    "pulley_friction": "slow reversals of the motor with the dof locked",
    "lag": "small steps of the command with the dof locked",
    "second_order": "small steps of the command with the dof locked",
    "extra_delay": "small steps of the command with the dof locked",
    "rate_limit": "steps of the command of several sizes",
    "saturation": "slow ramps of the command to the ends",
    "quantisation": "a very slow ramp",
    "bias": "a recording at rest at a known position",
    "scale": "rests at several known positions or forces",
    "drift": "a long recording at rest",
    "jitter": "a longer recording of the same test",
    "loss": "a longer recording of the same test",
    "clock_offset": "a check of the clocks of the two hosts against each other",
    "wrong_parameter": "a look at the parameters that the node was started with",
}


def next_experiment(verdict: str, physics: list[tuple[str, str]], alternatives: list[tuple[str, str]]) -> str:
    """A sentence; all are (block, kind), `alternatives` those that cannot be told apart."""
    if alternatives and physics:
        kind, other = physics[0][1], alternatives[0][1]
        return (
            f"To tell {kind.replace('_', ' ')} from {other.replace('_', ' ')}: "
            f"{LOOKS_AT.get(kind, 'a longer recording')}, and {LOOKS_AT.get(other, 'a larger amplitude')}."
        )
    if verdict == "unexplained":
        return (
            "Repeat the test at half and at twice the amplitude: what grows faster than the motion is "
            "stiffness, drag or contact, what does not grow is friction or noise."
        )
    if physics:
        return f"To confirm it: {LOOKS_AT.get(physics[0][1], 'the same test at another amplitude')}."
    return "A longer recording, or one with larger motion, would show smaller effects (see detection limits)."
