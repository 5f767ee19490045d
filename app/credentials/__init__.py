"""Content credentials (C2PA): what a result says about itself, signed with a key of this computer, offline."""
