"""The cheapest model that answers a question to an accuracy, with an estimate that says so."""
