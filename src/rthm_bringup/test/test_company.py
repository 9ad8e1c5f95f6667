"""Nodes of another test are noticed; those of this one are not."""

from __future__ import annotations

import pytest

from rthm_bringup.run.company import company, look_at, refuse_company
from rthm_bringup.run.environment import Network
from rthm_core.errors import InputError

ALONE = {"run", "plant", "actuator"}


def there(*names: str, namespace: str = "/rthm") -> list[tuple[str, str]]:
    return [(name, namespace) for name in names]


def test_a_run_is_alone_with_its_own_nodes_and_with_those_that_belong_to_no_test() -> None:
    nodes = [*there("run", "plant", "driver", "rviz"), *there("run", "actuator", namespace="/b")]
    assert company(nodes, "/rthm", ALONE, {"run", "plant"}) == []


@pytest.mark.parametrize(
    ("others", "found"),
    [(["run"], ["run"]), (["actuator"], ["actuator"]), (["plant", "run"], ["plant", "run"])],
)
def test_another_leader_a_foreign_part_and_a_second_part_of_one_name_are_company(
    others: list[str], found: list[str]
) -> None:
    assert company(there("run", "plant", *others), "/rthm", ALONE, {"run", "plant"}) == found


def test_company_is_refused_in_one_sentence_with_the_way_out() -> None:
    with pytest.raises(InputError, match=r"domain 7, namespace /b: run; wait .* --namespace or --domain\."):
        refuse_company(there("run", "run", namespace="/b"), Network(7, namespace="/b"), ALONE, {"run"})


def test_other_hosts_are_given_longer_to_show() -> None:
    assert look_at(Network(7)) < look_at(Network(7, peers=("10.0.0.2",)))
