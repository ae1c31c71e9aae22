"""The schema of study.yaml.

``axes`` reads the varied fields, because the spec defines a field's kind of quantity.
"""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationError, model_validator

from drivesizer.errors import InputError
from drivesizer.files.fields import Names, Section, exactly_one
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.messages import explained

__all__ = ["Hypercube", "StudyFile", "schema_of"]


class Hypercube(Section):
    """A Latin hypercube: every field's range in as many equal parts as there are samples, one sample in each."""

    latin_hypercube: Annotated[int, Field(ge=1)] = Field(description="how many samples")
    seed: Annotated[int, Field(ge=0)] = Field(
        default=0, description="of the random numbers; the same seed gives the same samples"
    )


Sampling = Annotated[
    Annotated[Literal["grid"], Tag("grid")] | Annotated[Hypercube, Tag("latin_hypercube")],
    Discriminator(lambda value: "latin_hypercube" if isinstance(value, dict) else "grid"),
]


def _several(example: str) -> BeforeValidator:
    """A list with at least one entry; a single text is refused."""

    def checked(value: object) -> object:
        if not isinstance(value, list) or not value:
            raise ValueError(f"is no list with entries; expected e.g. {example}")
        return value

    return BeforeValidator(checked)


def _fields(value: object) -> object:
    if not isinstance(value, dict) or not value:
        raise ValueError("is no group of fields; expected e.g. load.mass: [30 kg, 45 kg]")
    return value


class StudyFile(Section):
    """A study.yaml: which variants of which spec are sized."""

    spec: str | None = Field(default=None, min_length=1, description="the robot.yaml or machine that is varied")
    specs: Annotated[list[str], _several("[light.yaml, heavy.yaml]")] | None = Field(
        default=None, description="several specs instead, unchanged"
    )
    axis: str | None = Field(
        default=None, min_length=1, description="of a machine the one that is tabled; the whole machine if not given"
    )
    vary: Annotated[dict[str, Any], BeforeValidator(_fields)] | None = Field(
        default=None, description="by field, such as load.mass: a range or a list"
    )
    sampling: Sampling = Field(default="grid", description="every combination, or a Latin hypercube")
    refine: Annotated[int, Field(ge=0, le=6)] = Field(
        default=0, description="how often the steps of ranges are halved where the best drive changes"
    )
    catalogs: Annotated[list[Names], _several("[[maxon], [maxon, faulhaber]]")] | None = Field(
        default=None, description="each entry in place of the spec's catalogues"
    )
    objectives: Annotated[list[str], _several("[mass, price]")] | None = Field(
        default=None, description="each in place of the spec's, such as mass=2,price=1"
    )
    top: Annotated[int, Field(ge=1, le=100)] = Field(default=1, description="how many drives of each variant")

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        exactly_one(self, "spec", "specs")
        if self.specs and self.vary:
            raise ValueError("vary: expected spec, the one that is varied, not specs")
        if isinstance(self.sampling, Hypercube) and not self.vary:
            raise ValueError("sampling: expected fields under vary that the Latin hypercube samples")
        if isinstance(self.sampling, Hypercube) and self.refine:
            raise ValueError("refine: a Latin hypercube has no steps to halve; expected sampling: grid, or no refine")
        return self


def schema_of(source: YamlSource) -> StudyFile:
    """The checked content of a study.yaml."""
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as spec, vary, sampling, objectives")
    try:
        return StudyFile.model_validate(source.data)
    except ValidationError as error:
        raise explained(error, source, StudyFile) from None
