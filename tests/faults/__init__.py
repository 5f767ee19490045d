"""What goes wrong around the program: it is killed, the disk is full, memory runs out, files cannot be read."""
