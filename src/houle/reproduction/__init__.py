"""`houle reproduce PAPER`: the runs, figures and numbers of a paper, as far as it can be computed again, on one page.

A paper is a folder here: plan.toml (what to run), case files, the numbers it prints (CSV), page.md (the words). The
runs go through houle.run; every number of the page is read out of them, or out of the CSV.
"""
