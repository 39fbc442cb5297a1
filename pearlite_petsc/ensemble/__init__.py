"""Tasks over rank groups, queue, checkpoints."""
