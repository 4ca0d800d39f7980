"""Exact reruns and verified results for Snakemake workflows.

An edit of code or settings runs those jobs again whose results it may change, and no others; a
result that is not what its job wrote is made again. docs/trust.md says what is guaranteed, and how
a workflow uses it:

* `snaketrust.project.Project`: what a workflow tells about its code;
* `snaketrust.start.start`: called in the Snakefile before any rule; it gives the config, the run
  and `Sources`, whose `fingerprint` makes the parameter ``code`` of each rule;
* `snaketrust.job.run_job`: called in each script around its work;
* `snaketrust.plan.planned`: a workflow as planned, to be looked at.

All that is done to Snakemake is in `snaketrust.hooks`.
"""
