"""One command, one file: read the arguments, call the package, hand the result to a writer."""
