"""Derivatives of an equilibrium: adjoint gradients, responses to forces, and sensitivities to friction."""
