"""Validation suites: every must-hold as a list of checks, in full and in a reduced form.

`sh run validate [NAME]` runs them in full and writes reports/validation/NAME.csv; the tests run the
reduced form. One module a suite, with `checks(full)` giving its checks.
"""
