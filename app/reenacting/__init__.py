"""A driver in, an acting avatar out: whole videos, one after the other, and what is reported of them."""
