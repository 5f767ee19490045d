"""The shipped face networks, rebuilt from their registry package: a tool, nothing that runs beside an avatar."""
