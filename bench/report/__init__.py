"""Measures hmf and writes one report: see bench/README.md."""
