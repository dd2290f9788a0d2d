CREATE TABLE work_leases (
    kind INTEGER NOT NULL,
    subject BLOB NOT NULL,
    worker INTEGER NOT NULL,
    until INTEGER NOT NULL,
    PRIMARY KEY (kind, subject)
) STRICT;
