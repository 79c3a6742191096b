"""What students hand in, read: files of a class, tables, and the texts of options."""
