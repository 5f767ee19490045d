"""What ``gemheads`` can be told to do; what a command needs is imported when it runs, so that --help is instant."""
