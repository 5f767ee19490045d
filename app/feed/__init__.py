"""The capture thread: from a source, a face and an avatar to the newest shot, which the window takes when it likes."""
