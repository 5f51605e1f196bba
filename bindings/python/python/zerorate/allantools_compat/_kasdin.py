"""Power-law noise of a stated discrete variance."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class _Law(NamedTuple):
    """The deviations of a frequency density h f^α: σ² = coefficient · h · τ^exponent."""

    avar_exponent: float
    mvar_exponent: float
    avar: Callable[[float, float], float]
    """A function of the highest frequency and τ."""
    mvar: float
    pvar: float


_PI2 = math.pi**2
_EULER = 0.577_215_664_901_532_9

# Dawkins, McFerran, Luiten (IEEE UFFC 54, 2007) and Vernotte et al. (IEEE UFFC 63, 2016) table I; the flicker
# frequency of MVAR: Benkler, Lisdat, Sterr (Metrologia 52, 2015) table 1
_LAWS = {
    0: _Law(-2.0, -3.0, lambda fh, _: 3 * fh / (4 * _PI2), 3 / (8 * _PI2), 3 / (2 * _PI2)),
    -1: _Law(
        -2.0,
        -2.0,
        lambda fh, tau: (3 * _EULER - math.log(2) + 3 * math.log(2 * math.pi * fh * tau)) / (4 * _PI2),
        (24 * math.log(2) - 9 * math.log(3)) / (8 * _PI2),
        (3 * math.log(16) - 1) / (2 * _PI2),
    ),
    -2: _Law(-1.0, -1.0, lambda *_: 1 / 2, 1 / 4, 3 / 5),
    -3: _Law(0.0, 0.0, lambda *_: 2 * math.log(2), 27 / 20 * math.log(2), 2 * (7 - math.log(16)) / 5),
    -4: _Law(1.0, 1.0, lambda *_: 2 * _PI2 / 3, 11 / 20 * _PI2, 26 / 35 * _PI2),
}


class Noise:
    """A phase with power-law noise, by N. J. Kasdin and T. Walter (IEEE Frequency Control Symposium 1992).

    It is drawn from numpy's global generator.

    Parameters
    ----------
    nr
        Samples.
    qd
        Discrete variance.
    b
        Exponent of the density of the phase: 0 white phase, −1 flicker phase, −2 white frequency, −3 flicker
        frequency, −4 random walk frequency. The deviations are known for these alone.
    """

    def __init__(self, nr: int = 2, qd: float = 1, b: float = 0) -> None:
        self.time_series: NDArray[np.float64] = np.array([])
        self.set_input(nr, qd, b)

    def set_input(self, nr: int = 2, qd: float = 1, b: float = 0) -> None:
        """Sets other parameters."""
        self.nr, self.qd, self.b = nr, qd, b

    def generateNoise(self) -> None:
        """Draws `time_series`."""
        drawn = np.random.normal(0, np.sqrt(self.qd), self.nr)
        lag = np.arange(1, self.nr)
        response = np.concatenate([[1.0], np.multiply.accumulate((lag - 1 - self.b / 2) / lag)])
        long = 2 * self.nr
        spectrum = np.fft.rfft(drawn, long) * np.fft.rfft(response, long)
        self.time_series = np.fft.irfft(spectrum, long)[: self.nr]

    def phase_psd_from_qd(self, tau0: float = 1.0) -> float:
        """g of the one-sided density g f^b of the phase, of samples `tau0` apart."""
        return float(self.qd * 2 * (2 * math.pi) ** self.b * tau0 ** (self.b + 1.0))

    def frequency_psd_from_qd(self, tau0: float = 1.0) -> float:
        """h of the one-sided density h f^(b + 2) of the frequency."""
        a = self.b + 2.0
        return float(self.qd * 2 * (2 * math.pi) ** a * tau0 ** (a - 1.0))

    def adev(self, tau0: float, tau: float) -> float:
        """The expected Allan deviation at `tau`."""
        return self.adev_from_qd(tau0, tau) * math.pow(tau, self.c_avar() / 2)

    def mdev(self, tau0: float, tau: float) -> float:
        """The expected modified Allan deviation at `tau`."""
        return self.mdev_from_qd(tau0, tau) * math.pow(tau, self.c_mvar() / 2)

    def c_avar(self) -> float:
        """Exponent of τ in the Allan variance."""
        return self._law.avar_exponent

    def c_mvar(self) -> float:
        """Exponent of τ in the modified Allan variance."""
        return self._law.mvar_exponent

    def adev_from_qd(self, tau0: float = 1.0, tau: float = 1.0) -> float:
        """The Allan deviation without its power of τ."""
        return math.sqrt(self._law.avar(0.5 / tau0, tau) * self.frequency_psd_from_qd(tau0))

    def mdev_from_qd(self, tau0: float = 1.0, tau: float = 1.0) -> float:
        """The modified Allan deviation without its power of τ."""
        return math.sqrt(self._law.mvar * self.frequency_psd_from_qd(tau0))

    def pdev_from_qd(self, tau0: float = 1.0, tau: float = 1.0) -> float:
        """The parabolic deviation without its power of τ."""
        return math.sqrt(self._law.pvar * self.frequency_psd_from_qd(tau0))

    @property
    def _law(self) -> _Law:
        if self.b not in _LAWS:
            raise ValueError(f"b={self.b}: deviations are known for b = 0, -1, -2, -3, -4")
        return _LAWS[int(self.b)]
