"""The atlas: how wrong each airlight model is, over optical distance and length, and what it costs.

`grid` says which segments are looked at, `errors` what is measured on them, `counting` and `timing` what a segment
costs, `figures` and `page` how it is shown; `atlas` puts them together. Every model of `analytic.MODELS` takes part; a
new one needs no change here.
"""
