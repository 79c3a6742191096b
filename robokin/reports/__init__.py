"""Answers for eyes, pages of text and tables; and the bytes of each command's answer in every format."""
