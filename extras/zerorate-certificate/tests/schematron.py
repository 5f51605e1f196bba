"""Schematron with XSLT 2 expressions, as far as the file for the DCC uses it: patterns, rules, asserts, reports."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree
from lxml.builder import ElementMaker
from saxonche import PySaxonProcessor

SCH = "{http://purl.oclc.org/dsdl/schematron}"
X = ElementMaker(
    namespace="http://www.w3.org/1999/XSL/Transform",
    nsmap={"xsl": "http://www.w3.org/1999/XSL/Transform", "xs": "http://www.w3.org/2001/XMLSchema"},
)


def complaints(document: bytes, schematron: Path) -> list[tuple[str, str]]:
    """Role and text of each failed assert and each successful report, except those of the role "information"."""
    with PySaxonProcessor(license=False) as saxon:
        program = saxon.new_xslt30_processor().compile_stylesheet(stylesheet_text=_stylesheet(schematron))
        result = program.transform_to_string(xdm_node=saxon.parse_xml(xml_text=document.decode()))
    entries = etree.fromstring(result.encode())
    found = [(entry.get("role"), " ".join("".join(entry.itertext()).split())) for entry in entries]
    return [(role, text) for role, text in found if role != "information"]


def rules_of(schematron: Path) -> int:
    return len(list(etree.parse(str(schematron)).iter(f"{SCH}rule")))


def _stylesheet(schematron: Path) -> str:
    source = etree.parse(str(schematron)).getroot()
    patterns = list(source.iter(f"{SCH}pattern"))
    calls = [X("apply-templates", select="/", mode=f"p{number}") for number in range(len(patterns))]
    sheet = X.stylesheet(X.template(X("element", *calls, name="found"), match="/"), version="2.0")
    for number, pattern in enumerate(patterns):
        sheet.extend(_templates(pattern, f"p{number}"))
    text: str = etree.tostring(sheet, encoding="unicode")
    spaces = " ".join(f'xmlns:{ns.get("prefix")}="{ns.get("uri")}"' for ns in source.iter(f"{SCH}ns"))
    return text.replace("<xsl:stylesheet", f"<xsl:stylesheet {spaces}", 1)


def _templates(pattern: Any, mode: str) -> list[Any]:
    """A template for each rule. Only the first rule that matches a node applies, so earlier rules have priority."""
    rules = pattern.findall(f"{SCH}rule")
    shared = [_let(let) for let in pattern.findall(f"{SCH}let")]
    walk = X("apply-templates", select="@*|node()", mode=mode)
    templates = [
        X.template(walk, match="node()|/", mode=mode, priority="-9"),
        X.template(match="@*", mode=mode, priority="-9"),
    ]
    for place, rule in enumerate(rules):
        checks = [_check(check) for check in rule if check.tag in (f"{SCH}assert", f"{SCH}report")]
        lets = [*shared, *(_let(let) for let in rule.findall(f"{SCH}let"))]
        again = X("apply-templates", select="@*|node()", mode=mode)
        body = [*(etree.fromstring(etree.tostring(let)) for let in lets), *checks, again]
        templates.append(X.template(*body, match=rule.get("context"), mode=mode, priority=str(len(rules) - place)))
    return templates


def _let(let: Any) -> Any:
    return X.variable(name=let.get("name"), select=let.get("value"))


def _check(check: Any) -> Any:
    test = check.get("test") if check.tag == f"{SCH}report" else f"not({check.get('test')})"
    entry = X("element", X.attribute(check.get("role"), name="role"), X.text(check.text or ""), name="entry")
    for value in check.findall(f"{SCH}value-of"):
        entry.append(X("value-of", select=value.get("select")))
        entry.append(X.text(value.tail or ""))
    return X("if", entry, test=test)
