"""The ledger of work closes for any loop that stays finite."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec


@settings(max_examples=25)
@given(
    mass=st.tuples(st.floats(0.8, 5.0), st.floats(0.8, 5.0)),
    stiffness=st.tuples(st.floats(1.0, 30.0), st.floats(1.0, 30.0)),
    k_tot=st.floats(20.0, 80.0),
    delays=st.tuples(*[st.floats(0.0, 0.02)] * 4),
    td4=st.sampled_from([0.0, 0.003]),
    start=st.floats(-0.5, 0.5),
)
def test_ledger_closes_for_random_stable_loops(mass, stiffness, k_tot, delays, td4, start):
    changes = {"plant.mass": [mass[0]], "numerical.mass": [mass[1]], "plant.stiffness": [stiffness[0]]}
    changes |= {"numerical.stiffness": [stiffness[1]], "actuator.stiffness": [k_tot], "timing.td4": td4}
    changes |= {f"timing.tau{i + 1}": delay for i, delay in enumerate(delays)}
    spec = apply(shipped_spec("paper"), changes | {"plant.initial_position": [start]})
    found = simulate(spec, 3.0, 0.01)
    energy = found.energies["E_total"]
    if energy.max() < 1e3 * max(energy[0], 1e-9):
        assert np.abs(found.balance_error).max() < 1e-9 * max(1.0, energy.max())


def test_hybrid_energies_are_those_that_the_first_order_terms_foretell():
    """At the paper's delays E_fx drains and E_ff and E_num introduce, as the signs of (26b) say."""
    work = simulate(shipped_spec("paper"), 20.0, 0.0012).energies
    assert work["E_fx"][-1] < 0.0 < work["E_ff"][-1]
    assert work["E_num"][-1] > 0.0
