"""A record of a warming part: the warnings of `zerorate.allan`, and its options for it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import zerorate


def run(folder: Path, *words: str) -> Any:
    command = [sys.executable, "-m", "zerorate", *words]
    done = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True, timeout=120)
    return json.loads(done.stdout) if "--json" in words else None


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("warming")
    device = ["--device", "twin:seed=4", "--duration", "40m", "--divider", "200"]
    run(folder, "capture", *device, "-o", "a.arrows")
    return folder


def warming(n: int = 20_000) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    temps = 25.0 + 8.0 * (1.0 - np.exp(-np.arange(n) / (n / 4)))
    return np.random.default_rng(5).normal(size=n) * 0.01 + 0.05 * (temps - 25.0), temps


def codes(texts: list[str]) -> list[str]:
    return [text.split(": ")[0] for text in texts]


def same(result: zerorate.Allan, report: Any) -> None:
    """Checks that K is the same as in the report of the command line."""
    assert result.fit is not None
    k = report["fit"]["k"]
    assert (result.fit.k.value, result.fit.k.lo, result.fit.k.hi) == pytest.approx((k["value"], k["lo"], k["hi"]))


def test_a_capture_that_follows_its_temperature_is_as_on_the_command_line(folder: Path) -> None:
    warned = zerorate.allan(folder / "a.arrows")
    assert warned.fit is not None and codes(warned.fit.warnings)[0] == "follows-temperature"
    assert "(detrend=1, skip=)" in warned.fit.warnings[0] and warned.detrended is None
    same(warned, run(folder, "allan", "a.arrows", "--fit", "--json"))

    detrended = zerorate.allan(folder / "a.arrows", detrend=1)
    report = run(folder, "allan", "a.arrows", "--fit", "--json", "--detrend", "temp")
    assert detrended.fit is not None and "follows-temperature" not in codes(detrended.fit.warnings)
    same(detrended, report)
    taken, said = detrended.detrended, report["detrend"]
    assert taken is not None and (taken.order, taken.lost_dof) == (1, 1)
    told = [taken.coefficients[0], taken.mean_c, taken.explained, taken.walk_kept]
    others = [said[key] for key in ("mean_c", "explained", "walk_kept")]
    assert told == pytest.approx([said["coefficients"][0], *others])
    points = [(point["edf"], point["hi"]) for point in report["points"]]
    assert list(zip(detrended.edf.tolist(), detrended.hi.tolist())) == [pytest.approx(point) for point in points]

    skipped = zerorate.allan(folder / "a.arrows", skip="30m")
    assert skipped.skipped_s == pytest.approx(1800.0, abs=0.01)
    same(skipped, run(folder, "allan", "a.arrows", "--fit", "--json", "--skip", "30m"))


def test_the_read_samples_equal_those_on_disk(folder: Path) -> None:
    capture = zerorate.read_capture(folder / "a.arrows")
    warned, detrended = zerorate.allan(capture), zerorate.allan(capture, detrend=2)
    assert warned.fit is not None and codes(warned.fit.warnings)[0] == "follows-temperature"
    on_disk = zerorate.allan(folder / "a.arrows", detrend=2)
    assert detrended.detrended is not None and on_disk.detrended is not None
    assert detrended.detrended.coefficients == pytest.approx(on_disk.detrended.coefficients, rel=1e-6)
    np.testing.assert_allclose(detrended.dev, on_disk.dev, rtol=1e-5)


def test_an_array_has_its_temperature_beside_it() -> None:
    rate, temps = warming()
    alone = zerorate.allan(rate, rate_hz=10.0)
    assert alone.fit is not None and "follows-temperature" not in codes(alone.fit.warnings)
    warned = zerorate.allan(rate, rate_hz=10.0, temp_c=temps)
    assert warned.fit is not None and codes(warned.fit.warnings)[0] == "follows-temperature"
    result = zerorate.allan(rate, rate_hz=10.0, temp_c=temps, detrend=1)
    assert result.fit is not None and "follows-temperature" not in codes(result.fit.warnings)
    assert result.fit.n.lo < 0.01 / 10**0.5 < result.fit.n.hi
    assert result.detrended is not None
    assert result.detrended.coefficients == [pytest.approx(0.05, rel=0.01)]
    assert result.detrended.mean_c == pytest.approx(temps.mean(), abs=1e-3) and result.detrended.explained > 0.99
    no_fit = zerorate.allan(rate, rate_hz=10.0, temp_c=temps, fit=False)
    assert codes(no_fit.warnings) == ["follows-temperature"]
    late = zerorate.allan(rate, rate_hz=10.0, skip=1500)
    assert (late.samples, late.skipped_s) == (5000, 1500.0)
    np.testing.assert_array_equal(late.dev, zerorate.allan(rate[15_000:], rate_hz=10.0).dev)


def test_tables_and_logs_have_it_in_a_column(tmp_path: Path) -> None:
    rate, temps = warming(4000)
    expected = zerorate.allan(rate, rate_hz=10.0, temp_c=temps, detrend=1)
    table = {"gz_dps": rate, "temp_c": temps, "kelvin": temps + 273.15}
    rows = [f"{of_rate!r},{of_temp!r}\n" for of_rate, of_temp in zip(rate.tolist(), temps.tolist())]
    (tmp_path / "log.csv").write_text("gz_dps,temp_c\n" + "".join(rows))
    log = zerorate.read_log(tmp_path / "log.csv", rate_hz=10.0)
    unnamed = {"gz_dps": rate}
    found = [
        zerorate.allan(table, rate_hz=10.0, column="gz_dps", detrend=1),
        zerorate.allan(table, rate_hz=10.0, column="gz_dps", detrend=1, temp_c="kelvin"),
        zerorate.allan(unnamed, rate_hz=10.0, column="gz_dps", detrend=1, temp_c=temps),
        zerorate.allan(log, column="gz_dps", detrend=1),
        zerorate.allan(tmp_path / "log.csv", rate_hz=10.0, column="gz_dps", detrend=1),
        zerorate.allan(rate[:, None], columns=["z"], rate_hz=10.0, detrend=1, temp_c=temps)["z"],
    ]
    for result in found:
        assert result.detrended is not None and expected.detrended is not None
        assert result.detrended.coefficients == pytest.approx(expected.detrended.coefficients, rel=1e-9)
        np.testing.assert_allclose(result.dev, expected.dev, rtol=1e-9)


@pytest.mark.parametrize(
    ("match", "options"),
    [
        ("give temp_c=", {"detrend": 1}),
        ("detrend=4", {"detrend": 4, "temp_c": [20.0] * 1000}),
        ("same all the time", {"detrend": 1, "temp_c": [20.0] * 1000}),
        ("temp_c has 2 values for 1000 samples", {"temp_c": [20.0, 21.0]}),
        ("name of a column", {"temp_c": "t"}),
        ("data='phase'", {"detrend": 1, "data": "phase"}),
        ("skip= leaves nothing", {"skip": "1h"}),
        ("skip=soon", {"skip": "soon"}),
    ],
)
def test_impossible_requests_are_refused(match: str, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=match):
        zerorate.allan(np.random.default_rng(1).normal(size=1000), rate_hz=1.0, **options)


def test_a_log_without_the_column_says_so(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("gz_dps,x\n" + "0.1,2\n0.2,3\n" * 500)
    cases: list[dict[str, Any]] = [{"detrend": 1}, {"temp_c": "t"}]
    for options, match in zip(cases, ["temp_code, temp_c", "no column 't'"]):
        with pytest.raises(ValueError, match=match):
            zerorate.allan(tmp_path / "log.csv", rate_hz=10.0, column="gz_dps", **options)
