"""Work in a program that repeats, of eight periods at once, compiled.

The same happens in every period, from other states: a coefficient is read once for eight of them, and a
product of two elements of the state serves all terms and all looks between two changes of an input.
"""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, called, written_out
from rthm_core.energy import FF, FX
from rthm_core.simd import WIDTH, columns, element, everywhere, numbers, put_element, put_numbers

SIDE_BY_SIDE = 4
"""Terms that are summed side by side: a sum waits for the one before, and each product is read once."""

PRODUCTS = 256
"""Products that are made at once, as many as stay in the nearest memory."""


class Looks(NamedTuple):
    """When the work of a period is looked at, and what from: at rows and at changes of an input, in the
    order of time. Between two changes the joint state z is that of the first; a period of work ends with the
    last change of a period of the program, so that rows thereafter are of the next one.

    Attributes
    ----------
    coefficients : (K, ., 4) array
        Of the products of two elements of z, for a look with table k. Those of E_ff are for its sum with
        E_fx, on which less has an influence.
    pairs : (2, pairs) array
        The two elements.
    segments : (segments, 4 + 4) array
        Where pairs begin and end that matter for the same terms, where their coefficients begin, whether
        these are of four pairs and one term each instead of one pair and four terms; and the terms.
    table : (2, looks) array
        Table of every look, in the first period and in every further one.
    ends : (changes + 1,) array
        Looks before the period, and up to each change, which is the last of these.
    row : (looks,) array
        Number of the row in the period of the program; below zero in the one before.
    rows : int
        Rows of a period.
    """

    coefficients: Floats
    pairs: Integers
    segments: Integers
    table: Integers
    ends: Integers
    row: Integers
    rows: int


class Periods(NamedTuple):
    """Eight periods.

    Attributes
    ----------
    looks : Looks
        When their work is looked at.
    states : (changes + 1, d, 8) array
        z before each change, and where the program ended.
    products, sums, ends : (PRODUCTS, 8), (looks + 1, 8, 8), (9, 8) arrays
        Scratch: products, work since the start of the period (terms, periods), and at the ends of periods.
    work : (8,) array
        Work up to the first of the periods, then up to the end of the last.
    """

    looks: Looks
    states: Floats
    products: Floats
    sums: Floats
    ends: Floats
    work: Floats


@written_out
def _note(states, change, begin, lane, part):  # type: ignore[no-untyped-def]
    for i in range(len(part)):
        put_element(states, (change, begin + i, lane), part[i])
    return begin + len(part)


@written_out
def feel(felt, i, held):  # type: ignore[no-untyped-def]
    """What of the held motion matters for work."""
    total = 0.0
    for j in range(len(held)):
        total += element(felt, (i, j)) * held[j]
    return total


@written_out
def note(  # type: ignore[no-untyped-def]
    states, change, lane, plant, aside, commands, numerical, held, felt
):
    """Note the joint state after a change of an input."""
    d = _note(states, change, 0, lane, plant)
    if aside is not None:
        d = _note(states, change, d, lane, aside)
    d = _note(states, change, _note(states, change, d, lane, commands), lane, numerical)
    for i in range(felt.shape[0]):
        put_element(states, (change, d + i, lane), feel(felt, i, held))


@written_out
def _multiply(pairs, begin, count, states, change, products):  # type: ignore[no-untyped-def]
    """Products of some pairs of elements of the joint states after a change."""
    for n in range(count):
        one, other = element(pairs, (0, begin + n)), element(pairs, (1, begin + n))
        put_numbers(products, (n,), numbers(states, (change, one)) * numbers(states, (change, other)))


@written_out
def _add(sums, look, term, value):  # type: ignore[no-untyped-def]
    put_numbers(sums, (look, term), numbers(sums, (look, term)) + value)


@written_out
def _add_to_terms(  # type: ignore[no-untyped-def]
    coefficients, k, at, count, products, terms, sums, look
):
    """Add what products say of four terms each."""
    a = b = c = d = everywhere(0.0)
    for n in range(count):
        product = numbers(products, (n,))
        a += product * element(coefficients, (k, at + n, 0))
        b += product * element(coefficients, (k, at + n, 1))
        c += product * element(coefficients, (k, at + n, 2))
        d += product * element(coefficients, (k, at + n, 3))
    _add(sums, look, terms[0], a)
    _add(sums, look, terms[1], b)
    _add(sums, look, terms[2], c)
    _add(sums, look, terms[3], d)


