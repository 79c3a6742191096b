"""Data to bytes: tables for eyes, JSON, JSON lines and CSV for programs; where the bytes go."""
