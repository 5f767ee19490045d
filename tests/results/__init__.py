"""What report.json files of ``gemheads evaluate`` say, as the tables of docs/results.md."""
