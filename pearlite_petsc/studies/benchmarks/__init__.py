"""Benchmarks: what each choice of method costs and what it is worth; one module a subcommand."""
