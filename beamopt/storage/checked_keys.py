"""The base of what files hold: every key has a unit, a range and a line that explains it."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Self, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo

from beamopt.base.brief import Brief
from beamopt.base.errors import InputError

__all__ = ["CheckedKeys", "Count", "Number", "allowed", "parse", "quantity"]

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; text and booleans are refused."""

Count = Annotated[int, Field(strict=True)]
"""A whole number; text, booleans and fractions are refused."""


PYDANTIC = {name for name in dir(BaseModel) if not name.startswith("_")} - {"model_copy"}
"""Names of pydantic's that completion leaves out."""


class CheckedKeys(BaseModel):
    """Frozen, and unknown keys are refused.

    A copy holds the keys' values only: what a cached property has computed stays with the object
    that computed it. This holds for `model_copy`, `copy`, `copy.copy`, `copy.deepcopy` and
    `pickle`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy with the keys in `update` replaced; the whole is checked as if it was read.

        Raises
        ------
        InputError : an unknown key, a value that is not allowed, or keys that contradict.
        """
        bare = copy.deepcopy(self) if deep else copy.copy(self)
        if not update:
            return bare
        alias = {name: field.alias or name for name, field in type(self).model_fields.items()}
        values = {alias[name]: getattr(bare, name) for name in self.model_fields_set}
        changes = {alias.get(name, name): value for name, value in update.items()}
        return parse(type(self), values | changes, type(self).__name__)

    def copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:  # type: ignore[override]
        """Copy as `model_copy` does; pydantic's own would take computed values along."""
        return self.model_copy(update=update, deep=deep)

    def __dir__(self) -> Iterable[str]:
        """Keys, own methods and properties, and `model_copy`: pydantic's other names are hidden."""
        models = [model for model in type(self).__mro__[:-1] if issubclass(model, CheckedKeys)]
        own = {name for model in models if model is not CheckedKeys for name in vars(model)}
        hidden = PYDANTIC - {name for name in own if not name.startswith("model_")}
        return sorted(set(super().__dir__()) - hidden)

    def __repr_args__(self) -> Iterator[tuple[str, object]]:
        """Keys that differ from their defaults, with short values."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            usual = field.get_default(call_default_factory=True, validated_data=self.__dict__)
            if field.is_required() or value != usual:
                yield name, Brief(value)

    def __getstate__(self) -> dict[Any, Any]:
        """Return the state to pickle, without cached values."""
        state = super().__getstate__()
        return state | {"__dict__": _own(type(self), state["__dict__"])}

    def __copy__(self) -> Self:
        """Return a copy without cached values."""
        made = super().__copy__()
        object.__setattr__(made, "__dict__", _own(type(self), made.__dict__))
        return made

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """Return a deep copy without cached values."""
        return BaseModel.__deepcopy__(copy.copy(self), memo)


def _own(model: type[BaseModel], values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a model's keys, without those of its cached properties."""
    return {name: value for name, value in values.items() if name in model.model_fields}


def quantity(
    default: Any,
    text: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
) -> Any:
    """A key with its explanation, unit and range; `...` as the default means it must be given."""
    return Field(
        default, description=text, ge=low, le=high, json_schema_extra={"unit": unit} if unit else {}
    )


def allowed(field: FieldInfo) -> str:
    """What a key may hold: "10 … 5000 mm", "one of fixed, range"."""
    extra = field.json_schema_extra
    unit = f" {extra['unit']}" if isinstance(extra, dict) and "unit" in extra else ""
    low, high = (_bound(field, name) for name in ("ge", "le"))
    if low is not None and high is not None:
        return f"{low:g} … {high:g}{unit}"
    if low is not None:
        return f"at least {low:g}{unit}"
    choices = [str(choice) for choice in get_args(field.annotation) if isinstance(choice, str)]
    return f"one of {', '.join(choices)}" if choices else unit.strip()


def _bound(field: FieldInfo, name: str) -> float | None:
    found = [getattr(item, name) for item in field.metadata if hasattr(item, name)]
    return found[0] if found else None


M = TypeVar("M", bound=BaseModel)

PLAIN = {
    "model_type": "must be a table of keys",
    "dict_type": "must be a table of keys",
    "tuple_type": "must be a list",
    "list_type": "must be a list",
    "too_long": "has too many items",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "finite_number": "must be a finite number",
    "string_type": "must be text",
    "bool_type": "must be true or false",
}
"""What the checks' own wording means to a person."""


def parse(model: type[M], data: Mapping[str, Any], where: object) -> M:
    """Build `model` from a file's content.

    Raises
    ------
    InputError : the first thing that is wrong, by file, key, value and what is allowed.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _explained(error, model, where) from None


def _explained(error: ValidationError, model: type[BaseModel], where: object) -> InputError:
    # an unknown key is often the misspelling of one that is then missing: name it first
    first = min(error.errors(), key=lambda item: item["type"] != "extra_forbidden")
    path, holder, field = _walk(model, first["loc"])
    value, kind, said = first["input"], first["type"], first["msg"]
    if kind == "extra_forbidden":
        return InputError(where, path, value, f"unknown key; known here: {_keys(holder)}")
    if kind == "missing":
        return InputError(where, path, None, f"must be given: {_described(field)}")
    if kind == "value_error":
        whole = isinstance(value, Mapping | list | tuple)
        cause = first["ctx"]["error"]
        if isinstance(cause, InputError):  # a check of several keys that knows which one it is
            key = ".".join(part for part in (path, cause.key) if part)
            return InputError(where, key, cause.value, cause.allowed)
        return InputError(where, path, None if whole else value, str(cause))
    said = PLAIN.get(kind, said[0].lower() + said[1:])
    limits = allowed(field) if field is not None else ""
    in_a_list = path.endswith("]")
    ranged = kind in ("greater_than_equal", "less_than_equal") and not in_a_list
    if limits and (ranged or kind == "literal_error"):
        said = f"allowed: {limits}"
    elif limits:
        said = f"{said}; {limits}"
    return InputError(where, path, value, said)


def _walk(
    model: type[BaseModel], location: tuple[int | str, ...]
) -> tuple[str, type[BaseModel] | None, FieldInfo | None]:
    """A place in a file as a person writes it, the model that holds it, and its field."""
    path = ""
    holder: type[BaseModel] | None = model
    field: FieldInfo | None = None
    for step in location:
        if isinstance(step, int):
            path += f"[{step}]"
            continue
        if field is not None:
            holder = next(iter(_models(field.annotation)), None)
        path += f".{step}" if path else step
        field = _field(holder, step)
    return path, holder, field


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def _field(holder: type[BaseModel] | None, key: str) -> FieldInfo | None:
    if holder is None:
        return None
    for name, field in holder.model_fields.items():
        if key in (name, field.alias):
            return field
    return None


def _keys(holder: type[BaseModel] | None) -> str:
    fields = holder.model_fields.items() if holder is not None else ()
    return ", ".join(field.alias or name for name, field in fields)


def _described(field: FieldInfo | None) -> str:
    return (field.description or "") if field is not None else ""
