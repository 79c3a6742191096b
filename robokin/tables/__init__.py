"""Rows from files and pipes: CSV, JSON lines and arrays, each read in one place.

`text` cuts a stream into lines, `records` lines into cells as RFC 4180 says; `csv_rows`, `json_rows` and
`array_rows` make numbers of them.
"""
