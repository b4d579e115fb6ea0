"""No code looks at a text that is made for people: not at its beginning, its parts, or as a key."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.test_architecture import MODULES, ROOT

LOOKED_AT = {
    "startswith",
    "endswith",
    "partition",
    "rpartition",
    "split",
    "rsplit",
    "find",
    "index",
}
LOOKED_AT |= {"removeprefix", "removesuffix", "replace", "match", "search", "fullmatch", "count"}
TEXTS = {"reason", "reasons", "status", "statuses", "ending", "endings", "ended", "resolution"}
TEXTS |= {"text", "texts", "law_text", "title", "verdict", "advice"}

ENUMS = {"Agreement", "BoundStatus", "Ending", "FaultKind", "MeshProblem", "NoReply", "PathStatus"}
ENUMS |= {"ReachStatus", "RefineStatus", "RodStatus", "Severity", "Status", "StopReason"}
ENUMS |= {"CandidateKind", "JudgeStatus", "MapEnding", "MethodVerdict", "RefineStage"}
ENUMS |= {"Verdict", "Witness"}
"""Whose values are texts: `Witness("both")` looks a text up; `Witness["BOTH"]` is a name."""

NUMBERS = {"published.value"}
"""Values that are numbers: compared with `==` they are no texts."""
OLD_FILES = {"femcheck/continuation/old_wordings.py", "beamopt/storage/old_wordings.py"}
"""Where files of earlier versions are read, which hold texts in place of names."""
OF_PEOPLE = {
    "beamopt/cli/bound.py": "text",  # an option as it was given
    "beamopt/cli/endings.py": "text",  # put on one line, whatever it says
    "beamopt/cli/tips.py": "text",
    "beamopt/storage/writing.py": "text",  # a cell of a table, defused
    "beamopt/storage/input_file.py": "text",  # a file
    "beamopt/scene/overrides.py": "text",
    "beamopt/export/step.py": "text",  # a file of the kernel's
    "beamopt/pareto/scores.py": "text",
    "beamopt/scene/toml_text.py": "text",
    "beamopt/storage/number_table.py": "text",
    "femcheck/cli/accuracy.py": "text",
    "femcheck/cli/chart.py": "text",
    "femcheck/cli/request.py": "text",
    "femcheck/report/embedding.py": "text",  # escaped
    "femcheck/stability/reading.py": "text",  # Markdown, filled
}
"""Names of texts that a person wrote, to be taken apart, or that are set in type."""


def findings(source: str, file: str = "") -> list[str]:
    """What looks at a text, a line each."""
    written = OF_PEOPLE.get(file, "")
    found = []
    for node in ast.walk(ast.parse(source)):
        looked = [one for one in _looked_at(node) if ast.unparse(one) != written]
        found += [f"line {one.lineno}: {ast.unparse(node)}" for one in looked]
    return found


def _looked_at(node: ast.AST) -> Iterator[ast.expr]:
    """Expressions that are texts for people and that a node looks at."""
    match node:
        case ast.Call(func=ast.Attribute(value=value, attr=attr), args=args) if attr in LOOKED_AT:
            yield from (one for one in (value, *args) if _is_text(one))
        case ast.Compare(ops=[ast.Is() | ast.IsNot()]):
            return
        case ast.Compare(left=left, comparators=others):
            sides = [one for side in (left, *others) for one in _parts(side)]
            strings = any(
                isinstance(one, ast.Constant) and isinstance(one.value, str) for one in sides
            )
            yield from (one for one in sides if _is_value(one) or (strings and _is_text(one)))
        case ast.Set(elts=parts) | ast.Dict(keys=parts):
            yield from (one for one in parts if one is not None and _is_value(one))
        case ast.Call(func=ast.Name(id=name), args=[text], keywords=[]) if name in ENUMS:
            yield text
        case ast.Subscript(slice=key) if _is_value(key):
            yield key


def _parts(node: ast.expr) -> list[ast.expr]:
    return node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]


def _is_value(node: ast.expr) -> bool:
    """`status.value`, whatever the status."""
    return (
        isinstance(node, ast.Attribute)
        and node.attr == "value"
        and ast.unparse(node) not in NUMBERS
    )


def _is_text(node: ast.expr) -> bool:
    """`reason`, `reply.reason`, `str(ended)`, `status.value`."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) if name in TEXTS:
            return True
        case ast.Call(func=ast.Name(id="str"), args=[inner]):
            return _is_text(inner)
    return _is_value(node)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_code_looks_at_a_text(path: Path) -> None:
    file = path.relative_to(ROOT).as_posix()
    if file not in OLD_FILES:
        assert findings(path.read_text(encoding="utf-8"), file) == []


@pytest.mark.parametrize(
    "source",
    [
        "any(reason.startswith(one.value) for one in NO_EQUILIBRIUM)",
        "said.startswith(Status.TIME_OUT.value)",
        'words, mark, load = reason.partition(" at P = ")',
        "moved.now == Status.TIME_OUT.value",
        "if said in ('not ended', StopReason.SECONDS.value): pass",
        "BY_THE_CLOCK = {Status.TIME_OUT.value, Status.STOPPED.value}",
        "MEANINGS = {Status.CONVERGED.value: 'an equilibrium'}",
        "LOOKS[usual.value]",
        "reply.reason == 'converged'",
        "'limit point' in row.measured.reply.reason",
        "str(reply.ended).split(':')",
        "row.measured.resolution.replace(' layers, size ', ' / ').partition(', ')[0]",
        "verdict.value.replace(' ', '_')",
        "Witness(data['witness'])",
    ],
)
def test_what_once_stood_here_is_found(source: str) -> None:
    assert findings(source)


@pytest.mark.parametrize(
    "source",
    [
        "result.status is Status.CONVERGED",
        "one.status.is_interrupted",
        "f'{status.value} at P = {load:.4g} kPa'",
        "file.name.startswith(PREFIX)",
        "source = published.source if value == published.value else GIVEN",
        "texts = {verdict.name: verdict.value for verdict in Verdict}",
    ],
)
def test_what_is_meant_is_not_found(source: str) -> None:
    assert findings(source) == []


def nameless(source: str) -> list[str]:
    """Tables and records that have a status as a text alone, a line each."""
    found = []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Constant(value=str(header)) if "status" in header.split(",")[1:]:
                named = "ended" in header.split(",")
            case ast.Dict(keys=keys, values=values):
                texts = {
                    key.value: _is_value(value)
                    for key, value in zip(keys, values, strict=True)
                    if isinstance(key, ast.Constant)
                }
                named = not texts.get("status") or "ended" in texts
            case _:
                continue
        if not named:
            found.append(f"line {node.lineno}: {ast.unparse(node)}")
    return found


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_status_has_its_name_beside_its_text(path: Path) -> None:
    """Programs read `ended`; `status` may be worded anew."""
    assert nameless(path.read_text(encoding="utf-8")) == []


def test_a_text_alone_is_found() -> None:
    assert nameless('HEADER = "scene,error,status"')
    assert nameless("said = {'status': verdict.status.value, 'L': 1.0}")
    assert not nameless('HEADER = "scene,status,ended"')
    assert not nameless("said = {'status': one.value, 'ended': one.name}")
    assert not nameless("row['status']")
