"""The page about a population: numbers computed by hand, and rows with known faults."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from zerorate import fleet
from zerorate.fleet import _pictures, _population
from zerorate.fleet._row import AXIS_NAMES, SCHEMA


def row(index: int, **other: Any) -> dict[str, Any]:
    """The row of a calibration of sensor ``index``. PBC is a random number that depends on the index only."""
    pbc_dps = float(np.random.default_rng(index).normal(0.0, 0.5))
    found: dict[str, Any] = dict.fromkeys(SCHEMA.names)
    found.update(key=f"k{index}", url=f"u{index}.arrows", serial=f"SN{index}", part="ADIS16130", state="ok", code="")
    found.update(
        capture_sha256=f"c{index}", program="zerorate", ended=index, warnings=["earth-included: …"], simulated=False
    )
    found.update(pbc_dps=pbc_dps, u_pbc_dps=0.01, btc_dps_per_c=-0.04, u_btc_dps_per_c=0.001, t3_c=30.0)
    found.update(cov_pbc_btc_dps2_per_c=0.0, temp_min_c=25.0, temp_max_c=35.0, method="an1042", axes=[])
    return {**found, **other}


def write(folder: Path, rows: list[dict[str, Any]]) -> None:
    pq.write_table(pa.Table.from_pylist(rows, schema=SCHEMA), folder / "rows.parquet")


def page_of(folder: Path, **options: Any) -> str:
    fleet.report(str(folder), str(folder / "page.html"), **options)
    return (folder / "page.html").read_text(encoding="utf-8")


def test_robust_z_by_hand() -> None:
    # the median is 3, the absolute deviations are 2 1 0 1 97, and their median (MAD) is 1
    z = _population.robust_z(np.array([1.0, 2.0, 3.0, 4.0, 100.0]))
    assert z == pytest.approx(np.array([-2, -1, 0, 1, 97]) / 1.4826)
    assert not _population.robust_z(np.array([1.0, 1.0, 1.0, 2.0])).any()


def test_a_trend_by_hand() -> None:
    x = np.arange(8.0)
    found = _population.trend(x, 2.0 * x + np.array([1, -1, 1, -1, -1, 1, -1, 1]))
    assert found is not None and found.is_seen
    # the residuals are orthogonal to x, so that slope and sum of squares are exact: u² = 8 / 6 / 42
    assert (found.slope, found.u_slope) == pytest.approx((2.0, np.sqrt(8 / 6 / 42)))
    assert _population.trend(x[:7], x[:7]) is None


def test_serial_numbers_are_in_the_order_of_their_numbers() -> None:
    serials = ["", "7", "10", "A1-05", "A1-9", "A2-1", "A10-1", "B"]
    shuffled = [row(index, serial=serial) for index, serial in enumerate(reversed(serials))]
    assert [shuffled[place]["serial"] for place in _pictures._by_serial(shuffled)] == serials


def test_names_do_nothing_to_a_page_or_to_its_reader(tmp_path: Path) -> None:
    name = "html<img src=x onerror=alert(1)>\x1b[31m\u202etxt.csv"
    write(tmp_path, [*map(row, range(20)), row(20, url=name, pbc_dps=1e3), row(21, url="copy", capture_sha256="c20")])
    page = page_of(tmp_path)
    shown = "html&lt;img src=x onerror=alert(1)&gt;\\u{1b}[31m\\u{202e}txt.csv"
    assert page.count(shown) == 2, "as an outlier, and as the original of a copy"
    assert "<img" not in page and "\x1b" not in page and page.count("<svg") > 2


def test_repeats_that_disagree_are_named() -> None:
    first = row(1)
    # at 30 °C both have u = 0.01, so that 95 % of differences are below 1.96 · √2 · 0.01 = 0.0277
    for difference, disagree in ((0.0277, False), (0.0278, True)):
        second = row(2, serial="SN1", pbc_dps=first["pbc_dps"] + difference)
        found = _population.disagreements([first, second])
        assert [pair.serial for pair in found] == (["SN1"] if disagree else [])
    same_samples = {**second, "capture_sha256": first["capture_sha256"]}
    assert not _population.disagreements([first, same_samples])


def test_the_uncertainty_grows_away_from_t3() -> None:
    first = row(1)
    # both at 50 °C, 20 °C from T3: u² = 0.01² + (20 · 0.001)², and 1.96 √(2 u²) = 0.0620
    far = {"temp_min_c": 49.0, "temp_max_c": 51.0}
    near_limit = {**row(2), "serial": "SN1", **far, "pbc_dps": first["pbc_dps"] + 0.0619}
    assert not _population.disagreements([{**first, **far}, near_limit])
    assert _population.disagreements([{**first, **far}, {**near_limit, "pbc_dps": first["pbc_dps"] + 0.0621}])


def test_the_page_shows_outliers_repeats_and_states(tmp_path: Path) -> None:
    rows = [row(index) for index in range(1, 61)]
    rows[6]["pbc_dps"] = 9.0
    rows += [row(101, serial="SN20", pbc_dps=rows[19]["pbc_dps"] + 0.1), row(102, state="refused", code="noisy")]
    rows.append(row(103, state="failed", code="exit-1", error="u103.arrows cannot be read: it is empty"))
    rows.append({**row(3, pbc_dps=7.0), "ended": -1})  # an older row of the same file
    write(tmp_path, rows)
    page = page_of(tmp_path, group="method")
    words = ("noisy", "exit code 1", "it is empty", "63 captures of 62 sensors")
    for text in ("SN7", "9 °/s", "SN20", "an1042 (", "data sheet", *words):
        assert text in page, text
    assert "SIMULATED" not in page and "<svg" in page
    assert 'src="' not in page and 'href="http' not in page  # the page needs no network


def axis(name: str, index: int, **other: Any) -> dict[str, Any]:
    """An axis of sensor ``index``, with a noise level that depends on its name and slightly on the index."""
    n = {"x": 0.01, "y": 0.02, "acc": 0.003}[name] * (1 + 0.001 * index)
    unit = "m/s²" if name == "acc" else "°/s"
    return {**dict.fromkeys(AXIS_NAMES), "name": name, "unit": unit, "n": n, "n_lo": n, "n_hi": n, **other}


def test_the_axes_of_a_part_are_judged_one_by_one(tmp_path: Path) -> None:
    rows = [
        row(index, pbc_dps=None, btc_dps_per_c=None, axes=[axis("x", index), axis("y", index), axis("acc", index)])
        for index in range(1, 21)
    ]
    rows[6]["axes"][0]["n"] = 0.02  # usual for y, but an outlier among x
    calibrated = {"pbc_dps": 0.1, "u_pbc_dps": 0.01, "btc_dps_per_c": 0.0, "u_btc_dps_per_c": 0.001, "t3_c": 30.0}
    rows[1]["axes"][1].update(calibrated)
    again = [axis("x", 2), axis("y", 2, **{**calibrated, "pbc_dps": 0.2})]
    rows.append(row(30, serial="SN2", pbc_dps=None, btc_dps_per_c=None, axes=again))
    write(tmp_path, rows)
    page = page_of(tmp_path)
    assert "<td>SN7</td><td>Angle random walk N, axis x</td><td>1.2 °/√h</td>" in page
    assert "<td>SN2, axis y</td>" in page and "Velocity random walk N" in page
    assert "42 values" in page and "20 values" in page, "two gyroscopes and an accelerometer of 20 units, and a repeat"


def test_a_copy_of_a_recording_counts_once(tmp_path: Path) -> None:
    write(tmp_path, [row(index) for index in range(1, 10)] + [row(50, capture_sha256="c9", pbc_dps=9.0)])
    page = page_of(tmp_path)
    assert "<td>u50.arrows</td><td>u9.arrows</td>" in page and "9 values" in page and "9 °/s" not in page
    assert "about 9 captures" in page


def test_one_capture_is_one_on_the_page(tmp_path: Path) -> None:
    write(tmp_path, [row(1, simulated=True, k=1.25e-5, k_lo=1e-5)])
    page = page_of(tmp_path)
    assert "1 capture of 1 sensor," in page and "1 value;" in page and "1 captures" not in page


def test_a_simulated_population_says_so(tmp_path: Path) -> None:
    write(tmp_path, [row(1, simulated=True), row(2, serial="<script>")])
    page = page_of(tmp_path)
    assert "SIMULATED: 1 of 2" in page and "<script>" not in page


def test_each_error_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="`zerorate fleet table` makes it"):
        page_of(tmp_path)
    write(tmp_path, [row(1)])
    with pytest.raises(ValueError, match="no column colour; it has key, url"):
        page_of(tmp_path, group="colour")
    page_of(tmp_path)
    with pytest.raises(ValueError, match="--force"):
        page_of(tmp_path)
    output = str(tmp_path / "none" / "x.html")
    command = [sys.executable, "-m", "zerorate", "fleet", "report", str(tmp_path), "-o", output]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.startswith("error: ") and "Traceback" not in done.stderr
