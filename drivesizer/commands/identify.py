"""At the bench: ``drivesizer predict``, ``identify`` and ``compare``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands import common
from drivesizer.commands.catalog import Names
from drivesizer.errors import InputError, quoted
from drivesizer.files.writing import check_targets, ready, write_files

if TYPE_CHECKING:
    from collections.abc import Mapping

    from drivesizer.catalog.query import PartRow
    from drivesizer.identification.identify import Reference
    from drivesizer.results.identification import Comparison, Identification


_FORMS = (".svg", ".png")


def predict(
    motor: Annotated[str, typer.Argument(metavar="MOTOR", help="Part number of a motor or an actuator.")],
    gearhead: Annotated[str | None, typer.Option(metavar="PART", help="Its gearhead; else none.")] = None,
    controller: Annotated[
        str | None, typer.Option(metavar="PART", help="Its controller; else the bare supply.")
    ] = None,
    catalogs: Names = None,
    voltage: Annotated[str | None, typer.Option(help="Of the supply; else the motor's nominal one.")] = None,
    resistance: Annotated[str | None, typer.Option(help="Of supply and leads; else usual leads.")] = None,
    ambient: Annotated[str | None, typer.Option(help="Temperature around the motor; else 25 degC.")] = None,
    load: Annotated[str | None, typer.Option(help="Torque at the output; else the continuous torque.")] = None,
    hold: Annotated[str | None, typer.Option(help="Torque held at rest; else the load.")] = None,
    inertia: Annotated[str | None, typer.Option(help="Of what is mounted at the output; else nothing.")] = None,
    minutes: Annotated[
        float, common.number_option("--minutes", 60.0, meaning="How long it runs at the load, and holds.")
    ] = 60.0,
    warm: Annotated[
        str | None, typer.Option(help="Temperature at a warm start; else the housing's after long nominal work.")
    ] = None,
    spec: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A robot.yaml: its machine gives what is not given here.")
    ] = None,
    json: common.Json = False,
    figure: Annotated[
        Path | None, common.file_option(metavar="FILE", help="Also draw line and temperatures: .svg or .png.")
    ] = None,
    report: common.Report = None,
) -> None:
    """Predict what is measured of a set at the bench: each figure with its 5 to 95 % band."""
    from drivesizer.errors import FieldError
    from drivesizer.output.document.bench import bench_document
    from drivesizer.prediction.bench import predict_set

    common.accept_reports(report)
    if figure is not None:
        if figure.suffix.lower() not in _FORMS:
            expected = f"expected {' or '.join(_FORMS)}"
            raise InputError(f"{quoted(figure.name)} does not say which kind of figure; {expected}")
        ready(figure)
    try:
        with common.working("predicting"):
            prediction = predict_set(
                motor, gearhead, controller, catalogs=catalogs or (), voltage=voltage, resistance=resistance,
                ambient=ambient, load=load, hold=hold, inertia=inertia, minutes=minutes, warm=warm,
                spec=spec,
            )  # fmt: skip
    except FieldError as error:
        raise InputError(f"--{error}") from None
    files = {}
    if figure is not None:
        form: Any = figure.suffix.lower().removeprefix(".")
        files = {figure: bench_document(prediction).pictures["bench"].paper(form)}
    try:  # none of the figure where the answer cannot be given, but to a reader who has enough
        if json:
            common.print_json(prediction)
        else:
            common.present(bench_document(prediction), report)
            common.print_notes(prediction.warnings)
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # rich makes the second of the first
        write_files(files)
        raise
    common.print_written(write_files(files))


_ONE_DRIVE = "a log is that of one drive"
_PICTURES = (".svg", ".pdf", ".png")
_SPECS = (".yaml", ".yml")

LogFile = Annotated[
    Path,
    common.file_argument(
        metavar="LOG", help="CSV, TSV, XLSX, SysId JSON, .wpilog, a pendulum's or a calibration's JSON."
    ),
]
OfSpec = Annotated[Path | None, common.file_option("--spec", metavar="ROBOT.YAML", help="The machine that was logged.")]
Scales = Annotated[
    list[str] | None, typer.Option("--scale", metavar="COLUMN=FACTOR", help="speed=6.2832; may be repeated.")
]
Heads = Annotated[
    list[str] | None,
    typer.Option("--column", metavar="QUANTITY=HEAD", help="A table's column, current='a1 q-axis [A]'; repeatable."),
]


def identify(
    log: LogFile,
    motor: Annotated[str | None, typer.Option(metavar="PART", help="The motor, by its number in a catalogue.")] = None,
    spec: OfSpec = None,
    chosen: common.DriveOption = None,
    inertia: Annotated[str | None, typer.Option(help="Known, of what is mounted at the output.")] = None,
    ratio: Annotated[float, common.number_option("--ratio", 9.0, meaning="Of gears before a logged torque.")] = 1.0,
    column: Heads = None,
    scale: Scales = None,
    json: common.Json = False,
    output: Annotated[
        list[Path] | None,
        common.file_option("--output", "-o", help="Measured against model (.svg, .pdf, .png), or a catalogue (.yaml)."),
    ] = None,
    axis: common.OfAxis = None,
    catalogs: Names = None,
    report: common.Report = None,
) -> None:
    """Identify a drive by its log: figures with bands, what it cannot separate, what is wrong with it."""
    from drivesizer.identification.identify import identify as identified
    from drivesizer.identification.identify import part_file

    paths = _targets(output, "a row of a catalogue")
    common.accept_reports(report)
    if motor and spec:
        raise InputError("--motor: the spec has the motor; expected one of --motor and --spec")
    if not ratio > 0.0:
        raise InputError(f"--ratio: {ratio:g} is not above 0; expected e.g. 9")
    hit, of = _reference(motor, spec, chosen, axis, catalogs, ratio)
    if inertia is not None:
        of = of._replace(inertia=_inertia(inertia))
    with common.working("fitting the drive's model to the log; first, once: translating it to machine code"):
        identification = identified(log, of, scales=_factors(scale), named=_heads(column))
    files = {path: part_file(identification, hit, path.name) for path in paths if path.suffix.lower() in _SPECS}
    files |= {
        path: _picture(path, identification.time, identification.traces)
        for path in paths
        if path.suffix.lower() in _PICTURES
    }
    _answer(identification, files, report, json=json)


def _picture(path: Path, time: Any, traces: Any) -> bytes:
    from drivesizer.output.report.figures.cycle import measured_and_model
    from drivesizer.output.report.figures.picture import on_paper

    if not traces or not len(time):
        raise InputError(f"{path}: there is nothing over time to draw")
    form: Any = path.suffix.lower().removeprefix(".")
    return on_paper(measured_and_model(time, traces))(form)


def _inertia(text: str) -> float:
    from drivesizer.units import to_si

    try:
        value = to_si(text, "inertia")
    except InputError as error:
        raise InputError(f"--inertia: {error}") from None
    if not value > 0.0:
        raise InputError(f"--inertia: {quoted(text)} is not above 0; expected e.g. 12 g*cm^2")
    return value


def _heads(words: list[str] | None) -> dict[str, str]:
    from drivesizer.identification.log import QUANTITIES

    heads = {}
    for word in words or ():
        name, _, head = word.partition("=")
        if name.strip() not in QUANTITIES.split() or not head:
            raise InputError(f"--column: {quoted(word)}; expected one of {', '.join(QUANTITIES.split())} and its head")
        heads[name.strip()] = head.strip()
    return heads


def _factors(words: list[str] | None) -> Mapping[str, float]:
    factors = {}
    for word in words or ():
        name, _, factor = word.partition("=")
        try:
            factors[name.strip()] = float(factor)
        except ValueError:
            raise InputError(f"--scale: {quoted(word)}; expected a column and its factor, e.g. speed=6.2832") from None
    return factors


def _reference(
    motor: str | None, spec: Path | None, words: list[str] | None, axis: str | None, catalogs: list[str] | None,
    ratio: float,
) -> tuple[PartRow | None, Reference]:  # fmt: skip
    """The drive as it is known: not at all, by a motor, or by a spec and its drive."""
    from drivesizer.identification.identify import Reference, of_drive, of_motor

    if motor:
        from drivesizer.catalog.query import find, open_catalogs

        hits = [hit for hit in find(open_catalogs(catalogs or ()), motor) if hit.section == "motors"]
        if not hits:
            raise InputError(f"--motor: {quoted(motor)} is no motor; expected one of a catalogue's section motors")
        return hits[0], of_motor(hits[0], ratio)
    if spec is None:
        return None, Reference(ratio=ratio)
    return None, of_drive(*common.one_drive(spec, words, catalogs, axis, _ONE_DRIVE))


# -- ``drivesizer compare``.


def compare(
    log: LogFile,
    spec: Annotated[
        Path,
        common.file_option("--spec", metavar="ROBOT.YAML", help="The machine that was logged; robot.yaml by default."),
    ] = common.DEFAULT,
    profile: common.Profile = None,
    chosen: common.DriveOption = None,
    column: Heads = None,
    scale: Scales = None,
    json: common.Json = False,
    output: Annotated[
        list[Path] | None,
        common.file_option(
            "--output", "-o", help="Torque measured against required (.svg, .pdf, .png), or the corrected spec."
        ),
    ] = None,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
    report: common.Report = None,
) -> None:
    """Hold a machine's log against its sizing: margins that are really left, and what explains the difference."""
    from drivesizer.identification.compare import compare as compared
    from drivesizer.identification.compare import corrected
    from drivesizer.identification.identify import scaled
    from drivesizer.identification.log import read_log
    from drivesizer.simulate import hardest_case, validate

    paths = _targets(output, "the corrected spec")
    common.accept_reports(report)
    logged = scaled(read_log(log, _heads(column)), _factors(scale))
    own, drive = common.one_drive(spec, chosen, catalogs, axis, _ONE_DRIVE)
    with common.simulating("simulating what was promised"):
        proof = validate(own, drive, profile=profile, load_case=hardest_case(own, drive))
    comparison = compared(logged, proof)
    files = {}
    for path in paths:
        if path.suffix.lower() in _PICTURES:
            files[path] = _picture(path, comparison.time, comparison.traces)
        elif not comparison.explanations:
            raise InputError(f"{path}: no figure of the load explains a difference: the spec stays as it is")
        else:
            files[path] = corrected(own, comparison.explanations[0])
    _answer(comparison, files, report, json=json)
    raise typer.Exit(int(any(check.status == "fail" for check in comparison.checks)))


def _targets(output: list[Path] | None, data: str) -> list[Path]:
    """The files to write: figures, and data as YAML."""

    for path in output or []:
        if path.suffix.lower() not in (*_PICTURES, *_SPECS):
            expected = f"expected {', '.join(_PICTURES)}, or .yaml for {data}"
            raise InputError(f"{quoted(path.name)} does not say what is to be written; {expected}")
    check_targets(output or [])
    return output or []


def _answer(
    result: Identification | Comparison, files: dict[Path, bytes], report: list[Path] | None, *, json: bool
) -> None:
    """Print what was found, and write the files."""

    if json:
        common.print_json(result)
    else:
        from drivesizer.output.document.bench import bench_document

        common.present(bench_document(result), report)
    common.print_written(write_files(files))
