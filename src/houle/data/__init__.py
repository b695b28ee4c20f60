"""Numbers from files of others: tables of loggers and spreadsheets, histories in time, points of a laboratory."""
