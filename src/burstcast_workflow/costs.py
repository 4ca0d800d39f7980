"""What a job costs: memory and time from the size of its network, for schedulers."""

from collections.abc import Mapping

from burstcast_workflow.campaign import Campaign


def memory_mib(rule: str, campaign: Campaign, wildcards: Mapping[str, str], attempt: int) -> int:
    """Memory that a job asks for, in MiB, doubled at each retry."""
    neurons = int(wildcards.get("neurons", 0))
    base = {"simulate": 2500, "events": 1500, "test_set": 800}.get(rule, 400)
    return int((base + 4 * 8 * neurons**2 / 2**20) * 2 ** (attempt - 1))


def runtime_minutes(
    rule: str, campaign: Campaign, wildcards: Mapping[str, str], attempt: int
) -> int:
    """Time that a job asks for, in minutes, doubled at each retry."""
    neurons = int(wildcards.get("neurons", 0))
    return int((5 + neurons / 100) * 2 ** (attempt - 1))
