"""What is read and written: drivers as pictures, results, and what an earlier run left of them."""
