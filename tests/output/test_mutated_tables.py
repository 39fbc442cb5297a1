"""A table that was spoilt is refused with one message or read to the same numbers, never to others."""

import random
from collections.abc import Callable

from hypothesis import given, settings
from hypothesis import strategies as st

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.experiment import COLUMNS, MeasuredPoint, parse_experiment

STATES = ("undeformed", "severe_AT", "moderate_TA")
# No digits, signs, points and exponents: with these, junk is a number.
JUNK = list(" _#%'\"\\/,;\t\0\v\u2028\ufeffxyzµ∞٣")

Lines = list[str]
Mutation = Callable[[Lines, random.Random], Lines]


def separators(lines: Lines, chance: random.Random) -> Lines:
    new = chance.choice(";\t|")
    return [line.replace(",", new) for line in lines]


def separators_of_one_line(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines))
    return [*lines[:place], lines[place].replace(",", ";"), *lines[place + 1 :]]


def decimal_commas(lines: Lines, chance: random.Random) -> Lines:
    return [line.replace(".", ",") for line in lines]


def one_decimal_comma(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines))
    return [*lines[:place], lines[place].replace(".", ",", 1), *lines[place + 1 :]]


def blank_line(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines) + 1)
    return [*lines[:place], chance.choice(["", "  ", ",,", ";;", "\t"]), *lines[place:]]


def extra_field(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines))
    fields = lines[place].split(",")
    fields.insert(chance.randrange(len(fields) + 1), chance.choice(["", "7", "x"]))
    return [*lines[:place], ",".join(fields), *lines[place + 1 :]]


def lost_field(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines))
    fields = lines[place].split(",")
    del fields[chance.randrange(len(fields))]
    return [*lines[:place], ",".join(fields), *lines[place + 1 :]]


def repeated_head(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(1, len(lines) + 1)
    return [*lines[:place], lines[0], *lines[place:]]


def repeated_column(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines[0].split(",")))
    return [f"{line},{(line.split(',') + [''] * 9)[place]}" for line in lines]


def junk(lines: Lines, chance: random.Random) -> Lines:
    place = chance.randrange(len(lines))
    at = chance.randrange(len(lines[place]) + 1)
    new = "".join(chance.choices(JUNK, k=chance.randrange(1, 4)))
    return [*lines[:place], lines[place][:at] + new + lines[place][at:], *lines[place + 1 :]]


def quote(lines: Lines, chance: random.Random) -> Lines:
    for _ in range(2):
        place = chance.randrange(len(lines))
        at = chance.randrange(len(lines[place]) + 1)
        lines = [*lines[:place], lines[place][:at] + '"' + lines[place][at:], *lines[place + 1 :]]
    return lines


MUTATIONS: list[Mutation] = [
    separators,
    separators_of_one_line,
    decimal_commas,
    one_decimal_comma,
    blank_line,
    extra_field,
    lost_field,
    repeated_head,
    repeated_column,
    junk,
    quote,
]

# A lost field beside a decimal comma is another table, which nobody could tell from a sound one.
TOGETHER = [mutation for mutation in MUTATIONS if mutation is not lost_field]

points = st.builds(
    MeasuredPoint,
    st.sampled_from(STATES),
    st.floats(2.0, 99.0).map(lambda value: round(value, 2)),
    st.floats(1e-12, 1e-4).map(lambda value: float(f"{value:.3g}")),
)


def points_or_message(text: str) -> list[tuple[str, float, float]] | str:
    try:
        read = parse_experiment(text, "points.csv", STATES).points
        return [(p.state, p.delta_k, p.da_dn) for p in read]
    except SceneError as error:
        return str(error)


@settings(max_examples=300)
@given(
    st.lists(points, min_size=1, max_size=6),
    st.permutations([*COLUMNS, "note"]),
    st.one_of(
        st.sampled_from(MUTATIONS).map(lambda one: [one]),
        st.lists(st.sampled_from(TOGETHER), min_size=2, max_size=3),
    ),
    st.sampled_from(["\n", "\r\n"]),
    st.integers(0, 2**32),
)
def test_a_spoilt_table_gives_the_same_numbers_or_one_message(
    rows: list[MeasuredPoint], order: list[str], mutations: list[Mutation], end: str, seed: int
) -> None:
    values = [
        {"state": p.state, COLUMNS[1]: str(p.delta_k), COLUMNS[2]: repr(p.da_dn), "note": "n"}
        for p in rows
    ]
    lines = [",".join(order), *(",".join(row[name] for name in order) for row in values)]
    chance = random.Random(seed)
    for mutate in mutations:
        lines = mutate(lines, chance)
    read = points_or_message(end.join(lines) + end)
    if isinstance(read, str):
        assert "\n" not in read
        assert read.startswith("points.csv: ")
    else:
        assert [p[1:] for p in read] == [(p.delta_k, p.da_dn) for p in rows]


def test_every_mutation_is_refused_somewhere_or_read() -> None:
    """The property above would hold of a reader that refuses everything."""
    lines = [",".join(COLUMNS), "undeformed,13.5,1.5e-9", "severe_AT,9.25,2.5e-8"]
    read = [
        not isinstance(points_or_message("\n".join(mutate(lines, random.Random(seed)))), str)
        for mutate in MUTATIONS
        for seed in range(40)
    ]
    assert 0.1 < sum(read) / len(read) < 0.6
