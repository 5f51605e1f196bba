"""Runs cases of Autobahn's test suite, which needs Python 2.7, against a server that does not echo.

The suite expects an echo of each message. The page's server answers each text with a text of its own, and sends binary
frames unasked. So its n-th text counts as the n-th echo, and its binary frames are ignored. All other checks are the
suite's own.

Prints a line of JSON to stderr for each case: its id, the suite's verdicts, and how the connection was closed.
Arguments: the folder where the suite is installed, the address, the cases, and those to leave out.
"""

import json
import site
import sys

site.addsitedir(sys.argv[1])

from twisted.internet import reactor

from autobahntestsuite import fuzzing

OURS = fuzzing.FuzzingProtocol.onMessage


def echo(case):
    """The payload of the next message that the suite expects; asterisks if the case lists no further message."""
    received = sum(1 for event in case.received if event[0] == "message")
    messages = [event for event in case.expected.get(case.OK, []) if event[0] == "message"]
    if received < len(messages):
        return messages[received][1]
    return "*" * getattr(case, "DATALEN", 0)


def on_message(self, payload, binary):
    if not binary:
        OURS(self, echo(self.runCase), False)


def log_case(self, result):
    names = {"case": "id", "behavior": "behavior", "closing": "behaviorClose", "code": "remoteCloseCode"}
    line = dict((name, result[key]) for name, key in names.items())
    line["what"] = result["result"] + "; " + result["resultClose"]
    sys.stderr.write(json.dumps(line) + "\n")


fuzzing.FuzzingProtocol.onMessage = on_message
fuzzing.FuzzingFactory.logCase = log_case
fuzzing.FuzzingFactory.createReports = lambda self: None
url, chosen, left_out = sys.argv[2], sys.argv[3].split(","), sys.argv[4].split(",")
fuzzing.startClient({"servers": [{"url": url}], "cases": chosen, "exclude-cases": left_out})
reactor.run()
