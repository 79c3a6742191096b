"""Answers to plain questions without what takes long to load: the parser of options, arrays, the reader of YAML."""
