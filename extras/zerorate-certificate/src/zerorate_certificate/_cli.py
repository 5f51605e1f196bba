"""The program ``zerorate-certificate``."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from . import Lab, certificate_html, certificate_pdf, certificate_xml
from ._lab import EXAMPLE

FORMS = {
    ".html": lambda calibration, lab: certificate_html(calibration, lab).encode(),
    ".pdf": certificate_pdf,
    ".xml": certificate_xml,
}
"""The function that makes a certificate, by the ending of the output file."""

EPILOG = """\
examples:
  zerorate-certificate --example-lab > lab.toml
  zerorate-certificate unit.toml --lab lab.toml -o certificate.pdf
  zerorate-certificate unit.toml --lab lab.toml -o certificate.xml --force

The same calibration, laboratory and fonts give the same bytes. A simulated part's certificate says SIMULATED on each
page. README.md of the package says which demands of ISO/IEC 17025 are met and which are not.
"""


def main() -> int:
    """Runs the command line of this process. Returns the exit code: 0 done, 1 failed, 130 interrupted.

    argparse exits with 2 for wrong usage.
    """
    parser = _parser()
    options = parser.parse_args()
    if options.example_lab:
        sys.stdout.write(EXAMPLE.read_text(encoding="utf-8"))
        return 0
    _check_usage(parser, options)
    try:
        _write(options.calibration, options.lab, options.output, force=options.force)
    except (ValueError, OSError, ImportError) as error:
        print(f"error: {_one_line(error)}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        return 130
    print(f"Written to {options.output}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="zerorate-certificate",
        description="Write a calibration as a certificate: a page, PDF/A-3 with the digital certificate, or its XML",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("calibration", nargs="?", help="the calibration file, as `zerorate calibrate -o` wrote it")
    parser.add_argument("--lab", metavar="FILE", help="the laboratory's part: persons, customer, number (TOML)")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        help="the file to write. Its ending chooses the form: .html, .pdf (PDF/A-3b with the XML) or .xml (DCC 3.3.0)",
    )
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument("--example-lab", action="store_true", help="print a commented lab.toml to start from")
    return parser


def _check_usage(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    needed = {"the calibration file": options.calibration, "--lab": options.lab, "-o": options.output}
    missing = [name for name, value in needed.items() if value is None]
    if missing:
        advice = "`zerorate-certificate --example-lab` prints a lab.toml to start from"
        parser.error(f"missing: {', '.join(missing)}. {advice}")
    if options.output.suffix.lower() not in FORMS:
        parser.error(f"{options.output}: the ending chooses the form, and must be one of {', '.join(FORMS)}")


def _write(calibration: str, lab: str, output: Path, *, force: bool) -> None:
    if output.exists() and not force:
        raise FileExistsError(f"{output} exists: give --force to overwrite it")
    if not output.parent.is_dir():
        raise FileNotFoundError(f"the folder {output.parent} does not exist: create it first")
    _save(FORMS[output.suffix.lower()](calibration, Lab.load(lab)), output)


def _save(content: bytes, output: Path) -> None:
    """Writes the file under its name only when it is complete."""
    part = output.with_name(f".{output.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        part.replace(output)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(output)) from None
    finally:
        part.unlink(missing_ok=True)


def _one_line(error: Exception) -> str:
    """The error text in one line. For a failed system call it begins with the file name."""
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.filename}: {error.strerror}"
    return " ".join(str(error).split())
