"""Measured data from files: tables of loggers and spreadsheets, records in time, points of a laboratory."""
