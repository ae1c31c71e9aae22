"""`drivesizer catalog import`: parts out of files as people have them; what is guessed is shown, and written as a map.

The files are renditions of our own of layouts that makers, shops and other programs use; figures are of no maker.
"""

import io
import json
import re
from types import SimpleNamespace

import pytest
import xlsxwriter
from typer.testing import CliRunner

from drivesizer.catalog import load
from drivesizer.cli import app
from drivesizer.errors import InputError

SHOP = """Order no.,Series,Rated voltage,Idle speed,Max. continuous torque,Rated current,Terminal resistance,Kt,\
Rotor moment of inertia,Weight,Colour
,,V,rpm,mNm,A,ohm,mNm/A,gcm2,g,
4711,M 20,24,9560,28.6,1.3,2.32,23.4,10.8,130,red
4712,M 20,48,9500,29.0,0.65,9.3,47,10.7,131,blue
"""
GERMAN = """Bestellnr.;Baureihe;Nennspannung [V];Leerlaufdrehzahl [min-1];Nennmoment [mNm];Nennstrom [A];\
Anschlusswiderstand [Ohm];Drehmomentkonstante [mNm/A];Trägheitsmoment [gcm²];Gewicht [g];Bemerkung
4711;M 20;24;9.560;28,6;1,3;2,32;23,4;10,8;130;ab Lager
4712;M 20;48;9.500;29,0;0,65;9,3;47;10,7;131;
"""
SHEET = """M 20   Anymaker   graphite brushes, 20 Watt
Order number                         4711        4712
Values at nominal voltage
1  Nominal voltage                   V       24          48
2  No load speed                     rpm     9560        9500
3  Nominal torque (max. continuous)  mNm     28.6        29.0
4  Nominal current                   A       1.3         0.65
5  Terminal resistance               Ω       2.32        9.3
6  Torque constant                   mNm/A   23.4        47
7  Rotor inertia                     gcm2    10.8        10.7
8  Max. efficiency                   %       -           86
17 Thermal resistance housing-ambient        14 K/W
"""
UNIT_LAST = """Type                  4711     4712
Nominal voltage      UN      24       48      V
No-load speed        n0      9 560    9 500   min⁻¹
Rated torque         MN      28.6     29.0    mNm
Rated current        IN      1.3      0.65    A
Terminal resistance  R       2.32     9.3     Ω
Torque constant      kM      23.4     47      mNm/A
Rotor inertia        J       10.8     10.7    gcm²
Weight               m       130      131     g
"""
MOTOR = {"nominal_voltage": 24.0, "no_load_speed": 1001.12, "nominal_torque": 0.0286, "nominal_current": 1.3,
         "resistance": 2.32, "torque_constant": 0.0234, "rotor_inertia": 1.08e-6, "mass": 0.13}  # fmt: skip


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def command(name: str, content: str | bytes, *more: str):
        body = content.encode() if isinstance(content, str) else content
        (tmp_path / name).write_bytes(body)
        (tmp_path / "own.yaml").unlink(missing_ok=True)
        (tmp_path / "own.map.yaml").unlink(missing_ok=True)
        found = CliRunner().invoke(app, ["catalog", "import", name, "-o", "own.yaml", *more])
        if isinstance(found.exception, InputError):
            return SimpleNamespace(exit_code=2, output=f"{found.exception}\n")
        assert found.exit_code == 0, found.exception
        return found

    return command


def parts(tmp_path, section="motors"):
    return load(["own.yaml"], beside=tmp_path).table(section)


def workbook(*rows, other=()):
    file = io.BytesIO()
    book = xlsxwriter.Workbook(file)
    book.add_worksheet("Notes").write_column(0, 0, ["prices of May", *other])
    sheet = book.add_worksheet("Motors")
    for at, row in enumerate(rows):
        sheet.write_row(at, 0, row)
    book.close()
    return file.getvalue()


def pdf(text: str) -> bytes:
    """A page of text with a text layer, set in columns as data sheets are."""
    import typst

    source = f'#set page(width: 25cm)\n#set text(font: "DejaVu Sans Mono", size: 8pt)\n#raw(block: true, "{text}")'
    return typst.compile(source.encode(), format="pdf")


def keyed(rows):
    return "\n".join(f"{head}: {value}" for head, value in rows)


HEADS = ["Order no.", "Rated voltage [V]", "No-load speed [rpm]", "Rated torque [mNm]", "Rated current [A]",
         "Resistance [ohm]", "Kt [mNm/A]", "Rotor inertia [gcm2]", "Weight [g]"]  # fmt: skip
