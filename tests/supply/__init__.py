"""What gemheads is made of besides itself: licences, hashes, and the list of it all."""
