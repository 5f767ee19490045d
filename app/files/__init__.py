"""What is read and written: drivers' pictures, results, tracks, and what an earlier run left of them."""