FIRST = ["4711", 24, 9560, 28.6, 1.3, 2.32, 23.4, 10.8, 130]
SECOND = ["4712", 48, 9500, 29.0, 0.65, 9.3, 47, 10.7, 131]
LIST = "\n".join([",".join(HEADS), ",".join(map(str, FIRST)), ",".join(map(str, SECOND))])
FILES = {
    "shop.csv": SHOP,
    "heads_with_units.csv": LIST,
    "german.csv": GERMAN,
    "german_cp1252.csv": GERMAN.encode("cp1252"),
    "german_utf16.csv": GERMAN.encode("utf-16"),
    "german_utf16_without_mark.csv": GERMAN.encode("utf-16-le"),
    "german_with_mark.csv": GERMAN.encode("utf-8-sig"),
    "excel_sep.csv": "sep=;\n" + GERMAN,
    "swiss.csv": GERMAN.replace("9.560", "9'560").replace("9.500", "9’500"),
    "tabs.tsv": GERMAN.replace(";", "\t"),
    "bars.txt": GERMAN.replace(";", " | "),
    "erp.csv": "Export 2026;;;\nSachnummer;Bezeichnung;;\n\n" + GERMAN,
    "quoted.csv": "\n".join(",".join(f'"{cell}"' for cell in line.split(";")) for line in GERMAN.splitlines()),
    "units_in_cells.csv": "Model,Voltage,No load speed,Rated torque,Rated current,Resistance,Kt,Inertia,Weight\n"
    "4711,24 V,9560 rpm,28.6 mN·m,1.3 A,2.32 Ω,0.0234 Nm/A,10.8 g·cm²,130 g\n"
    "4712,48 V,9500 rpm,29 mN·m,650 mA,9.3 Ω,0.047 Nm/A,10.7 g·cm²,0.131 kg\n",
    "book.xlsx": workbook(HEADS, FIRST, SECOND),
    "book_with_a_title.xlsx": workbook(["Motors of May"], [], HEADS, FIRST, SECOND),
    "lying.csv": "\n".join(f"{head},{a},{b}" for head, a, b in zip(HEADS, FIRST, SECOND, strict=True)),
    "lying_book.xlsx": workbook(*zip(HEADS, FIRST, SECOND, strict=True)),
    "names.json": json.dumps([{"name": "4711", **{head: {"magnitude": value, "unit": unit} for head, value, unit in (
        ("nominalVoltage", 24, "V"), ("freeSpeed", 9560, "rpm"), ("nominalTorque", 0.0286, "N*m"),
        ("nominalCurrent", 1.3, "A"), ("resistance", 2.32, "ohm"), ("kt", 0.0234, "N*m/A"),
        ("rotorInertia", 10.8, "g*cm^2"), ("weight", 130, "g"))}}]),
    "small_letters.json": json.dumps({"4711": {
        "nominal_voltage_v": 24, "free_speed_rpm": 9560, "rated_torque_nm": 0.0286, "rated_current_a": 1.3,
        "resistance_ohm": 2.32, "kt_mNm/A": 23.4, "rotor_inertia_gcm2": 10.8, "mass_g": 130}}),
    "sheet.txt": SHEET,
    "key_value.txt": keyed([("Model", "4711"), ("Rated voltage", "24 V"), ("No-load speed", "9560 rpm"),
                            ("Rated torque", "28.6 mNm"), ("Rated current", "1.3 A"), ("Resistance", "2.32 Ohm"),
                            ("Torque constant", "23.4 mNm/A"), ("Rotor inertia", "10.8 gcm²"), ("Weight", "130 g")]),
    "unit_last.txt": UNIT_LAST,
}  # fmt: skip
FILES["sheet.pdf"] = FILES["sheet.txt"]


@pytest.mark.parametrize("name", FILES)
def test_the_first_run_gives_a_catalogue(name, run, tmp_path):
    content = FILES[name]
    found = run(name, pdf(content) if name.endswith(".pdf") else content)
    assert found.exit_code == 0, found.output
    table = parts(tmp_path)
    motor = table.record(table.rows.get("4711", 0))
    printed = {one: value for one, value in MOTOR.items() if not (one == "mass" and "sheet" in name)}
    wrong = [one for one, value in printed.items() if getattr(motor, one) != pytest.approx(value, rel=1e-4)]
    assert not wrong and motor.part == "4711", found.output
    if len(table) > 1:
        assert table.record(table.rows["4712"]).nominal_current == pytest.approx(0.65)


