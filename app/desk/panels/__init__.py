"""What is drawn over and beside the avatar, one subject a file."""
