"""Analysis by synthesis: coefficients fitted to pictures, bases refined on them, an avatar with gradients."""