OTHERS = {
    "gears.csv": ("gearheads", "Model;Ratio;Rated output torque [Nm];Max. acceleration torque [Nm];Efficiency [%];"
                  "Backlash [arcmin];Rated input speed [min-1];Moment of inertia [kgcm²]\nG5;5:1;14;25;97;15;"
                  "3000;0,135\n",
                  {"ratio": 5.0, "continuous_torque": 14.0, "intermittent_torque": 25.0, "efficiency": 0.97,
                   "backlash": 0.0043633, "continuous_input_speed": 314.159, "inertia": 1.35e-5}),
    "gearmotor.csv": ("actuators", "Item #,Gear Ratio,Rated Voltage,No-load speed @ 12V,Stall torque @ 12V,"
                      "Stall current @ 12V,No-load current @ 12V,Weight\n4753,70:1,12 V,150 RPM,27 kg·cm,5.5 A,"
                      "0.2 A,205 g\n",
                      {"ratio": 70.0, "no_load_speed": 15.708, "stall_torque": 2.6478, "stall_current": 5.5,
                       "no_load_current": 0.2}),
    "klipper.cfg": ("steppers", "[motor_constants any-42-2504]\nresistance: 1.2\ninductance: 0.0015\n"
                    "holding_torque: 0.55\nmax_current: 2.50\nsteps_per_revolution: 200\n",
                    {"part": "any-42-2504", "resistance": 1.2, "inductance": 0.0015, "holding_torque": 0.55,
                     "phase_current": 2.5, "full_steps": 200.0}),
    "stepper.csv": ("steppers", "Type,Step angle,Rated current [A],Holding torque [Ncm],Resistance [Ohm],"
                    "Inductance [mH],Rotor inertia [gcm²]\nST42,1.8°,1.68,44,1.65,2.8,54\n",
                    {"full_steps": 200.0, "holding_torque": 0.44, "rotor_inertia": 5.4e-6}),
    "robot.xml": ("motors", '<mujoco><actuator><dcmotor name="hip" joint="j" resistance="1.2" inductance="0.001"/>'
                  "</actuator></mujoco>", {"part": "hip", "resistance": 1.2, "inductance": 0.001}),
    "encoder.csv": ("encoders", "Order number;Lines per revolution;Max. operating frequency [kHz];Inertia [gcm²]\n"
                    "E1;500;100;0,6\n", {"counts_per_turn": 500.0, "max_frequency": 1e5, "inertia": 6e-8}),
    "drive.csv": ("controllers", "Part number,Supply voltage,Continuous output current,Peak current,"
                  "Ambient temperature\nC1,10 ... 50 V,5 A,15 A,-30…45 °C\n",
                  {"supply_min": 10.0, "supply_max": 50.0, "continuous_current": 5.0, "peak_current": 15.0,
                   "ambient_max": 318.15}),
    "outrunner.txt": ("motors", "Model          X5010\nKV             190\nResistance     45 mΩ\nWeight         230 g\n"
                      "Pole pairs     14\n",
                      {"part": "X5010", "speed_constant": 19.897, "resistance": 0.045, "pole_pairs": 14.0}),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_the_kind_of_part_is_found(name, run, tmp_path):
    section, text, figures = OTHERS[name]
    found = run(name, text)
    assert found.exit_code == 0, found.output
    part = parts(tmp_path, section).record(0)
    name = figures.pop("part", part.part)
    assert {one: getattr(part, one) for one in figures} == pytest.approx(figures, rel=1e-4), found.output
    assert part.part == name


def test_what_is_missing_is_said_once_with_what_it_is_for(run):
    found = " ".join(
        run("a.csv", "Type,Nominal voltage,Colour,Resistance [V],Kt [Nm/A]\nM1,24,red,2,-0.02\n").output.split()
    )
    assert "Nominal voltage (nominal voltage without a unit; write e.g. [V])" in found
    assert 'Resistance [V] ("V" is a unit of voltage, not of resistance)' in found
    assert "not understood, unknown now: line 2: Kt [Nm/A]: torque_constant" in found
    assert "resistance (voltage and heat)" in found and "manufacturer a (--manufacturer)" in found


def test_figures_that_contradict_are_shown(run):
    text = "Type,Voltage [V],No-load speed [rpm],Kt [mNm/A]\nM1,24,9560,234\n"
    assert "1 unexplained" in run("a.csv", text).output


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.csv", "", "expected a header"),
        ("a.csv", "just one line", "expected a header"),
        ("a.csv", "x,y\n1,2\n", "expected a header"),
        ("a.csv", b"\x81\x8f" * 100, "is no text"),
        ("a.xlsx", b"PK\x03\x04 no archive", "cannot be read as a workbook"),
        ("a.xls", b"\xd0\xcf\x11\xe0 old", "save it as .xlsx"),
        ("a.pdf", b"%PDF-1.4 nothing", "cannot be read as PDF"),
        ("a.json", "{", "is not JSON"),
        ("a.json", "[1, 2]", "expected a list of objects"),
        ("a.cfg", "[printer]\nx: 1\n", "no section"),
        ("a.xml", "<a>", "is not XML"),
        ("a.csv", "Type,Voltage [V],Kt [Nm/A]\nM1,24,1\nM1,24,2\n", 'part: "M1" is in line 2 too'),
    ],
)
def test_a_file_without_parts_is_one_line_and_writes_nothing(name, content, said, run, tmp_path):
    found = run(name, content)
    assert found.exit_code == 2 and said in found.output and found.output.count("\n") == 1
    assert not (tmp_path / "own.yaml").exists()