@written_out
def _add_to_term(coefficients, k, at, count, products, term, sums, look):  # type: ignore[no-untyped-def]
    """Add what products, four at a time, say of one term."""
    a = b = c = d = everywhere(0.0)
    for n in range(count // SIDE_BY_SIDE):
        first = SIDE_BY_SIDE * n
        a += numbers(products, (first,)) * element(coefficients, (k, at + n, 0))
        b += numbers(products, (first + 1,)) * element(coefficients, (k, at + n, 1))
        c += numbers(products, (first + 2,)) * element(coefficients, (k, at + n, 2))
        d += numbers(products, (first + 3,)) * element(coefficients, (k, at + n, 3))
    _add(sums, look, term, (a + b) + (c + d))


@written_out
def _add_segment(periods, segment, change, later, first, stop):  # type: ignore[no-untyped-def]
    """Add what the pairs of a segment say of its terms, at the looks after a change."""
    looks, products, sums = periods.looks, periods.products, periods.sums
    pairs, coefficients, table, segments = looks.pairs, looks.coefficients, looks.table, looks.segments
    terms = segments[segment, 4], segments[segment, 5], segments[segment, 6], segments[segment, 7]
    at, alone = segments[segment, 2], segments[segment, 3] != 0
    for begin in range(segments[segment, 0], segments[segment, 1], PRODUCTS):
        count = min(PRODUCTS, segments[segment, 1] - begin)
        _multiply(pairs, begin, count, periods.states, change, products)
        for look in range(first, stop):
            k = element(table, (later, look))
            if alone:
                _add_to_term(coefficients, k, at, count, products, terms[0], sums, look + 1)
            else:
                _add_to_terms(coefficients, k, at, count, products, terms, sums, look + 1)
        at += count // SIDE_BY_SIDE if alone else count


@written_out
def _sum_up(periods, later):  # type: ignore[no-untyped-def]
    """Work since the start of each period at all looks."""
    ends, sums = periods.looks.ends, periods.sums
    for change in range(ends.size - 1):
        first, stop = ends[change], ends[change + 1]
        for look in range(first, stop):
            for term in range(WIDTH):
                put_numbers(sums, (look + 1, term), numbers(sums, (first, term)))
        for segment in range(periods.looks.segments.shape[0]):
            _add_segment(periods, segment, change, later, first, stop)


@written_out
def _columns(sums, look):  # type: ignore[no-untyped-def]
    """Work of each period at a look, after which that of E_ff is without E_fx."""
    put_numbers(sums, (look, FF), numbers(sums, (look, FF)) - numbers(sums, (look, FX)))
    return columns(sums, (look,))


@written_out
def _write(periods, look, first, out, row, until):  # type: ignore[no-untyped-def]
    """Write the work of a row in each period from the first on, whose rows begin with `row`."""
    at = row + periods.looks.row[look] - first * periods.looks.rows
    for lane, added in enumerate(_columns(periods.sums, look + 1)):
        if first <= lane and 0 <= at < until:
            put_numbers(out, (at,), numbers(periods.ends, (lane,)) + added)
        at += periods.looks.rows


@called
def count_periods(periods, later, first, stop, out, row, until):  # type: ignore[no-untyped-def]
    """Write the work of rows from `row` up to `until`, and of those before that follow a last change; of the
    eight periods those from `first` on, of which those before `stop` are complete.
    """
    looks, ends, work = periods.looks, periods.ends, periods.work
    _sum_up(periods, later)
    put_numbers(ends, (first,), numbers(work, ()))
    for lane, added in enumerate(_columns(periods.sums, looks.row.size)):
        if first <= lane < stop:
            put_numbers(ends, (lane + 1,), numbers(ends, (lane,)) + added)
    for change in range(looks.ends.size - 1):
        for look in range(looks.ends[change], looks.ends[change + 1] - 1):
            _write(periods, look, first, out, row, until)
    put_numbers(work, (), numbers(ends, (stop,)))
