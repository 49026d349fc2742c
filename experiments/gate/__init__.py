"""The gate: a small suite held against committed references and limits, so that a change that spoils it is seen.

`references` keeps the truth in the repository, `agreement` estimates one of them anew in each run, `limits` says how
far a value may be from the one that was measured, `verdicts` holds a run against that, and `mutations` spoils the
shaders on purpose to show that it would be seen.
"""