def test_the_map_of_a_guess_can_be_mended_and_used_again(run, tmp_path):
    said = ["--section", "motors", "--manufacturer", "Anymaker", "--document", "sheet", "--confidence", "quoted"]
    first = run("parts.csv", SHOP, *said)
    assert "Rated voltage" in first.output and "guessed" in first.output.lower()
    text, made = (tmp_path / "own.map.yaml").read_text(encoding="utf-8"), (tmp_path / "own.yaml").read_bytes()
    assert '"Colour": ~' in text and '"Kt": torque_constant' in text
    (tmp_path / "kept.yaml").write_text(text, encoding="utf-8")
    again = run("parts.csv", SHOP, "--section", "motors", "--map", "kept.yaml")
    assert again.exit_code == 0 and (tmp_path / "own.yaml").read_bytes() == made


def test_the_command_that_an_import_names_makes_the_same_again(run, tmp_path):
    """It was refused by the file of the first one, then for what the first one had assumed."""
    first = run("parts.csv", SHOP, "--set", "kind=brushed").output
    made, words = (tmp_path / "own.yaml").read_bytes(), re.search(r"again with (.*)", first)[1].split()
    (tmp_path / "own.yaml").write_text("mended")
    found = CliRunner().invoke(app, ["catalog", "import", "parts.csv", "-o", "own.yaml", *words])
    assert found.exit_code == 0 and (tmp_path / "own.yaml").read_bytes() == made
    refused = CliRunner().invoke(app, ["catalog", "import", "parts.csv", "-o", "own.yaml", *words[:-1]])
    assert "--replace writes over it" in str(refused.exception)


@pytest.mark.parametrize(
    ("unit", "kept"),
    [("$", ("foreign_price", 24.95, "USD")), ("GBP", ("foreign_price", 24.95, "GBP")),
     ("CHF", ("list_price", 24.95, "")), ("€", ("price", 24.95, ""))],
)  # fmt: skip
def test_a_price_keeps_its_currency(unit, kept, run, tmp_path):
    table = f"Order no.,Rated voltage,Unit price\n,V,{unit}\nM-1,12,24.95\n"
    assert run("parts.csv", table, "--section", "motors", "--set", "kind=brushed").exit_code == 0
    motor = parts(tmp_path).record(0)
    column, amount, currency = kept
    assert (getattr(motor, column), motor.currency, motor.kind) == (amount, currency, "brushed")


def test_parts_of_two_makers_go_together_and_are_sized(run, tmp_path):
    """A motor and a gearhead out of two files: what fits is assumed, said, and enough for a sizing."""
    motor = run(
        "motors.csv", LIST, "--manufacturer", "Anymaker", "--set", "kind=brushed", "--set", "shaft_diameter=4 mm"
    )
    assert "what fits is assumed at its end" in motor.output
    (tmp_path / "am.yaml").write_text((tmp_path / "own.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    gears = run(
        "gears.csv", f"{OTHERS['gears.csv'][1].splitlines()[0]}\nG5;5:1;14;25;97;15;6000;0,035\n", "--with", "am.yaml"
    )
    assert gears.exit_code == 0 and "{am: motors}" in (tmp_path / "own.yaml").read_text(encoding="utf-8")
    started = CliRunner().invoke(app, ["init", "--kind", "conveyor", "-o", "robot.yaml"])
    text = (tmp_path / "robot.yaml").read_text(encoding="utf-8").replace("12 kg", "1 kg")
    (tmp_path / "robot.yaml").write_text(
        re.sub("catalogs: .*", "catalogs: [am.yaml, own.yaml]", text), encoding="utf-8"
    )
    sized = CliRunner().invoke(app, ["size", "robot.yaml", "--json"])
    assert started.exit_code == 0 and "the closest rejected drive" not in sized.output and '"G5"' in sized.stdout
