"""The versions of the tables, one file each. `zerorate.line._store` runs them when a record is opened."""
