"""What a document says of itself, and the JSON Schemas of all documents: plain data, for the shell and for Python."""
