"""Runs tests of the package in this process, which a tool watches, and fails unless they call each native function.

    natives.py FOLDER

The folder is bindings/python/tests. Slow tests are left out, because they only compute more.
"""

import copy
import sys
import types

import numpy
import pytest
import zerorate
from zerorate import _zerorate

FILES = ["test_allan", "test_axes", "test_calibration", "test_compat", "test_imu", "test_records", "test_settling"]
SLOW = [
    "a_capture_that_follows", "a_warm_up", "an_array_has", "an_array_of_columns", "an_index", "columns_without",
    "ctrl_c", "each_axis_is_a_column", "every_axis", "inputs_of_every_kind", "logs_are_read",
    "other_threads", "tables", "term", "the_file_is_that", "the_unit_that", "what_is_in", "what_was_read",
    "white_noise",
]


def native():
    """Yields the name of each native function and method."""
    for name, value in vars(_zerorate).items():
        if isinstance(value, types.BuiltinFunctionType):
            yield name
        elif isinstance(value, type):
            yield from (f"{name}.{key}" for key, method in vars(value).items()
                        if isinstance(method, types.MethodDescriptorType))


class Called:
    """A plugin of pytest that notes the native functions that tests and fixtures call."""

    names = set()

    def note(self, _frame, event, function):
        if event == "c_call":
            self.names.add(function.__qualname__)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item):
        sys.setprofile(self.note)
        yield
        sys.setprofile(None)


def rest():
    """Calls the functions that tests call only in other processes, or only through Python's own functions."""
    model = zerorate.allan(numpy.sin(numpy.arange(4096.0) ** 2), rate_hz=100.0)._core
    return [
        model.__copy__() is model,
        model.__reduce__(),
        _zerorate.edf("oadev", 0, 4, 1000) > 0,
        _zerorate.finite_difference_edf(2, True, False, 0, 4, 1000) > 0,
        _zerorate.interval(1.0, 10.0, 0.9)[0] < 1,
        _zerorate.is_time("time_s"),
        _zerorate.statistics(),
        _zerorate.main(["zerorate", "parts", "ADIS16130"]) == 0,
    ]


if __name__ == "__main__":
    called = Called()
    tests = [f"{sys.argv[1]}/{name}.py" for name in FILES]
    options = ["-q", "-p", "no:cacheprovider", "-W", "ignore", "-k", "not (" + " or ".join(SLOW) + ")"]
    code = pytest.main([*options, *tests], plugins=[called])
    sys.setprofile(called.note)
    right = all(rest())
    sys.setprofile(None)
    missing = sorted(set(native()) - called.names)
    print(f"{len(set(native()))} native functions; not called: {missing or 'none'}")
    sys.exit(bool(code or missing or not right))
