"""How far one picture is from another: NumPy in, one number or a map out."""
