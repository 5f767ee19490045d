"""A person's face to coefficients: track, feature, neutral, regress, smooth."""
