"""Reference solutions that do not use `der`.

One module a problem, each with functions to call from a test and `references()`, the list
of numbers kept in `values.json`. `python -m references.generate`, started in
`tests/validation`, recomputes that file and prints the comparison with the quoted numbers.
"""
