"""The case file: its tables, how it is read and overridden, and what is said of one that is wrong."""
