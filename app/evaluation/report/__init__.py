"""The report of ``gemheads evaluate``: figures as plain values, pictures, and one page that needs nothing else."""
