"""The plots, checked by the lines and texts in the axes of matplotlib."""

from __future__ import annotations

import html
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import zerorate

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_a_deviation_with_its_model_and_coefficients(tmp_path: Path) -> None:
    rate = np.random.default_rng(1).normal(size=20_000)
    found = zerorate.allan(rate, rate_hz=100.0)
    figure = found.plot()
    (ax,) = figure.axes
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert ax.get_xlabel() == "averaging time τ / s" and ax.get_ylabel() == "overlapping Allan deviation / °/s"
    legend = ax.get_legend()
    assert legend is not None and found.fit is not None
    labels = [text.get_text() for text in legend.get_texts()]
    of_n = f"N/√τ, N = {found.fit.n.value:.3g} °/s·√s"
    assert labels == ["rate, limits of 68.3 %", "model, and where it expects 95 % of other records", of_n]
    np.testing.assert_array_equal(np.asarray(ax.lines[0].get_ydata()), found.dev)
    figure.savefig(tmp_path / "allan.png")
    assert (tmp_path / "allan.png").read_bytes().startswith(b"\x89PNG")
    low, high = ax.get_ylim()
    assert found.lo.min() / 2 < low < found.lo.min() and found.hi.max() < high < 2 * found.hi.max()
    into = pyplot.figure().add_subplot()
    assert zerorate.allan(rate, rate_hz=100.0, stat="tdev").plot(into) is into.figure
    assert into.get_ylabel() == "time deviation / °/s·s"
    pyplot.close("all")
    with pytest.raises(ValueError, match="no deviation of rate is above zero"):
        zerorate.allan([1.0] * 1000, rate_hz=1.0).plot()
    assert not pyplot.get_fignums()


def test_all_axes_of_a_kind_are_in_one_picture() -> None:
    rest = np.random.default_rng(1).normal(size=(2000, 6))
    names = ["gx_dps", "gy_dps", "gz_dps", "ax_mg", "ay_mg", "az_mg"]
    figure = zerorate.imu(rest, rate_hz=100.0, columns=names).plot()
    assert [ax.get_title() for ax in figure.axes] == ["gyroscope", "accelerometer"]
    assert [ax.get_ylabel().rpartition(" ")[2] for ax in figure.axes] == ["°/s", "mg"]
    for ax, of_kind in zip(figure.axes, (names[:3], names[3:])):
        low, high = ax.get_ylim()
        assert high / low < 1e3  # the points set the limits; bands reach down to zero
        legend = ax.get_legend()
        assert legend is not None and [text.get_text() for text in legend.get_texts()] == of_kind
    table = dict(zip(names, rest.T))
    with pytest.raises(ValueError, match="units differ"):
        zerorate.allan(table, rate_hz=100.0, column="all").plot()


def test_a_notebook_shows_the_text_and_the_picture() -> None:
    rest = np.random.default_rng(1).normal(size=(2000, 3))
    imu = zerorate.imu({"gyro": 1e-3 * rest}, rate_hz=100.0, gyro_unit="rad/s")
    with pytest.warns(UserWarning, match="no checksum"):
        unit = zerorate.Calibration.parse(
            'schema = 1\npart = "ADIS16130"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n'
        )
    for shown, kind in ((imu, "png"), (imu.axes, "png"), (imu["gyro_x"], "png"), (unit, "svg+xml")):
        text, _, picture = shown._repr_html_().partition("</pre>")
        assert text == f"<pre>{html.escape(repr(shown))}"
        assert f"data:image/{kind};base64," in picture
    assert not pyplot.get_fignums()
    still = zerorate.allan([1.0] * 1000, rate_hz=1.0)
    assert "<img" not in still._repr_html_()


def test_a_result_fits_into_a_line() -> None:
    rest = np.random.default_rng(1).normal(size=2000)
    found = zerorate.allan(rest, rate_hz=100.0)
    assert repr(found.fit).startswith("<Fit N = 0.")
    for shown in (found, found.fit):
        assert "\n" not in repr(shown) and len(repr(shown)) < 160
