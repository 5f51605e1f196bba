"""The certificate as XML: DCC 3.3.0 of PTB with D-SI 2.2.1 quantities.

The order of the elements is that of the schema. Proper names have no language; sentences are in English. For the
laboratory's own words no language is stated, because it is unknown.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from lxml import etree
from lxml.builder import ElementMaker

import zerorate

from ._quantity import COVERAGE_FACTOR, COVERAGE_PROBABILITY, Quantity
from ._statements import method_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ._content import Content
    from ._lab import Contact, Lab
    from ._results import AxisResult
    from ._statements import Statement

DCC = "https://ptb.de/dcc"
SI = "https://ptb.de/si"
XSI = "http://www.w3.org/2001/XMLSchema-instance"
LANGUAGE = "en"

D = ElementMaker(namespace=DCC, nsmap={"dcc": DCC, "si": SI, "xsi": XSI})
S = ElementMaker(namespace=SI, nsmap={"si": SI})

Element = Any
"""An element of lxml. The type is Any, because lxml has no type hints."""


def xml_of(content: Content) -> bytes:
    root = D.digitalCalibrationCertificate(
        _administrative(content), D.measurementResults(_measurement(content)), schemaVersion="3.3.0"
    )
    root.set(f"{{{XSI}}}schemaLocation", f"{DCC} https://ptb.de/dcc/v3.3.0/dcc.xsd")
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True))


def _administrative(content: Content) -> Element:
    lab = content.lab
    return D.administrativeData(
        D.dccSoftware(_software(f"zerorate {zerorate.__version__}")),
        _core(content),
        D.items(_item(content)),
        D.calibrationLaboratory(_contact("contact", lab.laboratory)),
        D.respPersons(*_persons(lab)),
        _contact("customer", lab.customer),
        D.statements(*(_statement(statement) for statement in content.statements)),
    )


def _core(content: Content) -> Element:
    lab, calibration = content.lab, content.calibration
    identifications = [_identification("calibrationLaboratory", calibration.id, "Calibration id")]
    if calibration.capture_sha256:
        name = "SHA-256 of the samples"
        identifications.append(_identification("calibrationLaboratory", calibration.capture_sha256, name))
    core = D.coreData(
        D.countryCodeISO3166_1(lab.laboratory.country),
        D.usedLangCodeISO639_1(LANGUAGE),
        D.mandatoryLangCodeISO639_1(LANGUAGE),
        D.uniqueIdentifier(lab.number),
        D.identifications(*identifications),
    )
    if lab.received is not None:
        core.append(D.receiptDate(lab.received.isoformat()))
    core.append(D.beginPerformanceDate(content.begin.isoformat()))
    core.append(D.endPerformanceDate(content.end.isoformat()))
    core.append(D.performanceLocation(lab.place))
    core.append(D.issueDate(lab.issued.isoformat()))
    if lab.replaces is not None:
        replaced = D.replacedUniqueIdentifier(lab.replaces.number)
        core.append(D.reportAmendedSubstituted(D.typeOfChange("substituted"), replaced))
    return core


def _item(content: Content) -> Element:
    item = content.lab.item
    return D.item(
        _text("name", content.item_name, LANGUAGE),
        _text("description", item.condition, None, name="Condition"),
        D.manufacturer(_text("name", item.manufacturer)),
        D.model(content.calibration.part),
        D.identifications(_identification("other", content.serial, "Serial number")),
    )


def _contact(tag: str, contact: Contact) -> Element:
    ways = [D(way, value) for way, value in (("eMail", contact.email), ("phone", contact.phone)) if value]
    location = D.location(
        D.city(contact.city), D.countryCode(contact.country), D.postCode(contact.postcode), D.street(contact.street)
    )
    return D(tag, _text("name", contact.name), *ways, location)


def _persons(lab: Lab) -> Iterable[Element]:
    for number, person in enumerate(lab.persons):
        signer = D.mainSigner("true" if number == 0 else "false")
        yield D.respPerson(D.person(_text("name", person.name)), D.role(person.role), signer)


def _statement(statement: Statement) -> Element:
    element = D.statement(_text("name", statement.name, LANGUAGE))
    if statement.traceable is not None:
        element.append(D.traceable("true" if statement.traceable else "false"))
    element.append(_text("declaration", statement.text, None if statement.own_words else LANGUAGE))
    return element


def _measurement(content: Content) -> Element:
    calibration = content.calibration
    return D.measurementResult(
        _text("name", f"{content.title}: bias of the rate over temperature, at rest", LANGUAGE),
        D.usedMethods(_method(content), _uncertainty_method()),
        D.usedSoftware(_software(calibration.software or "zerorate")),
        *_equipment(content),
        D.influenceConditions(*_conditions(content)),
        D.results(*(result for axis in content.axes for result in _results(axis))),
        D.measurementMetaData(*(_meta(warning) for warning in content.warnings or ["No warnings."])),
    )


def _method(content: Content) -> Element:
    name, description = method_of(content.calibration)
    return D.usedMethod(
        _text("name", name, LANGUAGE), _text("description", f"{description} {content.settings}", LANGUAGE)
    )


def _uncertainty_method() -> Element:
    return D.usedMethod(
        _text("name", "Expanded uncertainty", LANGUAGE),
        _text("description", f"U = k · u with k = {COVERAGE_FACTOR}, evaluated by the GUM.", LANGUAGE),
        D.norm("JCGM 100:2008"),
    )


def _equipment(content: Content) -> list[Element]:
    equipment = [
        D.measuringEquipment(
            _text("name", used.name), D.identifications(_identification("owner", used.id, "Inventory number"))
        )
        for used in content.lab.equipment
    ]
    return [D.measuringEquipments(*equipment)] if equipment else []


def _conditions(content: Content) -> Iterable[Element]:
    for quantity in [*content.measured_conditions, *content.lab.conditions]:
        yield D.influenceCondition(_text("name", quantity.name), D.data(_quantity(quantity)))
    for name, note in content.notes:
        yield D.influenceCondition(_text("name", name), D.data(_text("text", note, None, name=name)))


def _results(axis: AxisResult) -> Iterable[Element]:
    prefix = "" if axis.name is None else f"Axis {axis.name}: "
    coefficients = [*axis.coefficients, axis.t3, *axis.covariances]
    yield _result(f"{prefix}Bias correction", f"{axis.formula}.", map(_quantity, coefficients))
    columns = D.list(
        _column("Temperature of the part's own sensor", [point.temp for point in axis.curve]),
        _column("Correction", [point.correction for point in axis.curve]),
    )
    yield _result(f"{prefix}Correction over temperature", "To be added to the rate.", [columns])
    if axis.noise:
        text = "For information. Their uncertainty is not stated."
        yield _result(f"{prefix}Noise of the rate", text, map(_quantity, axis.noise))


def _result(name: str, description: str, data: Iterable[Element]) -> Element:
    return D.result(_text("name", name, LANGUAGE), _text("description", description, LANGUAGE), D.data(*data))


def _quantity(quantity: Quantity) -> Element:
    real = S.real(S.value(_number(quantity.value)), S.unit(quantity.unit.dsi))
    if quantity.expanded is not None:
        expanded = S.expandedMU(
            S.valueExpandedMU(_number(quantity.expanded)),
            S.coverageFactor(str(COVERAGE_FACTOR)),
            S.coverageProbability(str(COVERAGE_PROBABILITY)),
            S.distribution("normal"),
        )
        real.append(S.measurementUncertaintyUnivariate(expanded))
    return D.quantity(_text("name", quantity.name), real)


def _column(name: str, cells: list[Quantity]) -> Element:
    values = " ".join(_number(cell.value) for cell in cells)
    column = S.realListXMLList(S.valueXMLList(values), S.unitXMLList(cells[0].unit.dsi))
    uncertainties = [cell.expanded for cell in cells if cell.expanded is not None]
    if uncertainties:
        expanded = S.expandedMUXMLList(
            S.valueExpandedMUXMLList(" ".join(map(_number, uncertainties))),
            S.coverageFactorXMLList(str(COVERAGE_FACTOR)),
            S.coverageProbabilityXMLList(str(COVERAGE_PROBABILITY)),
            S.distributionXMLList("normal"),
        )
        column.append(S.measurementUncertaintyUnivariateXMLList(expanded))
    return D.quantity(_text("name", name), column)


def _meta(warning: str) -> Element:
    return D.metaData(_text("name", "Warning of the measurement", LANGUAGE), _text("declaration", warning, LANGUAGE))


def _software(full_name: str) -> Element:
    """A program. The Schematron accepts releases such as ``v0.1.0`` only, so the full name is the description."""
    name, _, version = full_name.partition(" ")
    release = re.match(r"\d{1,3}(\.\d{1,3}){0,3}", version)
    return D.software(
        _text("name", name),
        D.release(f"v{release[0] if release else '0'}"),
        D.type("application"),
        _text("description", full_name, LANGUAGE),
    )


def _identification(issuer: str, value: str, name: str) -> Element:
    return D.identification(D.issuer(issuer), D.value(value), _text("name", name, LANGUAGE))


def _text(tag: str, text: str, language: str | None = None, *, name: str | None = None) -> Element:
    """A text element. ``language`` is None if unknown, and for names; ``name`` is the heading of the text."""
    attributes = {} if language is None else {"lang": language}
    heading = [] if name is None else [_text("name", name, LANGUAGE)]
    return D(tag, *heading, D.content(text, **attributes))


def _number(value: float) -> str:
    """A double with all its digits, in a form that the decimal type of D-SI allows."""
    return repr(float(value))
