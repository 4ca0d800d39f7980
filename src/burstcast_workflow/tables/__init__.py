"""The tables of a campaign: what each holds, what its columns mean, how it is typeset."""
