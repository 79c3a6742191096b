"""Planar mechanisms put together from the lengths of their links."""
