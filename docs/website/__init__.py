"""The site: the pages of docs/, and a gallery of everything in the library; `python -m website` builds it."""
