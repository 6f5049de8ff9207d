"""Messages from a screen to the studio: small JSON messages and numbers, validated before use."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from hydrostat.errors import InputError

Coordinate = Annotated[float, Field(ge=-100.0, le=100.0, allow_inf_nan=False)]
Place = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]

MAX_LETTERS = 4096  # no message has more characters


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Pointer(_Message):
    """The pointer, in meters of the body.

    A "grab" begins what "drag"s go on with and a "release" ends; a "click" is both at one place. `stamp` returns with
    the first frame that has the answer.
    """

    kind: Literal["grab", "drag", "click"]
    key: Annotated[str, Field(max_length=200)] = ""
    rest: Place | None = None
    world: Place
    shift: bool = False
    stamp: Annotated[float, Field(ge=0, le=1e15, allow_inf_nan=False)] = 0.0


class LetGo(_Message):
    """Let go of what the pointer held."""

    kind: Literal["release"]


class Seen(_Message):
    """So many more frames have come: others may follow."""

    kind: Literal["seen"]
    count: Annotated[int, Field(ge=1, le=1000)] = 1


Message = Pointer | LetGo | Seen
_ADAPTER: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def read_message(text: str) -> Message:
    """A message from its text (InputError: it is too long, no JSON, of no known kind, or has a wrong value)."""
    if len(text) > MAX_LETTERS:
        raise InputError(f"a message may have {MAX_LETTERS} characters, not {len(text)}")
    try:
        return _ADAPTER.validate_json(text)
    except (ValidationError, RecursionError) as error:
        what = error.errors()[0]["msg"] if isinstance(error, ValidationError) else "nested too deep"
        raise InputError(f"cannot read a message: {what}") from None


def sent_number(value: Any) -> float | None:
    """The number, or that of a text which a person is typing; None if it is none yet."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    largest_number = 1e9  # no number of a screen is larger
    return number if -largest_number <= number <= largest_number else None
