"""What every damage law, spring law and cycle jump must fulfil, on one interface or a small mesh."""
