"""Validate a crate against the Provenance Run Crate profile, without a network.

Run by an environment of requirements-provenance.lock: ``python validate_crate.py DIRECTORY``. The
one document that the validator would fetch, the terms of RO-Crate 1.1, comes from rocrate.
"""

import importlib.resources
import json
import sys

import requests
from rocrate_validator import models, services
from rocrate_validator.utils.http import HttpRequester

CONTEXT = "https://w3id.org/ro/crate/1.1/context"


def offline(self, url, **options):
    """Answer to a request: the terms, or that nothing else can be had."""
    answer = requests.Response()
    answer.url, answer.status_code = str(url), 504
    if str(url) == CONTEXT:
        terms = importlib.resources.files("rocrate") / "data" / "ro-crate.jsonld"
        answer.status_code, answer._content = 200, terms.read_bytes()
        assert json.loads(answer.content)["@id"] == CONTEXT
        answer.headers["Content-Type"] = "application/ld+json"
    return answer


HttpRequester.get = HttpRequester.head = offline
found = services.validate(
    services.ValidationSettings(
        rocrate_uri=sys.argv[1],
        profile_identifier="provenance-run-crate",
        requirement_severity=models.Severity.REQUIRED,
        offline=True,
    )
)
for issue in found.get_issues():
    print(issue.check.identifier, issue.message)
sys.exit(not found.passed())
