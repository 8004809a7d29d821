"""The course report that the project started from: run again, and compared number by number."""
