"""What this machine does in how much time: drawing by stage, and the live loop read back from the screen."""
